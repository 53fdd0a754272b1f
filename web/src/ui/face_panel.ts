import type { FaceSource } from "../model/faces";
import { isSameWindow, type Window } from "../model/grey";
import { kRigs } from "../model/rigs";
import type { Viewer } from "../viewer";
import { h } from "./dom";

const kSources: Record<FaceSource, string> = {
  volume: "Cut faces are drawn from the section volume",
  splats: "Cut faces are what the cut leaves of the splats",
};

/** How cut faces look: from the volume or by splats, cinematic or grey, and through which window. */
export class FacePanel {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #sources = new Map<FaceSource, HTMLButtonElement>();
  readonly #noSection = h("p", { class: "hint" });
  readonly #rig: HTMLSelectElement;
  readonly #light: HTMLElement;
  readonly #grey: HTMLInputElement;
  readonly #blend: HTMLElement;
  readonly #window: HTMLElement;
  readonly #marks: HTMLElement;
  readonly #presets = h("div", { class: "segments fit", role: "group", "aria-label": "Window" });
  readonly #center = this.#number("Centre of the window");
  readonly #width = this.#number("Width of the window");
  #windows: ReadonlyMap<string, Window> = new Map();
  #shown = "";

  /** `marks` are the buttons that mark points of faces. */
  constructor(viewer: Viewer, marks: HTMLElement) {
    this.#viewer = viewer;
    for (const [name, hint] of Object.entries(kSources) as [FaceSource, string][]) {
      const label = name === "volume" ? "Volume" : "Splats";
      this.#sources.set(name, h("button", { title: hint, onclick: () => viewer.setSection(name) }, label));
    }
    this.#rig = h(
      "select",
      { onchange: () => viewer.setRig(this.#rig.value || null) },
      h("option", { value: "" }, "As the case was made"),
      ...[...kRigs].map(([name, { title }]) => h("option", { value: name }, title)),
    );
    this.#light = h("label", { class: "light" }, "Light", this.#rig);
    this.#grey = h("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "0.01",
      "aria-label": "From cinematic to grey",
      oninput: () => viewer.setGrey(Number(this.#grey.value)),
    });
    this.#blend = h("div", { class: "blend" }, h("span", {}, "Cinematic"), this.#grey, h("span", {}, "Grey"));
    this.#window = h(
      "div",
      {},
      this.#presets,
      h(
        "div",
        { class: "row window" },
        h("label", {}, "Centre", this.#center),
        h("label", {}, "Width", this.#width),
      ),
    );
    this.#marks = marks;
    this.element = h(
      "div",
      {},
      h("div", { class: "titled" }, h("h3", {}, "Cut face"), marks),
      h("div", { class: "segments", role: "group", "aria-label": "Cut face" }, ...this.#sources.values()),
      this.#noSection,
      this.#light,
      this.#blend,
      this.#window,
    );
  }

  update(): void {
    const { state, noSection, windows, window, canChangeRig } = this.#viewer;
    const { section, grey, rig } = state;
    // Touching the page costs a layout, which turning the case need not.
    const shown = JSON.stringify([section, noSection, grey, rig, canChangeRig, window, [...windows.keys()]]);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    const source = noSection ? "splats" : section;
    for (const [name, button] of this.#sources) {
      button.setAttribute("aria-pressed", String(name === source));
      button.disabled = noSection !== null;
    }
    this.#noSection.textContent = noSection ?? "";
    this.#noSection.hidden = !noSection;
    this.#marks.hidden = noSection !== null;
    this.#light.hidden = canChangeRig !== true;
    this.#rig.value = rig ?? "";
    this.#blend.hidden = source === "splats";
    this.#grey.value = String(grey);
    this.#window.hidden = source === "splats" || grey === 0 || !window;
    if (this.#windows !== windows) {
      this.#windows = windows;
      this.#presets.replaceChildren(
        ...[...windows].map(([name, one]) =>
          h("button", { onclick: () => this.#viewer.setWindow(one) }, name),
        ),
      );
    }
    [...windows.values()].forEach((one, i) =>
      this.#presets.children[i]!.setAttribute("aria-pressed", String(isSameWindow(one, window))),
    );
    this.#center.value = window ? String(Math.round(window.center)) : "";
    this.#width.value = window ? String(Math.round(window.width)) : "";
  }

  #number(label: string): HTMLInputElement {
    return h("input", { type: "number", step: "10", "aria-label": label, onchange: () => this.#typed() });
  }

  /** Takes over the window that was typed, if it is one. */
  #typed(): void {
    const [center, width] = [this.#center.valueAsNumber, this.#width.valueAsNumber];
    if (Number.isFinite(center) && width > 0) {
      this.#viewer.setWindow({ center, width });
    }
    this.#shown = "";
    this.update();
  }
}
