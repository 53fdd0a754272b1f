/** What a study shows, on the page or in the headset, and what can be pressed there. */
export interface Screen {
  /** Another one has another. */
  key: string;
  title: string;
  text: readonly string[];
  question: Question | null;
  /** What is typed in; at the desk alone. */
  entry: Entry | null;
  /** Whether the plane can be slid along here. */
  slides: boolean;
  /** Whether the case is to be seen and touched meanwhile. */
  aside: boolean;
  /** Of a rest or a task, s. */
  remaining: number | null;
  buttons: readonly Button[];
  /** What only the experimenter can help with. */
  trouble: string | null;
}

export interface Question {
  text: string;
  low: string;
  high: string;
  values: readonly number[];
  chosen: number | null;
  /** Not while the answers are being recorded. */
  enabled: boolean;
  choose(value: number): void;
}

export interface Entry {
  label: string;
  kind: "number" | "text";
  value: string;
  set(value: string): void;
}

export interface Button {
  text: string;
  enabled: boolean;
  press(): void;
}
