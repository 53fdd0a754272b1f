import type { FontFamilies } from "@pmndrs/uikit";
import { type Object3D, Vector3 } from "three";

import { texts } from "../../text/text";
import { hints } from "../preferences";
import type { Stage } from "../stage";
import { Tag } from "./tag";

/** Above the case, m. */
const kAbove = 0.1;
/** Of a text that is read first. */
const kFontSize = 18;
/** One is said for so long at most, and so long after it was followed, ms. */
const kMostMs = 30_000;
const kDoneMs = 1200;
/** The last, which nothing in the room follows. */
const kLastMs = 12_000;

/** What to do first, above the case: one thing after the other, each until it is done; and not again. */
export class FirstHints {
  readonly #tag: Tag;
  readonly #steps: readonly { text: string; isDone: () => boolean; mostMs: number }[];
  #step = 0;
  #shown = 0; // for so long, ms
  #done = 0;
  readonly #place = new Vector3(); // scratch

  constructor(stage: Stage, fontFamilies: FontFamilies) {
    const t = texts().headset.hints;
    this.#tag = new Tag(fontFamilies, "above", kFontSize);
    this.#tag.object.intersectChildren = false; // nobody presses it
    this.#steps = [
      { text: t.plane, isDone: () => stage.grip.holding !== null, mostMs: kMostMs },
      { text: t.body, isDone: () => stage.isHeld, mostMs: kMostMs },
      { text: t.panel, isDone: () => false, mostMs: kLastMs },
    ];
    this.#step = hints.value === "seen" ? this.#steps.length : 0;
  }

  get object(): Object3D {
    return this.#tag.object;
  }

  /** What is said now; empty: nothing. */
  get text(): string {
    return this.#steps[this.#step]?.text ?? "";
  }

  /** Before a frame, where `top` is the case's, in the room; null: there is none. */
  update(top: Vector3 | null, eye: Vector3, delta: number): void {
    const step = this.#steps[this.#step];
    this.#tag.object.visible = step !== undefined && top !== null;
    if (!step || !top) {
      return;
    }
    this.#shown += delta;
    this.#done += this.#done > 0 || step.isDone() ? delta : 0;
    if (this.#done > kDoneMs || this.#shown > step.mostMs) {
      this.#shown = this.#done = 0;
      ++this.#step;
      if (this.#step === this.#steps.length) {
        hints.value = "seen";
      }
    }
    this.#tag.text.value = step.text;
    this.#tag.place(this.#place.copy(top).setY(top.y + kAbove), eye, delta);
  }

  dispose(): void {
    this.#tag.dispose();
  }
}
