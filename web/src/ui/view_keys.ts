import { cameraDistance, pushed, turned, viewAxes, zoomed } from "../model/view";
import type { Viewer } from "../viewer";

const kTurn = 5; // degrees a press, with Shift thrice as many
const kTilt = 2; // degrees, of the plane
const kPan = 0.04; // of what is seen
const kZoomBy = 1.15;

/** Turns, moves and zooms the view and tilts the plane by keys, as a mouse does, while the case has the focus. */
export class ViewKeys {
  readonly #viewer: Viewer;

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
  }

  /** Returns whether it was such a key. */
  press({ key, shiftKey, ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
    const arrows: Record<string, readonly [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const arrow = arrows[key];
    const times = shiftKey ? 3 : 1;
    if (arrow && !metaKey && (ctrlKey || altKey)) {
      const [across, along] = arrow;
      if (ctrlKey) {
        this.#tilt(times * across, times * along);
      } else {
        this.#pan(times * across, times * along);
      }
      return true;
    }
    if (ctrlKey || altKey || metaKey) {
      return false;
    }
    if (arrow && arrow[0] !== 0) {
      this.#turn(times * arrow[0], 0);
    } else if (key === "PageUp" || key === "PageDown") {
      this.#turn(0, times * (key === "PageUp" ? 1 : -1));
    } else if (key === "+" || key === "=" || key === "-") {
      this.#zoom(key === "-" ? 1 / kZoomBy : kZoomBy);
    } else {
      return false;
    }
    return true;
  }

  #turn(across: number, along: number): void {
    this.#viewer.store.setView(turned(this.#viewer.state.view, kTurn * across, kTurn * along));
  }

  #zoom(factor: number): void {
    this.#viewer.store.setView(zoomed(this.#viewer.state.view, factor));
  }

  /** Moves what is seen, as if it were pushed. */
  #pan(across: number, along: number): void {
    const { info, state, store } = this.#viewer;
    if (info) {
      const mm = (kPan * cameraDistance(state.view, info.sphere)) / state.view.zoom;
      store.setView(pushed(state.view, info.sphere, mm * across, -mm * along));
    }
  }

  /** Tilts the plane about the middle of its face: its removed side to the right, or up. */
  #tilt(across: number, along: number): void {
    const { cut, picking, state } = this.#viewer;
    const middle = picking.faceMiddle;
    if (!cut || !middle || state.mode === "uniaxial") {
      return;
    }
    const { right, down } = viewAxes(state.view);
    const radians = (kTilt * Math.PI) / 180;
    const normal = cut.normal
      .clone()
      .applyAxisAngle(down, -radians * across)
      .applyAxisAngle(right, -radians * along)
      .normalize();
    this.#viewer.store.movePlane({ normal, offset: normal.dot(middle) });
  }
}
