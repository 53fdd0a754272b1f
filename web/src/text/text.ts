import { german } from "./de";
import { english, type Texts } from "./en";

const kLanguages: Readonly<Record<string, Texts>> = { en: english, de: german };
const kUsual = "en";

let chosen = kUsual;

/** What the viewer says, in the language that was chosen before its first part was made. */
export function texts(): Texts {
  return kLanguages[chosen]!;
}

/** The language that was chosen, as BCP 47 has it. */
export function language(): string {
  return chosen;
}

/** From now on, of BCP 47 tags the first that is spoken here ("de-CH"), or English. Returns it. */
export function chooseLanguage(wanted: readonly (string | null | undefined)[]): string {
  const codes = wanted.map((tag) => tag?.toLowerCase().split("-")[0] ?? "");
  chosen = codes.find((code) => Object.hasOwn(kLanguages, code)) ?? kUsual;
  return chosen;
}
