import type { Vector3 } from "three";

import { flipped, projectBox } from "../model/geometry";
import {
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

/** Everything about the cut: where it is, what is removed, how splats meet it. */
export class PlanePanel {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #orientations = new Map<Orientation, HTMLButtonElement>();
  readonly #operators = new Map<ClipOperator, HTMLButtonElement>();
  readonly #slider: HTMLInputElement;
  readonly #readout = h("output", { class: "readout" });
  readonly #side = h("span", { class: "side" });
  readonly #power: HTMLButtonElement;
  readonly #handle: HTMLButtonElement;
  readonly #hint = h("p", { class: "hint" });
  #lastNormal = kAxes.axial;
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
    this.#power = h(
      "button",
      { class: "plain", title: "Plane on or off (P)", onclick: () => this.toggle() },
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
      h("header", {}, h("h2", {}, "Cutting plane"), this.#power),
      h(
        "div",
        { class: "segments tall", role: "group", "aria-label": "Orientation" },
        ...this.#orientations.values(),
      ),
      h("div", { class: "row position" }, this.#side, this.#readout),
      this.#slider,
      h(
        "div",
        { class: "segments", role: "group", "aria-label": "Plane" },
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
        this.#handle,
      ),
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
    const { plane } = this.#viewer.state;
    if (plane) {
      this.#viewer.setPlane(flipped(plane));
    }
  }

  toggle(): void {
    if (this.#viewer.state.plane) {
      this.#viewer.setPlane(null);
    } else {
      this.#cutAcross(this.#lastNormal);
    }
  }

  /** Moves the plane along its normal, towards what it removes. */
  step(mm: number): void {
    const { plane } = this.#viewer.state;
    if (plane) {
      this.#moveTo(-plane.offset + mm);
    }
  }

  /** The view and the plane that a case starts with. */
  reset(): void {
    const { info } = this.#viewer;
    if (info) {
      const view = { azimuth: 28, elevation: 24, zoom: 1 };
      this.#viewer.state.view.pan.set(0, 0, 0);
      this.#viewer.setView(view);
      this.#cutAcross(info.axis);
    }
  }

  update(): void {
    const { state, info } = this.#viewer;
    const { plane, clip, handle } = state;
    // Touching the page costs a layout, which turning the case need not.
    const shown = JSON.stringify([plane, clip, handle, info?.bounds]);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    this.element.classList.toggle("off", !plane);
    this.#power.setAttribute("aria-pressed", String(plane !== null));
    this.#handle.setAttribute("aria-pressed", String(handle));
    const orientation = plane && orientationOf(plane);
    for (const [name, button] of this.#orientations) {
      button.setAttribute("aria-pressed", String(name === orientation));
    }
    for (const [name, button] of this.#operators) {
      button.setAttribute("aria-pressed", String(name === clip));
    }
    this.#hint.textContent = kOperators[clip];
    this.#slider.disabled = !plane;
    if (plane && info) {
      this.#lastNormal = plane.normal.clone();
      // The slider counts towards the removed side: to the right, less is removed.
      const [min, max] = projectBox(info.bounds, plane.normal.clone().negate());
      this.#slider.min = String(min);
      this.#slider.max = String(max);
      this.#slider.value = String(-plane.offset);
      this.#side.textContent = orientation
        ? `${capital(orientation)}, ${removedSide(plane)} removed`
        : `Oblique, ${removedSide(plane)} removed`;
      this.#readout.textContent = `${(-plane.offset - min).toFixed(1)} mm`;
    } else {
      this.#side.textContent = "Nothing is cut";
      this.#readout.textContent = "";
    }
  }

  #cutAcross(axis: Vector3): void {
    const { info, state } = this.#viewer;
    if (info) {
      this.#viewer.setPlane(
        planeAcross(axis, info.bounds, viewDirection(state.view.azimuth, state.view.elevation)),
      );
    }
  }

  /** Keeps the plane where it cuts something. */
  #moveTo(position: number): void {
    const { info, state } = this.#viewer;
    if (info && state.plane) {
      const [min, max] = projectBox(info.bounds, state.plane.normal.clone().negate());
      const offset = -Math.min(max, Math.max(min, position));
      this.#viewer.setPlane({ normal: state.plane.normal, offset });
    }
  }
}

function capital(word: string): string {
  return word[0]!.toUpperCase() + word.slice(1);
}
