import { draggedWindow } from "../model/grey";
import type { Place } from "../model/label_layout";
import { placeOf, pointOf } from "../model/slice";
import { placeOn, spreadOf } from "./place";
import type { SlicePane } from "./slice_pane";

/** A finger that moved less has pressed, px. */
const kPress = 8;
/** So near to the crosshair a finger takes hold of it, px. */
const kHold = 28;
/** Of a drag, px a slice; of a wheel, as much as a notch turns at least and at most. */
const kPixelsPerSlice = 6;
const kNotch = { least: 50, usual: 120 };
/** Of keys. */
const kFast = 10;
const kZoomBy = 1.15;
const kPan = 24; // px

type Gesture = "point" | "pan" | "window" | "slide" | "press";

/** Mouse, pen, fingers and keys on a slice. */
export class SlicePointer {
  readonly #pane: SlicePane;
  readonly #pointers = new Map<number, Place>();
  #gesture: Gesture | null = null;
  #began: Place = { x: 0, y: 0 };
  #rest = 0; // of a slice

  constructor(pane: SlicePane) {
    this.#pane = pane;
    const { canvas } = pane;
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", (event) => this.#up(event, true));
    canvas.addEventListener("pointercancel", (event) => this.#up(event, false));
    canvas.addEventListener("pointerleave", () => (pane.pointer.value = null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", () => this.#double());
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => {
      if (this.#key(event)) {
        event.preventDefault();
        event.stopPropagation(); // the same keys do other things to the case
      }
    });
  }

  /** What is begun is ended; or else the slice is enlarged, or all of them are seen again. */
  #double(): void {
    const { marking, viewer } = this.#pane.context;
    if (marking.kind !== null) {
      marking.finish();
    } else {
      this.#pane.enlarge(viewer.state.slices?.shown === "all");
    }
  }

  #down(event: PointerEvent): void {
    const pane = this.#pane;
    const at = placeOn(this.#pane.canvas, event);
    pane.canvas.setPointerCapture(event.pointerId);
    pane.canvas.focus({ preventScroll: true });
    this.#pointers.set(event.pointerId, at);
    this.#began = at;
    this.#rest = 0;
    const { kind } = pane.context.marking;
    if (this.#pointers.size > 1) {
      this.#gesture = "pan";
    } else if (kind && event.button === 0) {
      this.#gesture = null;
      const frame = pane.frame.value;
      if (frame) {
        pane.mark(pointOf(frame, at));
      }
    } else if (event.pointerType === "touch") {
      this.#gesture = this.#isAtCrosshair(at) ? "point" : "press";
    } else {
      this.#gesture = this.#gestureOf(event);
      if (this.#gesture === "point") {
        pane.point(at);
      }
    }
  }

  #gestureOf({ button, shiftKey, altKey }: PointerEvent): Gesture {
    if (button === 1 || shiftKey) {
      return "pan";
    }
    const hasWindow = this.#pane.context.viewer.window !== null;
    return button !== 2 && !altKey ? "point" : hasWindow ? "window" : "pan";
  }

  #isAtCrosshair(place: Place): boolean {
    const frame = this.#pane.frame.value;
    const { at } = this.#pane;
    const cross = frame && at && placeOf(frame, at);
    return cross !== null && Math.hypot(cross.x - place.x, cross.y - place.y) < kHold;
  }

  #move(event: PointerEvent): void {
    const pane = this.#pane;
    const at = placeOn(this.#pane.canvas, event);
    pane.pointer.value = event.pointerType === "touch" && this.#gesture !== "point" ? null : at;
    const before = this.#pointers.get(event.pointerId);
    if (!before) {
      return;
    }
    const spread = spreadOf(this.#pointers);
    this.#pointers.set(event.pointerId, at);
    const [dx, dy] = [at.x - before.x, at.y - before.y];
    if (this.#gesture === "press") {
      this.#gesture = this.#swipe(at);
    } else if (this.#gesture === "point") {
      pane.point(at);
    } else if (this.#gesture === "slide") {
      this.#slide(-dy / kPixelsPerSlice);
    } else if (this.#gesture === "window") {
      const { window, section, store } = pane.context.viewer;
      if (window && section) {
        store.setWindow(draggedWindow(window, dx, dy, section.curve));
      }
    } else if (this.#gesture === "pan") {
      pane.pan(dx / this.#pointers.size, dy / this.#pointers.size);
      if (spread > 0) {
        pane.zoomAt(this.#middle(), spreadOf(this.#pointers) / spread);
      }
    }
  }

  /** What a finger begins to do that went to `at`: up or down it slides, to the sides it sets the window. */
  #swipe({ x, y }: Place): Gesture {
    const [dx, dy] = [Math.abs(x - this.#began.x), Math.abs(y - this.#began.y)];
    if (Math.max(dx, dy) < kPress) {
      return "press";
    }
    return dx > dy && this.#pane.context.viewer.window ? "window" : "slide";
  }

  #up(event: PointerEvent, isDone: boolean): void {
    if (this.#gesture === "press" && isDone) {
      this.#pane.point(this.#began);
    }
    this.#pointers.delete(event.pointerId);
    if (this.#pointers.size === 0) {
      this.#gesture = null;
    }
  }

  #wheel(event: WheelEvent): void {
    event.preventDefault();
    const delta = event.deltaY * (event.deltaMode === 1 ? 40 : 1);
    if (event.ctrlKey || event.metaKey) {
      this.#pane.zoomAt(placeOn(this.#pane.canvas, event), Math.exp(-0.002 * delta));
    } else if (Math.abs(delta) >= kNotch.least) {
      this.#rest = 0;
      this.#pane.slide(-Math.sign(delta) * Math.max(1, Math.round(Math.abs(delta) / kNotch.usual)));
    } else {
      this.#slide(-delta / kNotch.least);
    }
  }

  /** By whole slices, when there are some together. */
  #slide(slices: number): void {
    this.#rest += slices;
    const whole = Math.trunc(this.#rest);
    if (whole !== 0) {
      this.#rest -= whole;
      this.#pane.slide(whole);
    }
  }

  #middle(): Place {
    const all = [...this.#pointers.values()];
    const sum = all.reduce((total, { x, y }) => ({ x: total.x + x, y: total.y + y }), { x: 0, y: 0 });
    return { x: sum.x / all.length, y: sum.y / all.length };
  }

  /** Returns whether it was a key of slices. */
  #key({ key, shiftKey, ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
    const pane = this.#pane;
    const arrows: Record<string, readonly [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    const arrow = arrows[key];
    const { marking } = pane.context;
    const times = shiftKey ? kFast : 1;
    if (metaKey) {
      return false;
    }
    if (arrow && altKey) {
      this.#step(times * arrow[0], times * arrow[1]);
    } else if (arrow && ctrlKey) {
      pane.pan(-times * kPan * arrow[0], -times * kPan * arrow[1]);
    } else if (ctrlKey || altKey) {
      return false;
    } else if (key === "ArrowUp" || key === "ArrowDown") {
      pane.slide(key === "ArrowUp" ? times : -times);
    } else if (key === "PageUp" || key === "PageDown") {
      pane.slide(key === "PageUp" ? kFast : -kFast);
    } else if (key === "+" || key === "=" || key === "-") {
      pane.zoomAt(this.#aim, key === "-" ? 1 / kZoomBy : kZoomBy);
    } else if (key === "0") {
      pane.fit();
    } else if (key === "Enter" && marking.kind === null) {
      this.#double();
    } else if (key === "i" || key === "l" || key === " ") {
      return this.#mark(key);
    } else {
      return false;
    }
    return true;
  }

  /** Marks the point under the pointer, or under the crosshair. */
  #mark(key: "i" | "l" | " "): boolean {
    const frame = this.#pane.frame.value;
    const { marking } = this.#pane.context;
    const kinds = { i: "point", l: "length", " ": marking.kind ?? "point" } as const;
    if (marking.kind !== null && marking.kind !== kinds[key]) {
      marking.toggle(kinds[key]);
    }
    if (frame) {
      this.#pane.mark(pointOf(frame, this.#aim), kinds[key]);
    }
    return true;
  }

  /** The pointer, or else the crosshair. */
  get #aim(): Place {
    const frame = this.#pane.frame.value;
    const { at } = this.#pane;
    return this.#pane.pointer.value ?? (frame && at ? placeOf(frame, at) : { x: 0, y: 0 });
  }

  /** Moves the crosshair by mm. */
  #step(right: number, down: number): void {
    const frame = this.#pane.frame.value;
    const { at } = this.#pane;
    if (frame && at) {
      const to = at.clone().addScaledVector(frame.axes.right, right).addScaledVector(frame.axes.down, down);
      this.#pane.context.viewer.store.setCrosshair(to);
    }
  }
}
