import type { Vector3 } from "three";

import { canDraw, type Cut } from "./model/cut";
import { flipped, type Plane, planeThrough, projectBox } from "./model/geometry";
import { isSameWindow } from "./model/grey";
import { History } from "./model/history";
import { freeAxis, kAxes, type Orientation, planeAcross, planePosition } from "./model/planes";
import { stateText } from "./model/states";
import { anglesOf, viewDirection, viewFrom } from "./model/view";
import { kChosenLook, type ViewerState } from "./model/viewer_state";
import type { Viewer } from "./viewer";

/** Of a slab when it is made, and the least there is: mm. */
export const kThickness = 20;
export const kLeastThickness = 1;
/** Cosine: a plane that is seen along itself has no far side. */
const kEdgeOn = 0.05;

/** Of what is shown, what is undone and done again. */
const kUndone = [
  "mode",
  "cuts",
  "active",
  ...kChosenLook,
  "window",
  "marks",
  "tourMarks",
  "stops",
] as const satisfies readonly (keyof ViewerState)[];
type Moment = Pick<ViewerState, (typeof kUndone)[number]>;

/**
 * A movement is one step of the history, from the press that begins it to its end. Of keys and wheels, the next step begins
 * where nothing has changed for so long.
 */
const kStepMs = 400;

/** Where the active plane is: on a scale in mm, or of states in the uniaxial mode. */
export interface Position {
  min: number;
  max: number;
  step: number;
  value: number;
}

/** What people do with a case, whatever they do it with: a page's panel, keys, or a panel in a headset. */
export class Actions {
  /** Unit vector towards who looks, RAS: a new plane removes what lies there. */
  lookingFrom: () => Vector3;
  readonly #viewer: Viewer;
  #lastCuts: readonly Cut[] = [];
  #stepRest = 0; // of a state
  #history: History<Moment>;
  #latest: Moment;
  #changed = 0; // when, ms
  #restoring = false;
  readonly #holders = new Set<unknown>(); // hands and pointers that hold something

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    this.#latest = this.#moment;
    this.#history = new History(this.#latest);
    this.lookingFrom = () => viewDirection(viewer.state.view.azimuth, viewer.state.view.elevation);
  }

  get isUniaxial(): boolean {
    return this.#viewer.state.mode === "uniaxial";
  }

  toggleMode(): void {
    this.#viewer.store.setMode(this.isUniaxial ? "arbitrary" : "uniaxial");
  }

  orient(name: Orientation): void {
    if (!this.isUniaxial) {
      this.#cutAcross(kAxes[name]);
    }
  }

  /** Cuts through a point. */
  orientThrough(name: Orientation, point: Vector3): void {
    if (!this.isUniaxial) {
      this.#cutAcross(kAxes[name], point);
    }
  }

  flip(): void {
    const { cut } = this.#viewer;
    if (cut) {
      // What a slab keeps stays.
      const plane = flipped(cut);
      this.#viewer.store.movePlane({ ...plane, offset: plane.offset - (cut.thickness ?? 0) });
    }
  }

  /** Whether the active cut's face is on the far side of what it keeps. */
  get isFaceAway(): boolean {
    const { cut } = this.#viewer;
    return cut !== null && cut.thickness === null && cut.normal.dot(this.lookingFrom()) > kEdgeOn;
  }

  /** Looks at the active cut's face, from where the view is mirrored by the plane. */
  turnToFace(): void {
    const { cut } = this.#viewer;
    if (cut) {
      this.#viewer.store.setView(anglesOf(this.lookingFrom().reflect(cut.normal)));
    }
  }

  /** Nothing cut, or what was before. */
  toggle(): void {
    const { cuts } = this.#viewer.state;
    if (cuts.length > 0) {
      this.#lastCuts = cuts;
      this.#viewer.store.setCuts([]);
    } else if (this.#lastCuts.length > 0) {
      this.#viewer.store.setCuts(this.#lastCuts);
    } else {
      this.#cutAcross(kAxes.axial);
    }
  }

  get canAdd(): boolean {
    const more = { normal: kAxes.axial, offset: 0, thickness: null };
    return !this.isUniaxial && canDraw([...this.#viewer.state.cuts, more]);
  }

  /** Cuts with one more plane, across the body axis that is cut least. */
  add(): void {
    const { cuts } = this.#viewer.state;
    const plane = this.#planeAcross(freeAxis(cuts));
    if (plane && !this.isUniaxial) {
      this.#viewer.store.setCuts([...cuts, { ...plane, thickness: null }], cuts.length);
    }
  }

  /** Without the active plane. */
  remove(): void {
    const { cuts, active } = this.#viewer.state;
    this.#viewer.store.setCuts(
      cuts.filter((_, i) => i !== active),
      active - 1,
    );
  }

  /** Moves another plane from now on; by default the next. */
  activate(index = this.#viewer.state.active + 1): void {
    const { cuts } = this.#viewer.state;
    if (cuts.length > 0) {
      this.#viewer.store.setCuts(cuts, index % cuts.length);
    }
  }

  toggleSlab(): void {
    const { cut } = this.#viewer;
    if (cut) {
      this.setThickness(cut.thickness === null ? kThickness : null);
    }
  }

  /** Of the active cut; null: a plane, not a slab. */
  setThickness(mm: number | null): void {
    const { cuts, active } = this.#viewer.state;
    const thickness = mm && Math.max(kLeastThickness, mm);
    this.#viewer.store.setCuts(
      cuts.map((cut, i) => (i === active ? { ...cut, thickness } : cut)),
      active,
    );
  }

  /** Null where nothing is cut. Towards the end less is removed, or states go along the axis. */
  get position(): Position | null {
    const { info, cut, planeState } = this.#viewer.store;
    if (!info || !cut) {
      return null;
    }
    if (planeState !== null) {
      return { min: 0, max: info.states.count - 1, step: 1, value: planeState };
    }
    const [min, max] = projectBox(info.bounds, cut.normal.clone().negate());
    return { min, max, step: 0.1, value: -cut.offset };
  }

  /** Where the plane is in the patient, or which state; empty where nothing is cut. */
  get positionText(): string {
    const { info, cut, planeState } = this.#viewer.store;
    if (!info || !cut) {
      return "";
    }
    return planeState === null ? planePosition(cut) : stateText(info.states, planeState);
  }

  /** To a value of `position`'s scale, or its end. */
  moveTo(value: number): void {
    const { cut } = this.#viewer;
    const { position } = this;
    if (cut && position) {
      const bounded = Math.min(position.max, Math.max(position.min, value));
      if (this.isUniaxial) {
        this.#viewer.store.setPlaneState(bounded);
      } else {
        this.#viewer.store.movePlane({ normal: cut.normal, offset: -bounded });
      }
    }
  }

  /** Moves the plane by mm along its normal, towards what it removes; in the uniaxial mode by states. */
  step(by: number): void {
    const { position } = this;
    if (position) {
      // A wheel may turn by less than a state at a time.
      const sum = by + (by * this.#stepRest > 0 ? this.#stepRest : 0);
      const whole = this.isUniaxial ? Math.trunc(sum) : sum;
      this.#stepRest = sum - whole;
      this.moveTo(position.value + whole);
    }
  }

  /** The view and the plane that a case starts with. */
  reset(): void {
    const { info } = this.#viewer;
    if (info) {
      this.#viewer.store.setView(viewFrom(28, 24));
      this.resetPlane();
    }
  }

  resetPlane(): void {
    const { info } = this.#viewer;
    if (info) {
      this.#viewer.store.setCuts([]);
      this.#cutAcross(info.states.axis);
    }
  }

  /** Slices beside the picture, or none. */
  toggleSlices(): void {
    const { state, store } = this.#viewer;
    store.showSlices(state.slices ? null : state.cuts.length > 0 ? "plane" : "axial");
  }

  /** Faces cinematic or grey, wholly. */
  toggleGrey(): void {
    this.#viewer.store.setGrey(this.#viewer.state.grey > 0 ? 0 : 1);
  }

  /** The next of the windows that the case's values are usually seen through. */
  nextWindow(): void {
    const windows = [...this.#viewer.windows.values()];
    const at = windows.findIndex((one) => isSameWindow(one, this.#viewer.window));
    this.#viewer.store.setWindow(windows[(at + 1) % windows.length] ?? null);
  }

  get canUndo(): boolean {
    return this.#history.canUndo || !isSame(this.#latest, this.#history.current);
  }

  get canRedo(): boolean {
    return this.#history.canRedo && isSame(this.#latest, this.#history.current);
  }

  undo(): void {
    this.#record();
    this.#restore(this.#history.undo());
  }

  redo(): void {
    this.#record();
    this.#restore(this.#history.redo());
  }

  /** After every change of the viewer's state. */
  observe(): void {
    const moment = this.#moment;
    if (this.#restoring || isSame(moment, this.#latest)) {
      return;
    }
    const now = performance.now();
    if (this.#holders.size === 0 && now - this.#changed > kStepMs) {
      this.#record();
    }
    this.#latest = moment;
    this.#changed = now;
  }

  /** A pointer or a hand takes hold of something: what changes until it lets go is one step, however long it takes. */
  takeHold(holder: unknown): void {
    if (this.#holders.size === 0) {
      this.#record();
    }
    this.#holders.add(holder);
  }

  letGo(holder: unknown): void {
    if (this.#holders.delete(holder)) {
      this.#changed = -Infinity;
    }
  }

  /** Nothing is held any more. */
  letAllGo(): void {
    this.#holders.clear();
  }

  /** What was done with another case cannot be undone in this one. */
  forget(): void {
    this.#latest = this.#moment;
    this.#history = new History(this.#latest);
  }

  get #moment(): Moment {
    const { state } = this.#viewer.store;
    return Object.fromEntries(kUndone.map((key) => [key, state[key]])) as unknown as Moment;
  }

  #record(): void {
    if (!isSame(this.#latest, this.#history.current)) {
      this.#history.record(this.#latest);
    }
  }

  #restore(moment: Moment): void {
    this.#restoring = true;
    this.#latest = moment;
    this.#viewer.store.restore(moment);
    this.#restoring = false;
  }

  #planeAcross(axis: Vector3): Plane | null {
    const { info } = this.#viewer;
    return info && planeAcross(axis, info.bounds, this.lookingFrom());
  }

  /** Turns the plane, or makes it: through the middle, unless it is said where. */
  #cutAcross(axis: Vector3, point?: Vector3): void {
    const middle = this.#planeAcross(axis);
    const plane = middle && point ? planeThrough(middle.normal, point) : middle;
    if (plane && this.#viewer.cut) {
      this.#viewer.store.movePlane(plane);
    } else if (plane) {
      this.#viewer.store.setCuts([{ ...plane, thickness: null }]);
    }
  }
}

/** These are many, and the same where nobody touched them. */
const kMany: readonly (keyof Moment)[] = ["marks", "tourMarks", "stops"];

function isSame(a: Moment, b: Moment): boolean {
  return kUndone.every(
    (key) => a[key] === b[key] || (!kMany.includes(key) && JSON.stringify(a[key]) === JSON.stringify(b[key])),
  );
}
