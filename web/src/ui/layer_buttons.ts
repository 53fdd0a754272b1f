import type { Layers } from "../model/layers";
import type { Viewer } from "../viewer";
import { h } from "./dom";

const kLayers: Record<keyof Layers, [label: string, hint: string]> = {
  body: ["Body", "The splats (O); without them cut faces from the volume stand alone"],
  faces: ["Cut faces", "From the volume; without them splats draw the faces"],
  marks: ["Marks", "Pins and lengths"],
};

/** What of a case is shown. */
export class LayerButtons {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #buttons: Map<keyof Layers, HTMLButtonElement>;

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    const layers = Object.entries(kLayers) as [keyof Layers, [string, string]][];
    this.#buttons = new Map(
      layers.map(([layer, [label, title]]) => [
        layer,
        h(
          "button",
          { title, onclick: () => viewer.store.setLayers({ [layer]: !viewer.state.layers[layer] }) },
          label,
        ),
      ]),
    );
    this.element = h(
      "div",
      {},
      h("h3", {}, "Layers"),
      h("div", { class: "segments", role: "group", "aria-label": "Layers" }, ...this.#buttons.values()),
    );
  }

  update(): void {
    const { noSection, state } = this.#viewer;
    this.element.hidden = noSection !== null;
    for (const [layer, button] of this.#buttons) {
      const pressed = String(state.layers[layer]);
      if (button.getAttribute("aria-pressed") !== pressed) {
        button.setAttribute("aria-pressed", pressed);
      }
    }
  }
}
