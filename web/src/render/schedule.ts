import type { Style } from "../model/viewer_state";
import type { CaseClient } from "../worker/case_client";
import type { OpenCase, SortFrame, SortResult } from "./open_case";

/** Without changes for this long the picture is drawn at its best. */
export const kSettleMs = 160;

/** When a case is ordered anew and drawn: for speed while something moves, at its best once it rests. */
export class Schedule {
  readonly #client: CaseClient;
  #orderStale = true; // something moved since the last sort began
  #pictureStale = true;
  #coarse = false; // the picture was drawn for speed
  #changedAt = 0; // ms
  #frames = 0; // since then

  constructor(client: CaseClient) {
    this.#client = client;
  }

  /** What is seen is another: its order, too. */
  touch(): void {
    this.#orderStale = true;
    this.#pictureStale = true;
    this.#changedAt = performance.now();
    this.#frames = 0;
  }

  /** It looks otherwise, in the same order. */
  repaint(): void {
    this.#pictureStale = true;
  }

  /** Nothing moved: the next picture is drawn at its best. */
  rest(): void {
    this.#changedAt = -Infinity;
    this.#frames = Infinity;
  }

  /** An animation frame begins. */
  tick(): void {
    ++this.#frames;
  }

  /** Whether something changed within the last frames or so many ms. */
  isMoving(now: number, ms = kSettleMs, frames = 0): boolean {
    return this.#frames < frames || now - this.#changedAt < ms;
  }

  /** Whether the order is of another picture, and nobody makes a new one. */
  get wantsOrder(): boolean {
    return this.#orderStale && !this.#client.sorting;
  }

  /** Has the splats of a case ordered: one order at a time. Null where the worker has another case by now. Rejects with CaseError. */
  async order(current: OpenCase, frame: SortFrame, style: Style): Promise<SortResult | null> {
    this.#orderStale = false;
    const sorted = await current.sort(frame, style);
    if (sorted) {
      this.#pictureStale = true;
    }
    return sorted;
  }

  /** Whether it is to be drawn now; of what rests, no picture but the last one is. */
  isDue(moving: boolean): boolean {
    return moving ? this.#pictureStale : (this.#pictureStale || this.#coarse) && this.#isOrdered;
  }

  /** The picture is that of now, drawn for speed if `moving`. */
  drawn(moving: boolean): void {
    this.#pictureStale = false;
    this.#coarse = moving;
  }

  /** Whether the picture is at its best: nothing moves or is still to come. */
  isSettled(current: OpenCase, style: Style): boolean {
    const isBest = !this.#pictureStale && !this.#coarse && this.#isOrdered;
    return isBest && !current.awaitsSection && current.isLit(style);
  }

  get #isOrdered(): boolean {
    return !this.#orderStale && !this.#client.sorting;
  }
}
