import { draggedWindow } from "../model/grey";
import type { Place } from "../model/label_layout";
import { type Grip, PlaneDrag } from "../model/plane_drag";
import { cameraDistance, pushed, turned, viewAxes, zoomed } from "../model/view";
import type { Viewer } from "../viewer";
import { placeOn, spreadOf } from "./place";

const kDegreesPerPixel = 0.4;

type Gesture = { kind: "orbit" } | { kind: "pan" } | { kind: "window" } | { kind: "plane"; drag: PlaneDrag };

/** Mouse, pen and touch on the canvas: turns, moves and zooms the view, drags the plane's handle and the window. */
export class PointerControls {
  readonly #viewer: Viewer;
  readonly #pointers = new Map<number, Place>();
  #gesture: Gesture | null = null;
  #hover: Grip | null = null;

  constructor(viewer: Viewer, stepPlane: (mm: number) => void, takesWheel: () => boolean) {
    this.#viewer = viewer;
    const { canvas } = viewer;
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", (event) => this.#up(event));
    canvas.addEventListener("pointercancel", (event) => this.#up(event));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener(
      "wheel",
      (event) => {
        if (!takesWheel()) {
          return;
        }
        event.preventDefault();
        const delta = event.deltaY * (event.deltaMode === 1 ? 20 : 1);
        if (event.ctrlKey || event.altKey) {
          stepPlane(-0.02 * delta);
        } else {
          this.#zoom(Math.exp(-0.0015 * delta));
        }
      },
      { passive: false },
    );
  }

  #down(event: PointerEvent): void {
    const viewer = this.#viewer;
    const at = placeOn(this.#viewer.canvas, event);
    viewer.canvas.setPointerCapture(event.pointerId);
    viewer.canvas.focus({ preventScroll: true });
    this.#pointers.set(event.pointerId, at);
    const byFinger = event.pointerType === "touch";
    const grip =
      this.#pointers.size === 1 && event.button === 0 ? viewer.picking.gripAt(at.x, at.y, byFinger) : null;
    if (grip && viewer.cut) {
      const { center, radius } = viewer.picking.handle;
      const { down } = viewAxes(viewer.state.view);
      const drag = new PlaneDrag(
        grip,
        viewer.cut,
        center,
        radius,
        down.negate(),
        viewer.camera.ray(at.x, at.y),
      );
      this.#gesture = { kind: "plane", drag };
      this.#setHover(grip);
    } else if (event.button === 2 && !event.shiftKey && this.#showsGreyAt(at)) {
      this.#gesture = { kind: "window" };
    } else {
      this.#gesture = {
        kind: event.button !== 0 || event.shiftKey || this.#pointers.size > 1 ? "pan" : "orbit",
      };
    }
  }

  #move(event: PointerEvent): void {
    const at = placeOn(this.#viewer.canvas, event);
    const before = this.#pointers.get(event.pointerId);
    if (!before || !this.#gesture) {
      this.#setHover(this.#viewer.picking.gripAt(at.x, at.y));
      return;
    }
    const spread = spreadOf(this.#pointers);
    this.#pointers.set(event.pointerId, at);
    const { view } = this.#viewer.state;
    if (this.#gesture.kind === "plane") {
      this.#viewer.store.movePlane(
        this.#gesture.drag.move(this.#viewer.camera.ray(at.x, at.y), event.shiftKey),
      );
    } else if (this.#gesture.kind === "orbit") {
      const [dx, dy] = [at.x - before.x, at.y - before.y];
      this.#viewer.store.setView(turned(view, -kDegreesPerPixel * dx, kDegreesPerPixel * dy));
    } else if (this.#gesture.kind === "window") {
      const { window, section } = this.#viewer;
      if (window && section) {
        this.#viewer.store.setWindow(draggedWindow(window, at.x - before.x, at.y - before.y, section.curve));
      }
    } else {
      this.#pan((at.x - before.x) / this.#pointers.size, (at.y - before.y) / this.#pointers.size);
      if (spread > 0) {
        this.#zoom(spreadOf(this.#pointers) / spread);
      }
    }
  }

  /** Whether grey values are shown at a place, through a window. */
  #showsGreyAt({ x, y }: Place): boolean {
    const { state, window } = this.#viewer;
    const grey = state.section === "volume" && state.grey > 0 && window !== null;
    return grey && this.#viewer.picking.readingAt(x, y) !== null;
  }

  #up(event: PointerEvent): void {
    this.#pointers.delete(event.pointerId);
    if (this.#pointers.size === 0) {
      this.#gesture = null;
      this.#setHover(null);
    }
  }

  #setHover(grip: Grip | null): void {
    if (grip !== this.#hover) {
      this.#hover = grip;
      this.#viewer.setHover(grip);
      this.#viewer.canvas.style.cursor = grip ? "grab" : "";
    }
  }

  #pan(dx: number, dy: number): void {
    const { camera, info, state, store } = this.#viewer;
    if (info) {
      const mm = cameraDistance(state.view, info.sphere) / camera.focalLength; // a pixel
      store.setView(pushed(state.view, info.sphere, mm * dx, mm * dy));
    }
  }

  #zoom(factor: number): void {
    this.#viewer.store.setView(zoomed(this.#viewer.state.view, factor));
  }
}
