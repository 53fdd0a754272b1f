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
import { viewDirection } from "../model/view";
import type { Viewer } from "../viewer";
import type { ClipOperator } from "../worker/protocol";
import { h, icon, kIcons } from "./dom";

const kOperators: Record<ClipOperator, string> = {
  hard: "A splat is drawn whole or not at all, by its centre",
  soft: "A splat fades by how far its centre is from the plane",
  exact: "Every pixel integrates its splat up to the plane",
};

/** Of a slab when it is made, and its limits: mm. */
const kThickness = 20;
const kLeastThickness = 1;

/** Everything about the cut: its planes, where they are, what is removed, how splats meet it. */
export class PlanePanel {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #orientations = new Map<Orientation, HTMLButtonElement>();
  readonly #operators = new Map<ClipOperator, HTMLButtonElement>();
  readonly #slider: HTMLInputElement;
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
  #shown = "";

  /** `face` is the part about cut faces. */
  constructor(viewer: Viewer, face: HTMLElement) {
    this.#viewer = viewer;
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
      step: "0.1",
      "aria-label": "Position of the plane, mm",
      oninput: () => this.#moveTo(Number(this.#slider.value)),
    });
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
      this.#several,
      h(
        "div",
        { class: "segments tall", role: "group", "aria-label": "Orientation" },
        ...this.#orientations.values(),
      ),
      h("div", { class: "row position" }, this.#side, this.#readout),
      this.#slider,
      h(
        "div",
        { class: "segments tall", role: "group", "aria-label": "Plane" },
        h(
          "button",
          { title: "Keep the other side (F)", onclick: () => this.flip() },
          icon(kIcons.flip),
          "Flip",
        ),
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

  orient(name: Orientation): void {
    this.#cutAcross(kAxes[name]);
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
    if (plane) {
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

  /** Moves the plane along its normal, towards what it removes. */
  step(mm: number): void {
    const { cut } = this.#viewer;
    if (cut) {
      this.#moveTo(-cut.offset + mm);
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
      this.#cutAcross(info.axis);
    }
  }

  update(): void {
    const { state, info, cut } = this.#viewer;
    const { cuts, active, clip, handle } = state;
    // Touching the page costs a layout, which turning the case need not.
    const shown = JSON.stringify([cuts, active, clip, handle, info?.bounds]);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    this.element.classList.toggle("off", !cut);
    this.#power.setAttribute("aria-pressed", String(cut !== null));
    this.#updateCuts();
    this.#handle.setAttribute("aria-pressed", String(handle));
    const orientation = cut && orientationOf(cut);
    for (const [name, button] of this.#orientations) {
      button.setAttribute("aria-pressed", String(name === orientation));
    }
    for (const [name, button] of this.#operators) {
      button.setAttribute("aria-pressed", String(name === clip));
    }
    this.#hint.textContent = kOperators[clip];
    this.#slider.disabled = !cut;
    if (cut && info) {
      // The slider counts towards the removed side: to the right, less is removed.
      const [min, max] = projectBox(info.bounds, cut.normal.clone().negate());
      this.#slider.min = String(min);
      this.#slider.max = String(max);
      this.#slider.value = String(-cut.offset);
      this.#thickness.max = String(max - min);
      this.#side.textContent = `${orientation ? capital(orientation) : "Oblique"}, ${removedSide(cut)} removed`;
      this.#readout.textContent = `${(-cut.offset - min).toFixed(1)} mm`;
    } else {
      this.#side.textContent = "Nothing is cut";
      this.#readout.textContent = "";
    }
    this.#slab.setAttribute("aria-pressed", String(cut !== null && cut.thickness !== null));
    this.#thicknessRow.hidden = cut === null || cut.thickness === null;
    this.#thickness.value = String(cut?.thickness ?? kThickness);
    this.#thicknessReadout.textContent = `${(cut?.thickness ?? 0).toFixed(1)} mm`;
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
    this.#add.disabled = !canDraw([...cuts, more]);
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
