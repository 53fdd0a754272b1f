import { type Actions, kLeastThickness, kThickness, type Position } from "../actions";
import { kOrientations, type Orientation, orientationOf, planeText } from "../model/planes";
import { kModes, type Mode } from "../model/states";
import { capital, decimal } from "../model/values";
import type { Viewer } from "../viewer";
import type { ClipOperator } from "../worker/protocol";
import { h, icon, kIcons } from "./dom";

const kOperators: Record<ClipOperator, string> = {
  hard: "A splat is drawn whole or not at all, by its centre",
  soft: "A splat fades by how far its centre is from the plane",
  exact: "Every pixel integrates its splat up to the plane",
  layers: "Along the axis: what was baked of other states is shown or not, only at the plane pixels are cut",
};

const kModeHints: Record<Mode, string> = {
  uniaxial: "The plane moves along the case's axis, from state to state (U)",
  arbitrary: "The plane moves and turns freely (U)",
};

/** Everything about the cut: its planes, where they are, what is removed, how splats meet it. */
export class PlanePanel {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #actions: Actions;
  readonly #modes = new Map<Mode, HTMLButtonElement>();
  readonly #orientations = new Map<Orientation, HTMLButtonElement>();
  readonly #operators = new Map<ClipOperator, HTMLButtonElement>();
  readonly #orientationGroup: HTMLElement;
  readonly #slider: HTMLInputElement;
  readonly #statesHint = h("p", { class: "hint" });
  readonly #flip: HTMLButtonElement;
  readonly #readout = h("output", { class: "readout", "aria-live": "off" });
  readonly #side = h("span", { class: "side" });
  readonly #cuts = h("span", { class: "segments fit", role: "group", "aria-label": "Planes" });
  readonly #several: HTMLElement;
  readonly #add: HTMLButtonElement;
  readonly #slab: HTMLButtonElement;
  readonly #thickness: HTMLInputElement;
  readonly #thicknessReadout = h("output", { class: "readout", "aria-live": "off" });
  readonly #thicknessRow: HTMLElement;
  readonly #power: HTMLButtonElement;
  readonly #handle: HTMLButtonElement;
  readonly #hint = h("p", { class: "hint" });
  readonly #undo: HTMLButtonElement;
  readonly #redo: HTMLButtonElement;
  #shown = "";

  /** `faces` are the parts about cut faces. */
  constructor(viewer: Viewer, actions: Actions, faces: readonly HTMLElement[]) {
    this.#viewer = viewer;
    this.#actions = actions;
    for (const mode of kModes) {
      const button = h(
        "button",
        { title: kModeHints[mode], onclick: () => viewer.store.setMode(mode) },
        capital(mode),
      );
      this.#modes.set(mode, button);
    }
    for (const name of kOrientations) {
      const button = h(
        "button",
        { title: `${capital(name)} plane (${name[0]!.toUpperCase()})`, onclick: () => actions.orient(name) },
        icon(kIcons[name]),
        capital(name),
      );
      this.#orientations.set(name, button);
    }
    for (const [name, hint] of Object.entries(kOperators) as [ClipOperator, string][]) {
      const button = h("button", { title: hint, onclick: () => viewer.store.setClip(name) }, capital(name));
      this.#operators.set(name, button);
    }
    this.#slider = h("input", {
      type: "range",
      oninput: () => actions.moveTo(Number(this.#slider.value)),
    });
    this.#orientationGroup = h(
      "div",
      { class: "segments tall", role: "group", "aria-label": "Orientation" },
      ...this.#orientations.values(),
    );
    this.#flip = h("button", { onclick: () => actions.flip() }, icon(kIcons.flip), "Flip");
    this.#add = h(
      "button",
      { class: "small", title: "Cut with one more plane (N)", onclick: () => actions.add() },
      icon(kIcons.plus),
      "Plane",
    );
    this.#several = h(
      "div",
      { class: "titled planes" },
      this.#cuts,
      h(
        "button",
        { class: "small", title: "Remove this plane (X)", onclick: () => actions.remove() },
        icon(kIcons.minus),
        "Remove",
      ),
    );
    this.#slab = h(
      "button",
      { title: "A second face behind the plane (B)", onclick: () => actions.toggleSlab() },
      icon(kIcons.slab),
      "Slab",
    );
    this.#thickness = h("input", {
      type: "range",
      step: "0.5",
      min: String(kLeastThickness),
      "aria-label": "Thickness of the slab, mm",
      oninput: () => actions.setThickness(Number(this.#thickness.value)),
    });
    this.#thicknessRow = h(
      "div",
      {},
      h("div", { class: "row position" }, h("span", { class: "side" }, "Slab"), this.#thicknessReadout),
      this.#thickness,
    );
    this.#power = h(
      "button",
      { class: "plain", title: "Cut or uncut (P)", onclick: () => actions.toggle() },
      icon(kIcons.power),
    );
    this.#handle = h(
      "button",
      { title: "Show or hide the handle (H)", onclick: () => viewer.store.setHandle(!viewer.state.handle) },
      icon(kIcons.eye),
      "Handle",
    );
    this.#undo = h(
      "button",
      { class: "plain", title: "Undo (Ctrl+Z)", onclick: () => actions.undo() },
      icon(kIcons.undo),
    );
    this.#redo = h(
      "button",
      { class: "plain", title: "Redo (Ctrl+Shift+Z)", onclick: () => actions.redo() },
      icon(kIcons.redo),
    );
    this.element = h(
      "section",
      { class: "panel", part: "panel", "aria-label": "Cutting plane" },
      h("header", {}, h("h2", {}, "Cut"), this.#undo, this.#redo, this.#add, this.#power),
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
          { title: "Plane and view as at the start (R)", onclick: () => actions.reset() },
          icon(kIcons.reset),
          "Reset",
        ),
        this.#slab,
        this.#handle,
      ),
      this.#thicknessRow,
      ...faces,
      h("h3", {}, "Cut of the splats"),
      h(
        "div",
        { class: "segments", role: "group", "aria-label": "Clip operator" },
        ...this.#operators.values(),
      ),
      this.#hint,
    );
  }

  update(): void {
    this.#undo.disabled = !this.#actions.canUndo;
    this.#redo.disabled = !this.#actions.canRedo;
    const { state, info, cut, hasLayers, missesLayers } = this.#viewer;
    const { mode, cuts, active, clip, handle } = state;
    // Touching the page costs a layout, which turning the case need not.
    const shown = JSON.stringify([mode, cuts, active, clip, handle, info?.bounds, info?.states, hasLayers]);
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
    this.#operators.get("layers")!.hidden = !hasLayers;
    this.#hint.textContent = missesLayers ? this.#noLayersText : kOperators[clip];
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

  get #noLayersText(): string {
    return this.#viewer.hasLayers
      ? "Layers are for planes along the case's axis: this cut is exact"
      : "This case has no layers: the cut is exact";
  }

  get #uniaxial(): boolean {
    return this.#actions.isUniaxial;
  }

  /** Where the plane is: in words, and on the slider; to the right less is removed, or states go along the axis. */
  #updatePosition(): void {
    const { info, cut, planeState } = this.#viewer.store;
    this.#statesHint.hidden = planeState === null;
    this.#side.hidden = planeState !== null;
    this.#slider.setAttribute(
      "aria-label",
      this.#uniaxial ? "State of the plane" : "Position of the plane, mm",
    );
    const { position, positionText } = this.#actions;
    this.#readout.textContent = positionText;
    if (!cut || !info || !position) {
      this.#side.textContent = "Nothing is cut";
    } else {
      const { min, max } = position;
      this.#setSlider(position);
      this.#side.textContent = planeText(cut);
      this.#statesHint.textContent = `${planeText(cut)}, every ${decimal(info.states.spacing, 2)} mm`;
      if (planeState === null) {
        this.#thickness.max = String(max - min);
      }
    }
    this.#slider.setAttribute("aria-valuetext", this.#readout.textContent || "Nothing is cut");
  }

  #setSlider({ min, max, step, value }: Position): void {
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
            { title: `Move plane ${i + 1} (E: the next)`, onclick: () => this.#actions.activate(i) },
            String(i + 1),
          ),
        ),
      );
    }
    [...this.#cuts.children].forEach((button, i) =>
      button.setAttribute("aria-pressed", String(i === active)),
    );
    this.#several.hidden = cuts.length < 2;
    this.#add.disabled = !this.#actions.canAdd;
  }
}
