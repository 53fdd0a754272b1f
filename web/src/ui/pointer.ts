import { Vector3 } from "three";

import { draggedWindow } from "../model/grey";
import { type Grip, PlaneDrag } from "../model/plane_drag";
import { cameraAxes, cameraDistance, viewDirection } from "../model/view";
import type { Viewer } from "../viewer";

const kDegreesPerPixel = 0.4;
export const kMaxElevation = 89.9;
export const kZoom: readonly [number, number] = [0.25, 24];

type Gesture = { kind: "orbit" } | { kind: "pan" } | { kind: "window" } | { kind: "plane"; drag: PlaneDrag };

/** Mouse, pen and touch on the canvas: turns, moves and zooms the view, drags the plane's handle and the window. */
export class PointerControls {
  readonly #viewer: Viewer;
  readonly #pointers = new Map<number, { x: number; y: number }>();
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

  #at(event: PointerEvent): { x: number; y: number } {
    const box = this.#viewer.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  #down(event: PointerEvent): void {
    const viewer = this.#viewer;
    const at = this.#at(event);
    viewer.canvas.setPointerCapture(event.pointerId);
    viewer.canvas.focus({ preventScroll: true });
    this.#pointers.set(event.pointerId, at);
    const byFinger = event.pointerType === "touch";
    const grip =
      this.#pointers.size === 1 && event.button === 0 ? viewer.picking.gripAt(at.x, at.y, byFinger) : null;
    if (grip && viewer.cut) {
      const { center, radius } = viewer.picking.handle;
      const { view } = viewer.state;
      const { down } = cameraAxes(viewDirection(view.azimuth, view.elevation).negate());
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
    const at = this.#at(event);
    const before = this.#pointers.get(event.pointerId);
    if (!before || !this.#gesture) {
      this.#setHover(this.#viewer.picking.gripAt(at.x, at.y));
      return;
    }
    const spread = this.#spread();
    this.#pointers.set(event.pointerId, at);
    const { view } = this.#viewer.state;
    if (this.#gesture.kind === "plane") {
      this.#viewer.store.movePlane(
        this.#gesture.drag.move(this.#viewer.camera.ray(at.x, at.y), event.shiftKey),
      );
    } else if (this.#gesture.kind === "orbit") {
      this.#viewer.store.setView({
        azimuth: wrapped(view.azimuth - kDegreesPerPixel * (at.x - before.x)),
        elevation: clamp(
          view.elevation + kDegreesPerPixel * (at.y - before.y),
          -kMaxElevation,
          kMaxElevation,
        ),
      });
    } else if (this.#gesture.kind === "window") {
      const { window, section } = this.#viewer;
      if (window && section) {
        this.#viewer.store.setWindow(draggedWindow(window, at.x - before.x, at.y - before.y, section.curve));
      }
    } else {
      this.#pan((at.x - before.x) / this.#pointers.size, (at.y - before.y) / this.#pointers.size);
      if (spread > 0) {
        this.#zoom(this.#spread() / spread);
      }
    }
  }

  /** Whether grey values are shown at a place, through a window. */
  #showsGreyAt({ x, y }: { x: number; y: number }): boolean {
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

  /** Distance between two fingers, CSS px. */
  #spread(): number {
    const [a, b] = [...this.#pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  #pan(dx: number, dy: number): void {
    const { info, state } = this.#viewer;
    if (!info) {
      return;
    }
    const { right, down } = cameraAxes(viewDirection(state.view.azimuth, state.view.elevation).negate());
    const mmPerPixel = cameraDistance(state.view, info.sphere) / this.#viewer.camera.focalLength;
    const pan = new Vector3().copy(state.view.pan);
    pan.addScaledVector(right, -dx * mmPerPixel).addScaledVector(down, -dy * mmPerPixel);
    pan.clampLength(0, Math.max(2 * info.sphere.radius, state.view.pan.length()));
    this.#viewer.store.setView({ pan });
  }

  #zoom(factor: number): void {
    this.#viewer.store.setView({ zoom: clamp(this.#viewer.state.view.zoom * factor, ...kZoom) });
  }
}

function clamp(value: number, min: number, max: number): number {
  return Math.min(max, Math.max(min, value));
}

/** An angle in [−180°, 180°). */
export function wrapped(degrees: number): number {
  return ((((degrees + 180) % 360) + 360) % 360) - 180;
}
