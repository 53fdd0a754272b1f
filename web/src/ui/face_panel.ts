import type { FaceSource } from "../model/faces";
import { type GreyOpenings, kGreyOpenings } from "../model/face_style";
import { isSameWindow, type Window } from "../model/grey";
import { kRigs } from "../model/rigs";
import type { Viewer } from "../viewer";
import { h } from "./dom";
import { LampPad } from "./lamp_pad";

const kSources: Record<FaceSource, string> = {
  volume: "Cut faces are drawn from the section volume",
  splats: "Cut faces are what the cut leaves of the splats",
};

/** The choice of a lamp among the rigs. */
const kLamp = "lamp";

const kOpenings: Record<GreyOpenings, [label: string, hint: string]> = {
  cinematic: ["Lit", "Behind what the window has black, walls are seen in their colours and light"],
  neutral: [
    "Clay",
    "Behind what the window has black, walls are seen as blue clay, which no value looks like",
  ],
  values: ["Values", "Values alone: what the window has black is black"],
};

/** How cut faces look: from the volume or by splats, cinematic or grey, and through which window. */
export class FacePanel {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #sources = new Map<FaceSource, HTMLButtonElement>();
  readonly #noSection = h("p", { class: "hint" });
  readonly #rig: HTMLSelectElement;
  readonly #light: HTMLElement;
  readonly #turn: HTMLInputElement;
  readonly #turned: HTMLElement;
  readonly #lamp: LampPad;
  readonly #openings = new Map<GreyOpenings, HTMLButtonElement>();
  readonly #gaps: HTMLElement;
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
      this.#sources.set(
        name,
        h("button", { title: hint, onclick: () => viewer.store.setSection(name) }, label),
      );
    }
    this.#rig = h(
      "select",
      { onchange: () => this.#chooseLight(this.#rig.value) },
      h("option", { value: "" }, "As the case was made"),
      ...[...kRigs].map(([name, { title }]) => h("option", { value: name }, title)),
      h("option", { value: kLamp }, "Lamp in hand"),
    );
    this.#turn = h("input", {
      type: "range",
      min: "-180",
      max: "180",
      step: "5",
      "aria-label": "Turn the light, degrees",
      oninput: () => viewer.store.setTurn(this.#turn.valueAsNumber),
    });
    this.#turned = h("div", { class: "blend two" }, h("span", {}, "Turned"), this.#turn);
    this.#lamp = new LampPad(viewer);
    for (const name of kGreyOpenings) {
      const [label, title] = kOpenings[name];
      this.#openings.set(name, h("button", { title, onclick: () => viewer.store.setOpenings(name) }, label));
    }
    this.#gaps = h(
      "div",
      { class: "gaps" },
      h("span", {}, "Openings"),
      h("div", { class: "segments", role: "group", "aria-label": "Openings" }, ...this.#openings.values()),
    );
    this.#light = h("label", { class: "light" }, "Light", this.#rig);
    this.#grey = h("input", {
      type: "range",
      min: "0",
      max: "1",
      step: "0.01",
      "aria-label": "From cinematic to grey",
      oninput: () => viewer.store.setGrey(Number(this.#grey.value)),
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
      this.#turned,
      this.#lamp.element,
      this.#blend,
      this.#gaps,
      this.#window,
    );
  }

  update(): void {
    const { state, noSection, windows, window, canChangeRig } = this.#viewer;
    const { section, grey, openings, rig, turn, lamp } = state;
    if (lamp) {
      this.#lamp.update();
    }
    // Touching the page costs a layout, which turning the case need not.
    const light = [rig, turn, lamp !== null, canChangeRig];
    const shown = JSON.stringify([section, noSection, grey, openings, light, window, [...windows.keys()]]);
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
    this.#rig.value = lamp ? kLamp : (rig ?? "");
    this.#turned.hidden = canChangeRig !== true || lamp !== null;
    this.#turn.value = String(turn);
    this.#lamp.element.hidden = canChangeRig !== true || lamp === null;
    this.#gaps.hidden = source === "splats" || grey === 0 || canChangeRig !== true;
    for (const [name, button] of this.#openings) {
      button.setAttribute("aria-pressed", String(name === openings));
    }
    this.#blend.hidden = source === "splats";
    this.#grey.value = String(grey);
    this.#window.hidden = source === "splats" || grey === 0 || !window;
    if (this.#windows !== windows) {
      this.#windows = windows;
      this.#presets.replaceChildren(
        ...[...windows].map(([name, one]) =>
          h("button", { onclick: () => this.#viewer.store.setWindow(one) }, name),
        ),
      );
    }
    [...windows.values()].forEach((one, i) =>
      this.#presets.children[i]!.setAttribute("aria-pressed", String(isSameWindow(one, window))),
    );
    this.#center.value = window ? String(Math.round(window.center)) : "";
    this.#width.value = window ? String(Math.round(window.width)) : "";
  }

  #chooseLight(name: string): void {
    if (name === kLamp) {
      this.#lamp.begin();
    } else {
      this.#viewer.store.setLamp(null);
      this.#viewer.store.setRig(name || null);
    }
  }

  #number(label: string): HTMLInputElement {
    return h("input", { type: "number", step: "10", "aria-label": label, onchange: () => this.#typed() });
  }

  /** Takes over the window that was typed, if it is one. */
  #typed(): void {
    const [center, width] = [this.#center.valueAsNumber, this.#width.valueAsNumber];
    if (Number.isFinite(center) && width > 0) {
      this.#viewer.store.setWindow({ center, width });
    }
    this.#shown = "";
    this.update();
  }
}
