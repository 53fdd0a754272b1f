import type { StudyTexts } from "../text/study_en";

/** What is asked after each mode. */
export const kQuestionnaires = ["sus", "efficiency", "tlx"] as const;
export type Questionnaire = (typeof kQuestionnaires)[number];

export interface Item {
  text: string;
  /** What the least and the greatest answer mean. */
  low: string;
  high: string;
  /** Of the answers, in their order. */
  values: readonly number[];
}

const kFive = [1, 2, 3, 4, 5];
/** The 21 marks of a scale of the NASA-TLX. */
const kTlx = Array.from({ length: 21 }, (_, i) => 5 * i);

/** What is asked, in its order. */
export function itemsOf(questionnaire: Questionnaire, words: StudyTexts): Item[] {
  if (questionnaire !== "tlx") {
    const { low, high, items } = words[questionnaire];
    return items.map((text) => ({ text, low, high, values: kFive }));
  }
  const { tlx } = words;
  const { low, high, perfect, failure } = tlx;
  const scales = ["mental", "physical", "temporal", "performance", "effort", "frustration"] as const;
  return scales.map((scale) => ({
    text: tlx[scale],
    ...(scale === "performance" ? { low: perfect, high: failure } : { low, high }),
    values: kTlx,
  }));
}
