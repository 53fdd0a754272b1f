import { Quaternion, type Ray, Vector3 } from "three";

import { type Plane, planeThrough } from "./geometry";

/** Where the plane is taken: the arrow slides it along its normal, the rim tilts it about its centre. */
export type Grip = "arrow" | "rim";

/** Below this sine of the angle between pointer and normal, sliding follows the pointer's height instead. */
const kMinSine = 0.3;
/** Tilting within this angle of a body axis snaps to it, when asked to. */
const kSnapCosine = Math.cos((6 * Math.PI) / 180);

/** Parameter along axis (origin o, unit direction n) of the point nearest to the ray. */
function nearestOnAxis(ray: Ray, o: Vector3, n: Vector3): number {
  const w = new Vector3().subVectors(ray.origin, o);
  const b = ray.direction.dot(n);
  return (w.dot(n) - b * w.dot(ray.direction)) / (1 - b * b);
}

/** The unit vector from the centre to where the ray meets the sphere, or to the ray's nearest point beside it. */
function onSphere(ray: Ray, center: Vector3, radius: number, back: boolean): Vector3 {
  const near = ray.closestPointToPoint(center, new Vector3());
  const distance = near.distanceTo(center);
  if (distance < radius) {
    const half = Math.sqrt(radius * radius - distance * distance);
    near.addScaledVector(ray.direction, back ? half : -half);
  }
  return near.sub(center).normalize();
}

/**
 * One drag of the plane's handle, by pointer rays in RAS mm: a mouse's through the camera, or later a controller's.
 * Every move starts from where the drag began, so that nothing drifts.
 */
export class PlaneDrag {
  readonly #grip: Grip;
  readonly #plane: Plane;
  readonly #center: Vector3;
  readonly #radius: number;
  readonly #up: Vector3;
  readonly #start: Ray;
  readonly #back: boolean;
  readonly #grabbed: Vector3;

  /** `center` is the handle's centre on the plane, `up` the viewer's. */
  constructor(grip: Grip, plane: Plane, center: Vector3, radius: number, up: Vector3, start: Ray) {
    this.#grip = grip;
    this.#plane = { normal: plane.normal.clone(), offset: plane.offset };
    this.#center = center.clone();
    this.#radius = radius;
    this.#up = up.clone();
    this.#start = start.clone();
    // The rim is on the near or the far half of the sphere, whichever was grabbed.
    const near = onSphere(start, center, radius, false);
    const far = onSphere(start, center, radius, true);
    this.#back = Math.abs(far.dot(plane.normal)) < Math.abs(near.dot(plane.normal));
    this.#grabbed = this.#back ? far : near;
  }

  /** The plane for the pointer's newest ray. */
  move(ray: Ray, snap = false): Plane {
    return this.#grip === "arrow" ? this.#slide(ray) : this.#tilt(ray, snap);
  }

  #slide(ray: Ray): Plane {
    const { normal, offset } = this.#plane;
    const sine = new Vector3().crossVectors(this.#start.direction, normal).length();
    let travel: number;
    if (sine >= kMinSine) {
      travel = nearestOnAxis(ray, this.#center, normal) - nearestOnAxis(this.#start, this.#center, normal);
    } else {
      // Looking along the normal: up brings the plane nearer.
      const distance = this.#center.distanceTo(this.#start.origin);
      const moved = ray.direction.clone().sub(this.#start.direction).multiplyScalar(distance);
      travel = -Math.sign(normal.dot(this.#start.direction)) * moved.dot(this.#up);
    }
    return { normal: normal.clone(), offset: offset + travel };
  }

  #tilt(ray: Ray, snap: boolean): Plane {
    const now = onSphere(ray, this.#center, this.#radius, this.#back);
    const turn = new Quaternion().setFromUnitVectors(this.#grabbed, now);
    const normal = this.#plane.normal.clone().applyQuaternion(turn);
    return planeThrough(snap ? snapped(normal) : normal, this.#center);
  }
}

/** The body axis that `normal` nearly points along, or `normal`. */
export function snapped(normal: Vector3): Vector3 {
  for (const axis of [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)]) {
    const cosine = normal.dot(axis);
    if (Math.abs(cosine) > kSnapCosine) {
      return axis.multiplyScalar(Math.sign(cosine));
    }
  }
  return normal;
}
