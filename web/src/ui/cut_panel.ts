import { type Actions, kLeastThickness, kThickness } from "../actions";
import type { Follow } from "../model/follower";
import { kOrientations, orientationOf, planeText } from "../model/planes";
import { kModes } from "../model/states";
import { decimal } from "../model/values";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { each, h, icon, kIcons, type Live } from "./dom";
import { range } from "./range";
import { choices, segments } from "./segments";
import { slicesButton } from "./slices";

/** Where the cut is and what it removes: its planes, their orientation and position. */
export class CutPanel {
  readonly #viewer: Viewer;
  readonly #actions: Actions;
  readonly #live: Follow;

  constructor(viewer: Viewer, actions: Actions, live: Follow) {
    this.#viewer = viewer;
    this.#actions = actions;
    this.#live = live;
  }

  /** What is done to all planes. */
  get header(): HTMLElement {
    const t = texts().cut;
    const actions = this.#actions;
    const plain = (title: string, drawing: string, disabled: Live<boolean>, press: () => void) =>
      h("button", { class: "plain", title, disabled, onclick: press }, icon(drawing));
    return h(
      "header",
      {},
      h("h2", {}, t.title),
      plain(
        t.undo,
        kIcons.undo,
        this.#live(() => !actions.canUndo),
        () => actions.undo(),
      ),
      plain(
        t.redo,
        kIcons.redo,
        this.#live(() => !actions.canRedo),
        () => actions.redo(),
      ),
      h(
        "button",
        {
          class: "small",
          title: t.moreHint,
          disabled: this.#live(() => !actions.canAdd),
          onclick: () => actions.add(),
        },
        icon(kIcons.plus),
        t.more,
      ),
      slicesButton(this.#viewer, actions, this.#live, "narrow"),
      h(
        "button",
        {
          class: "plain",
          title: t.power,
          "aria-pressed": this.#live(() => this.#viewer.cut !== null),
          onclick: () => actions.toggle(),
        },
        icon(kIcons.power),
      ),
    );
  }

  /** Of the papers: along the case's axis, or anywhere. */
  get modes(): HTMLElement {
    const t = texts().cut;
    const { store } = this.#viewer;
    const names = Object.fromEntries(kModes.map((mode) => [mode, t.modes[mode]])) as typeof t.modes;
    return choices(
      t.mode,
      names,
      (mode) => this.#live(() => store.state.mode === mode),
      (mode) => store.setMode(mode),
      (mode) => ({ hint: t.modeHints[mode] }),
    );
  }

  /** Which plane, its orientation and where it is: what is needed most. */
  get place(): HTMLElement {
    return h("div", { class: "place" }, this.#planes(), this.#orientations(), ...this.#position());
  }

  /** What else is done to the active plane. */
  get tools(): HTMLElement {
    const t = texts().cut;
    const { store } = this.#viewer;
    const actions = this.#actions;
    const uniaxial = this.#live(() => actions.isUniaxial);
    return h(
      "div",
      {},
      segments(
        t.plane,
        [
          {
            text: t.flip,
            hint: this.#live(() => (actions.isUniaxial ? t.flipByStates : t.flipHint)),
            icon: kIcons.flip,
            disabled: uniaxial,
            press: () => actions.flip(),
          },
          { text: t.reset, hint: t.resetHint, icon: kIcons.reset, press: () => actions.reset() },
          {
            text: t.slab,
            hint: t.slabHint,
            icon: kIcons.slab,
            disabled: uniaxial,
            pressed: this.#live(() => this.#isSlab),
            press: () => actions.toggleSlab(),
          },
          {
            text: t.handle,
            hint: t.handleHint,
            icon: kIcons.eye,
            pressed: this.#live(() => store.state.handle),
            press: () => store.setHandle(!store.state.handle),
          },
        ],
        "tall",
      ),
      this.#thickness(),
      h(
        "button",
        {
          class: "small far",
          hidden: this.#live(() => !actions.isFaceAway),
          onclick: () => actions.turnToFace(),
        },
        icon(kIcons.eye),
        t.turn,
      ),
    );
  }

  /** One button for each plane, where there are several. */
  #planes(): HTMLElement {
    const t = texts().cut;
    const { store } = this.#viewer;
    const buttons = h("span", { class: "segments fit", role: "group", "aria-label": t.planes });
    const count = this.#live(() => store.state.cuts.length);
    each(
      buttons,
      this.#live(() => Array.from({ length: count.value }, (_, i) => i)),
      (i) =>
        h(
          "button",
          {
            title: t.planeHint(i + 1),
            "aria-pressed": this.#live(() => store.state.active === i),
            onclick: () => this.#actions.activate(i),
          },
          String(i + 1),
        ),
    );
    return h(
      "div",
      { class: "titled planes", hidden: this.#live(() => count.value < 2) },
      buttons,
      h(
        "button",
        { class: "small", title: t.removeHint, onclick: () => this.#actions.remove() },
        icon(kIcons.minus),
        t.remove,
      ),
    );
  }

  #orientations(): HTMLElement {
    const t = texts();
    const actions = this.#actions;
    const orientation = this.#live(() => {
      const { cut } = this.#viewer;
      return cut && orientationOf(cut);
    });
    const group = segments(
      t.cut.orientation,
      kOrientations.map((name) => ({
        text: t.orientations[name],
        hint: t.cut.orientationHint(t.orientations[name]),
        icon: kIcons[name],
        pressed: this.#live(() => orientation.value === name),
        press: () => actions.orient(name),
      })),
      "tall",
    );
    return h("div", { hidden: this.#live(() => actions.isUniaxial) }, group);
  }

  /** In words, and on a slider; to the right less is removed, or states go along the axis. */
  #position(): HTMLElement[] {
    const t = texts().cut;
    const { store } = this.#viewer;
    const actions = this.#actions;
    const byState = this.#live(() => store.planeState !== null);
    const side = this.#live(() => {
      const { cut } = this.#viewer;
      return cut ? planeText(cut) : t.nothing;
    });
    const readout = this.#live(() => actions.positionText);
    const slider = range(
      {
        "aria-label": this.#live(() => (actions.isUniaxial ? t.state : t.position)),
        "aria-valuetext": this.#live(() => readout.value || t.nothing),
        disabled: this.#live(() => this.#viewer.cut === null),
      },
      this.#live(() => actions.position),
      (value) => actions.moveTo(value),
    );
    const every = this.#live(() => {
      const spacing = store.states?.spacing ?? 0;
      return t.every(side.value, decimal(spacing, 2));
    });
    return [
      h(
        "div",
        { class: "row position" },
        h("span", { class: "side", hidden: byState }, side),
        h("output", { class: "readout", "aria-live": "off" }, readout),
      ),
      slider,
      h("p", { class: "hint", hidden: this.#live(() => !byState.value) }, every),
    ];
  }

  #thickness(): HTMLElement {
    const t = texts().cut;
    const thickness = this.#live(() => this.#viewer.cut?.thickness ?? kThickness);
    const slider = range(
      { "aria-label": t.thickness },
      this.#live(() => {
        const { position } = this.#actions;
        const most = position ? position.max - position.min : kThickness;
        return {
          min: kLeastThickness,
          max: Math.max(kLeastThickness, most),
          step: 0.5,
          value: thickness.value,
        };
      }),
      (mm) => this.#actions.setThickness(mm),
    );
    return h(
      "div",
      { hidden: this.#live(() => !this.#isSlab) },
      h(
        "div",
        { class: "row position" },
        h("span", { class: "side" }, t.slab),
        h(
          "output",
          { class: "readout", "aria-live": "off" },
          this.#live(() => `${thickness.value.toFixed(1)} mm`),
        ),
      ),
      slider,
    );
  }

  get #isSlab(): boolean {
    return (this.#viewer.cut?.thickness ?? null) !== null;
  }
}
