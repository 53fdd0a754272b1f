import type { Viewer } from "../viewer";
import { h } from "./dom";

/** What whoever looks at the case does with it takes the veil away: it shows what was. */
const kTouches = ["pointerdown", "wheel", "keydown"] as const;

/** The picture of the look that is left, over that of the one that comes: the one fades into the other. */
export class LookVeil {
  readonly element = h("canvas", { class: "look-veil", "aria-hidden": "true", hidden: true });
  readonly #viewer: Viewer;

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    for (const type of kTouches) {
      viewer.canvas.addEventListener(type, () => this.set(0), { passive: true });
    }
  }

  /** The case that comes next is veiled. */
  expect(): void {
    this.#viewer.leaving = () => {
      this.element.hidden = !this.#viewer.copyCanvas(this.element);
      this.element.style.opacity = "1";
    };
  }

  get isUp(): boolean {
    return !this.element.hidden;
  }

  /** How much of it is seen; at 0 it is gone. */
  set(share: number): void {
    if (share > 0) {
      this.element.style.opacity = share.toFixed(4);
      return;
    }
    this.#viewer.leaving = () => {};
    if (this.isUp) {
      this.element.hidden = true;
      Object.assign(this.element, { width: 1, height: 1 }); // gives back its pixels
    }
  }
}
