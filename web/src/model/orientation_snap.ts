import type { Vector3 } from "three";

import { kAxes, kOrientations } from "./planes";

/** A body plane catches a plane that is turned as near to it, and lets go of it farther away: radians. */
const kCatch = (5 * Math.PI) / 180;
const kLetGo = (8 * Math.PI) / 180;
const kDirections = kOrientations.flatMap((name) => [kAxes[name], kAxes[name].clone().negate()]);

/** Axial, coronal and sagittal planes that a plane turned by hand clicks onto. */
export class OrientationSnap {
  enabled = true;
  #caught: Vector3 | null = null;

  /** The body axis that holds the plane's normal. */
  get caught(): Vector3 | null {
    return this.#caught;
  }

  /** The plane is taken hold of. */
  begin(normal: Vector3): void {
    this.#caught = null;
    this.turn(normal);
  }

  /** The normal of a plane that the hand turns to `normal` (unit, RAS): this one, or the axis that holds it. */
  turn(normal: Vector3): Vector3 {
    const isHeld = this.enabled && this.#caught !== null && this.#caught.angleTo(normal) < kLetGo;
    if (!isHeld) {
      this.#caught = (this.enabled && kDirections.find((one) => one.angleTo(normal) < kCatch)) || null;
    }
    return this.#caught ?? normal;
  }
}
