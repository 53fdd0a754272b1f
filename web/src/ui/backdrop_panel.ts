import { kBackdrops } from "../model/backdrop";
import type { Viewer } from "../viewer";
import { h } from "./dom";

/** What lies behind the case, and how much what is far away fades towards it. */
export class BackdropPanel {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #backdrop: HTMLSelectElement;
  readonly #depth: HTMLInputElement;

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    this.#backdrop = h(
      "select",
      {
        title: "What lies behind the case",
        "aria-label": "Background",
        onchange: () => viewer.store.setBackdrop(this.#backdrop.value || null),
      },
      h("option", { value: "" }, "Background"),
      ...[...kBackdrops].map(([name, { title }]) => h("option", { value: name }, title)),
    );
    this.#depth = h("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "0.05",
      title: "What is farther away fades towards the background",
      "aria-label": "Depth: how much what is far away fades",
      oninput: () => viewer.store.setDepthCue(this.#depth.valueAsNumber),
    });
    this.element = h("div", { class: "blend backdrop" }, this.#backdrop, h("span", {}, "Depth"), this.#depth);
  }

  update(): void {
    const { backdrop, depthCue } = this.#viewer.state;
    if (this.#backdrop.value !== (backdrop ?? "")) {
      this.#backdrop.value = backdrop ?? "";
    }
    if (this.#depth.valueAsNumber !== depthCue) {
      this.#depth.value = String(depthCue);
    }
  }
}
