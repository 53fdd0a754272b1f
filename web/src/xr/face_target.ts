import type { PointerEvent } from "@pmndrs/pointer-events";
import { type Intersection, type Matrix4, Object3D, Ray, type Raycaster, type Vector3 } from "three";

import type { Marking } from "../model/marking";
import { type Reading, readSection } from "../model/values";
import type { Viewer } from "../viewer";
import { handOf } from "./hand";
import type { WindowGrip } from "./window_grip";

/** Before the plane and the case, behind the panel. */
const kOrder = 1.5;

/**
 * The faces of the cut, while points of them are marked or their window is changed: hands point at them, and a press marks
 * a point, or takes hold of the window.
 */
export class FaceTarget extends Object3D {
  /** What is pointed at. */
  reading: Reading | null = null;
  readonly #viewer: Viewer;
  readonly #roomFromPatient: Matrix4;
  readonly #patientFromRoom: Matrix4;
  readonly #ray = new Ray();

  /** The matrices are those of the last frame, each the other's inverse. */
  constructor(
    viewer: Viewer,
    marking: Marking,
    window: WindowGrip,
    roomFromPatient: Matrix4,
    patientFromRoom: Matrix4,
  ) {
    super();
    this.#viewer = viewer;
    this.#roomFromPatient = roomFromPatient;
    this.#patientFromRoom = patientFromRoom;
    this.pointerEventsOrder = kOrder;
    this.addEventListener("pointermove", ({ point }: PointerEvent) => {
      this.reading = this.#read(point);
    });
    this.addEventListener("pointerout", () => (this.reading = null));
    this.addEventListener("pointerdown", (event: PointerEvent) => {
      const hand = handOf(event);
      if (marking.kind === null) {
        if (hand && window.enabled) {
          window.begin(hand);
        }
        return;
      }
      const reading = this.#read(event.point);
      const plane = reading && viewer.picking.faceOf(reading.point);
      if (reading && marking.put({ point: reading.point, plane })) {
        hand?.pulse(0.6, 20);
      }
    });
  }

  override raycast({ ray }: Raycaster, intersects: Intersection[]): void {
    const reading = this.#viewer.picking.readingAlong(
      this.#ray.copy(ray).applyMatrix4(this.#patientFromRoom),
    );
    if (reading) {
      const point = reading.point.applyMatrix4(this.#roomFromPatient);
      intersects.push({ object: this, point, distance: point.distanceTo(ray.origin) });
    }
  }

  /** Of a point in the room. */
  #read(point: Vector3): Reading | null {
    const { section } = this.#viewer;
    return section && readSection(section, point.clone().applyMatrix4(this.#patientFromRoom));
  }
}
