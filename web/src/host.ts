import type { CaseSummary } from "./model/case_list";
import type { Place } from "./model/keeper";
import type { Look } from "./model/looks";
import type { Mark } from "./model/marks";
import type { Stop } from "./model/tour";
import type { CaseSource } from "./worker/protocol";

/** What a viewer stands in: the page of `clipgs serve`, or an element of another page. */
export interface Host {
  /** Whose keys are the viewer's. */
  readonly keys: EventTarget;
  /** Whether a wheel over the case is the viewer's, or scrolls what is around. */
  takesWheel(): boolean;
  /** What is shown has changed. */
  changed(): void;
  /** What can be opened. */
  cases(): Promise<CaseSummary[]>;
  /** Of the volume that is shown, as far as is known; none where it has one alone. */
  looks(): readonly Look[];
  open(name: string): Promise<void>;
  /** Shows a file of the person's own, which is not sent anywhere. */
  openFile(file: File): Promise<void>;
  /** Lets a person choose a case; absent where there is no choice. */
  choose?(): void;
  /** Lets a person choose a case to be beside this one; absent where there is no choice. */
  chooseBeside?(): void;
  /** Lets a person choose another look of the volume, where there are several. */
  chooseLook?(): void;
  /** What the case is where it is not finished, and when there will be a better one; "": it is. */
  news?(): string;
  /** Where marks of a case are kept, of a volume or, where that is not known, ""; absent: in the browser. */
  marksPlace?(name: string, volume: string): Promise<Place<Mark>>;
  /** The same of the tour. */
  tourPlace?(name: string, volume: string): Place<Stop> | Promise<Place<Stop>>;
  /** Shows another look of the volume, by the name of its case. Rejects with a line that says why it cannot be had. */
  openLook(name: string): Promise<void>;
  /** Fetches another look, which may be shown next. */
  expectLook(name: string): void;
  /** A link to what is shown, null where it is nobody else's; absent where no address says it. */
  address?(): string | null;
}

/** What is opened; more of it may be known before it is there. */
export type OpenedCase = Pick<CaseSummary, "name" | "error"> & { file: CaseSource } & Partial<
    Pick<CaseSummary, "title" | "thumbnail" | "bytes">
  >;

/** Says what went wrong, in a line, and offers to do it again. */
export type Fail = (text: string, again: (() => void) | null) => void;
