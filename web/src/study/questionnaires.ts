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
const kAgreement = { low: "Strongly disagree", high: "Strongly agree", values: kFive };
/** The 21 marks of a scale of the NASA-TLX. */
const kTlx = Array.from({ length: 21 }, (_, i) => 5 * i);

/** J. Brooke, SUS: A Quick and Dirty Usability Scale, 1996, with "system" for all that is tried. */
const kSus = [
  "I think that I would like to use this system frequently.",
  "I found the system unnecessarily complex.",
  "I thought the system was easy to use.",
  "I think that I would need the support of a technical person to be able to use this system.",
  "I found the various functions in this system were well integrated.",
  "I thought there was too much inconsistency in this system.",
  "I would imagine that most people would learn to use this system very quickly.",
  "I found the system very cumbersome to use.",
  "I felt very confident using the system.",
  "I needed to learn a lot of things before I could get going with this system.",
];

/** S. G. Hart and L. E. Staveland, NASA-TLX, 1988: raw, without weights. */
const kWorkload: [string, string, string][] = [
  ["Mental demand: how mentally demanding was the task?", "Very low", "Very high"],
  ["Physical demand: how physically demanding was the task?", "Very low", "Very high"],
  ["Temporal demand: how hurried or rushed was the pace of the task?", "Very low", "Very high"],
  ["Performance: how successful were you in accomplishing what you were asked to do?", "Perfect", "Failure"],
  ["Effort: how hard did you have to work to accomplish your level of performance?", "Very low", "Very high"],
  [
    "Frustration: how insecure, discouraged, irritated, stressed and annoyed were you?",
    "Very low",
    "Very high",
  ],
];

export const kItems: Record<Questionnaire, readonly Item[]> = {
  sus: kSus.map((text) => ({ text, ...kAgreement })),
  efficiency: [
    {
      text: "How efficiently could you do the tasks this way?",
      low: "Not at all",
      high: "Very efficiently",
      values: kFive,
    },
  ],
  tlx: kWorkload.map(([text, low, high]) => ({ text, low, high, values: kTlx })),
};
