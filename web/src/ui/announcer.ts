import type { Actions } from "../actions";
import { planeText } from "../model/planes";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { h } from "./dom";

/** The plane has rested for so long when it is said where it is. */
const kRestMs = 700;

/** Says to those who cannot see it where the plane came to rest. */
export class Announcer {
  readonly element = h("div", { class: "unseen", "aria-live": "polite" });
  readonly #viewer: Viewer;
  readonly #actions: Actions;
  #said = "";
  #timer = 0;

  constructor(viewer: Viewer, actions: Actions) {
    this.#viewer = viewer;
    this.#actions = actions;
  }

  /** After every change of the viewer's state. */
  update(): void {
    const text = this.#text;
    if (text !== this.#said) {
      this.#said = text;
      clearTimeout(this.#timer);
      this.#timer = window.setTimeout(() => (this.element.textContent = text), kRestMs);
    }
  }

  dispose(): void {
    clearTimeout(this.#timer);
  }

  get #text(): string {
    const { info, cut } = this.#viewer;
    if (!info) {
      return "";
    }
    return cut ? `${planeText(cut)}, ${this.#actions.positionText}` : texts().cut.nothing;
  }
}
