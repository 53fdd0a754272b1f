import type { Actions } from "../actions";
import { type CaseSummary, failureText } from "../model/case_list";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import type { BesideView } from "./beside_view";
import { h } from "./dom";

/** A case that can be shown beside another. */
export type BesideCase = Pick<CaseSummary, "name" | "file" | "error">;

/** Between the two, px. */
const kGap = 2;

/** The room for a case beside the page's own. What shows it is fetched when there first is one. */
export class BesidePart {
  readonly element = h("section", { class: "beside", "aria-label": texts().beside.title, hidden: true });
  readonly #viewer: Viewer;
  readonly #actions: Actions;
  readonly #takesWheel: () => boolean;
  readonly #changed: () => void;
  #view: BesideView | null = null;
  #name: string | null = null;
  #asked = 0;

  /** `changed` is told when it comes and goes. */
  constructor(viewer: Viewer, actions: Actions, takesWheel: () => boolean, changed: () => void) {
    this.#viewer = viewer;
    this.#actions = actions;
    this.#takesWheel = takesWheel;
    this.#changed = changed;
  }

  /** Of the case that is there; null: none. */
  get name(): string | null {
    return this.#name;
  }

  /** Shows a case; null: none. Rejects with an error for a person, and none is shown then. */
  async show(one: BesideCase | null): Promise<void> {
    const asked = ++this.#asked;
    this.#close();
    if (!one) {
      return;
    }
    this.#name = one.name;
    try {
      if (one.error) {
        throw new Error(one.error);
      }
      const { BesideView } = await import("./beside_view");
      if (asked !== this.#asked) {
        return;
      }
      const view = new BesideView(this.#viewer, this.#actions, this.#takesWheel, () => void this.show(null));
      this.#view = view;
      this.element.replaceChildren(...view.parts);
      this.element.hidden = false;
      this.#changed();
      await view.open(one);
    } catch (error) {
      if (asked === this.#asked) {
        this.#close();
        throw new Error(failureText(one.name, error));
      }
    }
  }

  /** Takes its half of what is free at the left and the top of `width` × `height` px, the longer way. Returns how much. */
  place(width: number, height: number): { right: number; bottom: number } {
    if (this.element.hidden) {
      return { right: 0, bottom: 0 };
    }
    const aside = width > height;
    const half = { right: aside ? Math.floor(0.5 * width) : 0, bottom: aside ? 0 : Math.floor(0.5 * height) };
    this.element.classList.toggle("below", !aside);
    Object.assign(this.element.style, {
      left: `${aside ? width - half.right + kGap : 0}px`,
      top: `${aside ? 0 : height - half.bottom + kGap}px`,
      width: `${(aside ? half.right : width) - (aside ? kGap : 0)}px`,
      height: `${(aside ? height : half.bottom) - (aside ? 0 : kGap)}px`,
    });
    return half;
  }

  /** After every change of what the page shows. */
  update(): void {
    this.#view?.update();
  }

  dispose(): void {
    ++this.#asked;
    this.#view?.dispose();
  }

  #close(): void {
    this.#view?.dispose();
    this.#view = null;
    this.#name = null;
    if (!this.element.hidden) {
      this.element.hidden = true;
      this.element.replaceChildren();
      this.#changed();
    }
  }
}
