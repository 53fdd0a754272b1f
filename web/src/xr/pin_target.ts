import type { PointerEvent } from "@pmndrs/pointer-events";
import { type Intersection, type Matrix4, Object3D, type Raycaster, Vector3 } from "three";

import type { Marking, Pin } from "../model/pins";
import type { Viewer } from "../viewer";
import { handOf } from "./hand";

/** Before the faces that pins are on, behind the panel. */
const kOrder = 1.6;
/** How near to a ray a pin is met, of its distance. */
const kReach = 0.02;

/** Pins, while points are marked: a press on one removes it. */
export class PinTarget extends Object3D {
  /** What is pointed at. */
  pin: Pin | null = null;
  readonly #viewer: Viewer;
  readonly #roomFromPatient: Matrix4;
  readonly #place = new Vector3(); // scratch

  /** The matrix is that of the last frame. */
  constructor(viewer: Viewer, marking: Marking, roomFromPatient: Matrix4) {
    super();
    this.#viewer = viewer;
    this.#roomFromPatient = roomFromPatient;
    this.pointerEventsOrder = kOrder;
    this.addEventListener("pointermove", ({ instanceId }: PointerEvent) => {
      this.pin = viewer.state.pins[instanceId!] ?? null;
    });
    this.addEventListener("pointerout", () => (this.pin = null));
    this.addEventListener("pointerdown", (event: PointerEvent) => {
      handOf(event)?.pulse(0.6, 20);
      viewer.removePin(event.instanceId!);
      this.pin = null;
      marking.toggle(null);
    });
  }

  override raycast({ ray }: Raycaster, intersects: Intersection[]): void {
    this.#viewer.state.pins.forEach(({ point }, instanceId) => {
      const place = this.#place.copy(point).applyMatrix4(this.#roomFromPatient);
      const distance = place.distanceTo(ray.origin);
      if (ray.distanceToPoint(place) < kReach * distance) {
        intersects.push({ object: this, point: place.clone(), distance, instanceId });
      }
    });
  }
}
