import { computed } from "@preact/signals-core";

import type { Follow } from "../model/follower";
import { isSameWindow } from "../model/grey";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { each, h } from "./dom";
import { range } from "./range";
import { choices, segment } from "./segments";

/** How cut faces look: from the volume or by splats, cinematic or grey, and through which window. */
export class FacePanel {
  readonly #viewer: Viewer;
  readonly #live: Follow;

  constructor(viewer: Viewer, live: Follow) {
    this.#viewer = viewer;
    this.#live = live;
  }

  get sources(): HTMLElement {
    const t = texts().face;
    const viewer = this.#viewer;
    const { store } = viewer;
    return h(
      "div",
      {},
      choices(
        t.title,
        t.sources,
        (source) => this.#live(() => (viewer.noSection ? "splats" : store.state.section) === source),
        (source) => store.setSection(source),
        (source) => ({
          hint: t.sourceHints[source],
          disabled: this.#live(() => viewer.noSection !== null),
        }),
      ),
    );
  }

  /** Why faces are by splats, where that is not chosen. */
  get noSection(): HTMLElement {
    const viewer = this.#viewer;
    return h(
      "p",
      { class: "hint", hidden: this.#live(() => viewer.noSection === null) },
      this.#live(() => viewer.noSection ?? ""),
    );
  }

  get grey(): HTMLElement {
    const t = texts().face;
    const { store } = this.#viewer;
    const slider = range(
      { "aria-label": t.blend },
      this.#live(() => ({ min: 0, max: 1, step: 0.01, value: store.state.grey })),
      (grey) => store.setGrey(grey),
    );
    return h(
      "div",
      {},
      h(
        "div",
        { class: "blend", hidden: this.#live(() => !this.#byVolume) },
        h("span", {}, t.cinematic),
        slider,
        h("span", {}, t.grey),
      ),
      this.#openings(),
      this.#window(),
    );
  }

  #openings(): HTMLElement {
    const t = texts().face;
    const viewer = this.#viewer;
    const { store } = viewer;
    return h(
      "div",
      { class: "gaps", hidden: this.#live(() => !this.#isGrey || viewer.canChangeRig !== true) },
      h("span", {}, t.openings),
      choices(
        t.openings,
        t.openingNames,
        (one) => this.#live(() => store.state.openings === one),
        (one) => store.setOpenings(one),
        (one) => ({ hint: t.openingHints[one] }),
      ),
    );
  }

  #window(): HTMLElement {
    const t = texts().face;
    const viewer = this.#viewer;
    const presets = h("div", { class: "segments fit", role: "group", "aria-label": t.window });
    const windows = this.#live(() => viewer.windows);
    each(
      presets,
      computed(() => [...windows.value]),
      ([text, one]) =>
        segment({
          text,
          pressed: this.#live(() => isSameWindow(one, viewer.window)),
          press: () => viewer.store.setWindow(one),
        }),
    );
    return h(
      "div",
      { hidden: this.#live(() => !this.#isGrey || viewer.window === null) },
      presets,
      h(
        "div",
        { class: "row window" },
        h("label", {}, t.center, this.#number("center", t.centerHint)),
        h("label", {}, t.width, this.#number("width", t.widthHint)),
      ),
    );
  }

  /** What is typed is taken over if it is a window. */
  #number(part: "center" | "width", hint: string): HTMLInputElement {
    const viewer = this.#viewer;
    const shown = () => (viewer.window ? String(Math.round(viewer.window[part])) : "");
    const field = h("input", {
      type: "number",
      step: "10",
      "aria-label": hint,
      value: this.#live(shown),
      onchange: () => {
        const { window } = viewer;
        const typed = field.valueAsNumber;
        if (window && Number.isFinite(typed) && (part === "center" || typed > 0)) {
          viewer.store.setWindow({ ...window, [part]: typed });
        }
        field.value = shown();
      },
    });
    return field;
  }

  get #byVolume(): boolean {
    return !this.#viewer.noSection && this.#viewer.state.section === "volume";
  }

  get #isGrey(): boolean {
    return this.#byVolume && this.#viewer.state.grey > 0;
  }
}
