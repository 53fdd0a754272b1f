import type { Vector3 } from "three";

import { canDraw, type Cut } from "../model/cut";
import { flipped, type Plane, projectBox } from "../model/geometry";
import {
  freeAxis,
  kAxes,
  kOrientations,
  type Orientation,
  orientationOf,
  planeAcross,
  removedSide,
} from "../model/planes";
import { kModes, type Mode, stateText } from "../model/states";
import { decimal } from "../model/values";
import { viewDirection } from "../model/view";
import type { Viewer } from "../viewer";
import type { ClipOperator } from "../worker/protocol";
import { h, icon, kIcons } from "./dom";

const kOperators: Record<ClipOperator, string> = {
  hard: "A splat is drawn whole or not at all, by its centre",
  soft: "A splat fades by how far its centre is from the plane",
  exact: "Every pixel integrates its splat up to the plane",
};

const kModeHints: Record<Mode, string> = {
  uniaxial: "The plane moves along the case's axis, from state to state (U)",
  arbitrary: "The plane moves and turns freely (U)",
};

/** Of a slab when it is made, and its limits: mm. */
const kThickness = 20;
const kLeastThickness = 1;

/** Everything about the cut: its planes, where they are, what is removed, how splats meet it. */
export class PlanePanel {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #modes = new Map<Mode, HTMLButtonElement>();
  readonly #orientations = new Map<Orientation, HTMLButtonElement>();
  readonly #operators = new Map<ClipOperator, HTMLButtonElement>();
  readonly #orientationGroup: HTMLElement;
  readonly #slider: HTMLInputElement;
  readonly #statesHint = h("p", { class: "hint" });
  readonly #flip: HTMLButtonElement;
  readonly #readout = h("output", { class: "readout" });
  readonly #side = h("span", { class: "side" });
  readonly #cuts = h("span", { class: "segments fit", role: "group", "aria-label": "Planes" });
  readonly #several: HTMLElement;
  readonly #add: HTMLButtonElement;
  readonly #slab: HTMLButtonElement;
  readonly #thickness: HTMLInputElement;
  readonly #thicknessReadout = h("output", { class: "readout" });
  readonly #thicknessRow: HTMLElement;
  readonly #power: HTMLButtonElement;
  readonly #handle: HTMLButtonElement;
  readonly #hint = h("p", { class: "hint" });
  #lastCuts: readonly Cut[] = [];
  #stepRest = 0; // of a state
  #shown = "";

  /** `face` is the part about cut faces. */
  constructor(viewer: Viewer, face: HTMLElement) {
    this.#viewer = viewer;
    for (const mode of kModes) {
      const button = h(
        "button",
        { title: kModeHints[mode], onclick: () => viewer.setMode(mode) },
        capital(mode),
      );
      this.#modes.set(mode, button);
    }
    for (const name of kOrientations) {
      const button = h(
        "button",
        { title: `${capital(name)} plane (${name[0]!.toUpperCase()})`, onclick: () => this.orient(name) },
        icon(kIcons[name]),
        capital(name),
      );
      this.#orientations.set(name, button);
    }
    for (const [name, hint] of Object.entries(kOperators) as [ClipOperator, string][]) {
      const button = h("button", { title: hint, onclick: () => viewer.setClip(name) }, capital(name));
      this.#operators.set(name, button);
    }
    this.#slider = h("input", {
      type: "range",
      oninput: () => this.#slide(Number(this.#slider.value)),
    });
    this.#orientationGroup = h(
      "div",
      { class: "segments tall", role: "group", "aria-label": "Orientation" },
      ...this.#orientations.values(),
    );
    this.#flip = h("button", { onclick: () => this.flip() }, icon(kIcons.flip), "Flip");
    this.#add = h(
      "button",
      { class: "small", title: "Cut with one more plane (N)", onclick: () => this.add() },
      icon(kIcons.plus),
      "Plane",
    );
    this.#several = h(
      "div",
      { class: "titled planes" },
      this.#cuts,
      h(
        "button",
        { class: "small", title: "Remove this plane (X)", onclick: () => this.remove() },
        icon(kIcons.minus),
        "Remove",
      ),
    );
    this.#slab = h(
      "button",
      { title: "A second face behind the plane (B)", onclick: () => this.toggleSlab() },
      icon(kIcons.slab),
      "Slab",
    );
    this.#thickness = h("input", {
      type: "range",
      step: "0.5",
      min: String(kLeastThickness),
      "aria-label": "Thickness of the slab, mm",
      oninput: () => this.#setThickness(Number(this.#thickness.value)),
    });
    this.#thicknessRow = h(
      "div",
      {},
      h("div", { class: "row position" }, h("span", { class: "side" }, "Slab"), this.#thicknessReadout),
      this.#thickness,
    );
    this.#power = h(
      "button",
      { class: "plain", title: "Cut or uncut (P)", onclick: () => this.toggle() },
      icon(kIcons.power),
    );
    this.#handle = h(
      "button",
      { title: "Show or hide the handle (H)", onclick: () => viewer.setHandle(!viewer.state.handle) },
      icon(kIcons.eye),
      "Handle",
    );
    this.element = h(
      "section",
      { class: "panel", "aria-label": "Cutting plane" },
      h("header", {}, h("h2", {}, "Cutting plane"), this.#add, this.#power),
      h("div", { class: "segments", role: "group", "aria-label": "Mode" }, ...this.#modes.values()),
      this.#several,
      this.#orientationGroup,
      h("div", { class: "row position" }, this.#side, this.#readout),
      this.#slider,
      this.#statesHint,
      h(
        "div",
        { class: "segments tall", role: "group", "aria-label": "Plane" },
        this.#flip,
        h(
          "button",
          { title: "Plane and view as at the start (R)", onclick: () => this.reset() },
          icon(kIcons.reset),
          "Reset",
        ),
        this.#slab,
        this.#handle,
      ),
      this.#thicknessRow,
      face,
      h("h3", {}, "Cut of the splats"),
      h(
        "div",
        { class: "segments", role: "group", "aria-label": "Clip operator" },
        ...this.#operators.values(),
      ),
      this.#hint,
    );
  }

  toggleMode(): void {
    this.#viewer.setMode(this.#uniaxial ? "arbitrary" : "uniaxial");
  }

  orient(name: Orientation): void {
    if (!this.#uniaxial) {
      this.#cutAcross(kAxes[name]);
    }
  }

  flip(): void {
    const { cut } = this.#viewer;
    if (cut) {
      // What a slab keeps stays.
      const plane = flipped(cut);
      this.#viewer.movePlane({ ...plane, offset: plane.offset - (cut.thickness ?? 0) });
    }
  }

  /** Nothing cut, or what was before. */
  toggle(): void {
    const { cuts } = this.#viewer.state;
    if (cuts.length > 0) {
      this.#lastCuts = cuts;
      this.#viewer.setCuts([]);
    } else if (this.#lastCuts.length > 0) {
      this.#viewer.setCuts(this.#lastCuts);
    } else {
      this.#cutAcross(kAxes.axial);
    }
  }

  /** Cuts with one more plane, across the body axis that is cut least. */
  add(): void {
    const { cuts } = this.#viewer.state;
    const plane = this.#planeAcross(freeAxis(cuts));
    if (plane && !this.#uniaxial) {
      this.#viewer.setCuts([...cuts, { ...plane, thickness: null }], cuts.length);
    }
  }

  /** Without the active plane. */
  remove(): void {
    const { cuts, active } = this.#viewer.state;
    this.#viewer.setCuts(
      cuts.filter((_, i) => i !== active),
      active - 1,
    );
  }

  /** Moves another plane from now on. */
  next(): void {
    const { cuts, active } = this.#viewer.state;
    if (cuts.length > 0) {
      this.#viewer.setCuts(cuts, (active + 1) % cuts.length);
    }
  }

  toggleSlab(): void {
    const { cut } = this.#viewer;
    if (cut) {
      this.#setThickness(cut.thickness === null ? kThickness : null);
    }
  }

  /** Moves the plane by mm along its normal, towards what it removes; in the uniaxial mode by states. */
  step(by: number): void {
    const { cut, planeState, states } = this.#viewer;
    if (states && planeState !== null) {
      // A wheel may turn by less than a state at a time.
      const sum = by + (by * this.#stepRest > 0 ? this.#stepRest : 0);
      const whole = Math.trunc(sum);
      this.#stepRest = sum - whole;
      this.#viewer.setPlaneState(Math.min(states.count - 1, Math.max(0, planeState + whole)));
    } else if (cut) {
      this.#moveTo(-cut.offset + by);
    }
  }

  /** The view and the plane that a case starts with. */
  reset(): void {
    const { info } = this.#viewer;
    if (info) {
      const view = { azimuth: 28, elevation: 24, zoom: 1 };
      this.#viewer.state.view.pan.set(0, 0, 0);
      this.#viewer.setView(view);
      this.#viewer.setCuts([]);
      this.#cutAcross(info.states.axis);
    }
  }

  update(): void {
    const { state, info, cut } = this.#viewer;
    const { mode, cuts, active, clip, handle } = state;
    // Touching the page costs a layout, which turning the case need not.
    const shown = JSON.stringify([mode, cuts, active, clip, handle, info?.bounds, info?.states]);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    this.element.classList.toggle("off", !cut);
    this.#power.setAttribute("aria-pressed", String(cut !== null));
    this.#updateCuts();
    this.#handle.setAttribute("aria-pressed", String(handle));
    for (const [name, button] of this.#modes) {
      button.setAttribute("aria-pressed", String(name === mode));
    }
    this.#orientationGroup.hidden = this.#uniaxial;
    const orientation = cut && orientationOf(cut);
    for (const [name, button] of this.#orientations) {
      button.setAttribute("aria-pressed", String(name === orientation));
    }
    for (const [name, button] of this.#operators) {
      button.setAttribute("aria-pressed", String(name === clip));
    }
    this.#hint.textContent = kOperators[clip];
    this.#slider.disabled = !cut;
    this.#updatePosition();
    this.#flip.disabled = this.#uniaxial;
    this.#flip.title = this.#uniaxial
      ? "The case's states say which side is kept"
      : "Keep the other side (F)";
    this.#slab.disabled = this.#uniaxial;
    this.#slab.setAttribute("aria-pressed", String(cut !== null && cut.thickness !== null));
    this.#thicknessRow.hidden = cut === null || cut.thickness === null;
    this.#thickness.value = String(cut?.thickness ?? kThickness);
    this.#thicknessReadout.textContent = `${(cut?.thickness ?? 0).toFixed(1)} mm`;
  }

  get #uniaxial(): boolean {
    return this.#viewer.state.mode === "uniaxial";
  }

  /** Where the plane is: in words, and on the slider; to the right less is removed, or states go along the axis. */
  #updatePosition(): void {
    const { info, cut, planeState } = this.#viewer;
    const orientation = cut && orientationOf(cut);
    const place = orientation ? capital(orientation) : "Oblique";
    this.#statesHint.hidden = planeState === null;
    this.#side.hidden = planeState !== null;
    this.#slider.setAttribute(
      "aria-label",
      this.#uniaxial ? "State of the plane" : "Position of the plane, mm",
    );
    if (!cut || !info) {
      this.#side.textContent = "Nothing is cut";
      this.#readout.textContent = "";
    } else if (planeState !== null) {
      const { states } = info;
      this.#setSlider(0, states.count - 1, 1, planeState);
      this.#readout.textContent = stateText(states, planeState);
      this.#statesHint.textContent = `${place}, every ${decimal(states.spacing, 2)} mm, ${removedSide(cut)} removed`;
    } else {
      const [min, max] = projectBox(info.bounds, cut.normal.clone().negate());
      this.#setSlider(min, max, 0.1, -cut.offset);
      this.#thickness.max = String(max - min);
      this.#side.textContent = `${place}, ${removedSide(cut)} removed`;
      this.#readout.textContent = `${(-cut.offset - min).toFixed(1)} mm`;
    }
    this.#slider.setAttribute("aria-valuetext", this.#readout.textContent || "Nothing is cut");
  }

  #setSlider(min: number, max: number, step: number, value: number): void {
    this.#slider.min = String(min);
    this.#slider.max = String(max);
    this.#slider.step = String(step);
    this.#slider.value = String(value);
  }

  /** One button for each plane, where there are several. */
  #updateCuts(): void {
    const { cuts, active } = this.#viewer.state;
    if (this.#cuts.children.length !== cuts.length) {
      this.#cuts.replaceChildren(
        ...cuts.map((_, i) =>
          h(
            "button",
            { title: `Move plane ${i + 1} (E: the next)`, onclick: () => this.#activate(i) },
            String(i + 1),
          ),
        ),
      );
    }
    [...this.#cuts.children].forEach((button, i) =>
      button.setAttribute("aria-pressed", String(i === active)),
    );
    this.#several.hidden = cuts.length < 2;
    const more = { normal: kAxes.axial, offset: 0, thickness: null };
    this.#add.disabled = this.#uniaxial || !canDraw([...cuts, more]);
  }

  #activate(index: number): void {
    this.#viewer.setCuts(this.#viewer.state.cuts, index);
  }

  #planeAcross(axis: Vector3): Plane | null {
    const { info, state } = this.#viewer;
    return info && planeAcross(axis, info.bounds, viewDirection(state.view.azimuth, state.view.elevation));
  }

  /** Turns the plane, or makes it. */
  #cutAcross(axis: Vector3): void {
    const plane = this.#planeAcross(axis);
    if (plane && this.#viewer.cut) {
      this.#viewer.movePlane(plane);
    } else if (plane) {
      this.#viewer.setCuts([{ ...plane, thickness: null }]);
    }
  }

  /** To a value of the slider. */
  #slide(value: number): void {
    if (this.#uniaxial) {
      this.#viewer.setPlaneState(value);
    } else {
      this.#moveTo(value);
    }
  }

  /** Keeps the plane where it cuts something. */
  #moveTo(position: number): void {
    const { info, cut } = this.#viewer;
    if (info && cut) {
      const [min, max] = projectBox(info.bounds, cut.normal.clone().negate());
      this.#viewer.movePlane({
        normal: cut.normal,
        offset: -Math.min(max, Math.max(min, position)),
      });
    }
  }

  /** null: a plane, not a slab. */
  #setThickness(mm: number | null): void {
    const { cuts, active } = this.#viewer.state;
    const thickness = mm && Math.max(kLeastThickness, mm);
    this.#viewer.setCuts(
      cuts.map((cut, i) => (i === active ? { ...cut, thickness } : cut)),
      active,
    );
  }
}

function capital(word: string): string {
  return word[0]!.toUpperCase() + word.slice(1);
}
