import { english, type Texts } from "./en";

const kUsual = "en";
/** The languages that are spoken here, by their codes. */
export const kLanguages = [kUsual, "de"] as const;
export type Language = (typeof kLanguages)[number];

let spoken: { language: Language; texts: Texts } = { language: kUsual, texts: english };

/** What the viewer says, in the language that was chosen before its first part was made. */
export function texts(): Texts {
  return spoken.texts;
}

/** The language that was chosen, as BCP 47 has it. */
export function language(): Language {
  return spoken.language;
}

/** Of BCP 47 tags the first that is spoken here ("de-CH"), or English. */
export function languageOf(wanted: readonly (string | null | undefined)[]): Language {
  const codes = wanted.map((tag) => tag?.toLowerCase().split("-")[0]);
  return codes.flatMap((code) => kLanguages.find((one) => one === code) ?? []).at(0) ?? kUsual;
}

/**
 * A line that says what is wrong, in the language that is spoken. What reads files, often in a worker, knows English
 * alone; `{}` of a text is what differs.
 */
export function inOwnWords(line: string): string {
  return spoken.texts.errors.reduce((said, [english, own]) => {
    const parts = english.split("{}").map((part) => part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
    return said.replace(new RegExp(parts.join("(.+?)")), (_all, ...found: string[]) => {
      let k = 0;
      return own.replace(/\{\}/g, () => found[k++]!);
    });
  }, line);
}

/** What is said from now on; English is always there, others are fetched by whom they are for. */
export function speak(language: Language, texts = english): void {
  spoken = { language, texts };
}
