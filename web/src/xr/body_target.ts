import { type Intersection, type Matrix4, Object3D, Ray, type Raycaster, type Sphere, Vector3 } from "three";

import { planesOf } from "../model/cut";
import type { Plane } from "../model/geometry";
import type { OpenCase } from "../render/open_case";
import type { Viewer } from "../viewer";

/** What is kept lies on the positive side of all of these, RAS mm. */
type Bounds = readonly Plane[];

/** The planes around a case's body: those of its hull, as they stand in the patient. */
export function hullPlanes({ mesh, info }: OpenCase): Bounds {
  const { directions, low, high } = mesh.hull;
  const scale = info.mmPerUnit;
  const origin = new Vector3().setFromMatrixPosition(info.sceneToPatient);
  return Array.from(low, (_, k) => {
    const normal = new Vector3().fromArray(directions, 3 * k).transformDirection(info.sceneToPatient);
    const at = normal.dot(origin);
    return [
      { normal, offset: at + scale * low[k]! },
      { normal: normal.clone().negate(), offset: -at - scale * high[k]! },
    ];
  }).flat();
}

/** Where a ray enters what planes bound, and through which; null: it passes by, or begins in it. */
export function entry(bounds: Bounds, { origin, direction }: Ray): { t: number; plane: Plane } | null {
  let from = 0;
  let to = Infinity;
  let through: Plane | null = null;
  for (const plane of bounds) {
    const rate = plane.normal.dot(direction);
    const ahead = plane.offset - plane.normal.dot(origin);
    if (Math.abs(rate) < 1e-9) {
      if (ahead > 0) {
        return null;
      }
    } else if (rate > 0 && ahead / rate > from) {
      from = ahead / rate;
      through = plane;
    } else if (rate < 0) {
      to = Math.min(to, ahead / rate);
    }
  }
  return through && from <= to ? { t: from, plane: through } : null;
}

/** How far a point is from what planes bound, at least; the plane that it is farthest beyond. */
export function outside(bounds: Bounds, point: Vector3): { distance: number; plane: Plane | null } {
  let distance = 0;
  let beyond: Plane | null = null;
  for (const plane of bounds) {
    const away = plane.offset - plane.normal.dot(point);
    if (away > distance) {
      distance = away;
      beyond = plane;
    }
  }
  return { distance, plane: beyond };
}

/** What is left of the case's body, as hands meet it: not what is cut away, nor the corners of a box around it. */
export class BodyTarget extends Object3D {
  readonly #viewer: Viewer;
  readonly #roomFromPatient: Matrix4;
  readonly #patientFromRoom: Matrix4;
  #hull: Bounds = [];
  readonly #ray = new Ray(); // scratch
  readonly #point = new Vector3();

  /** The matrices are those of the last frame, each the other's inverse. */
  constructor(viewer: Viewer, roomFromPatient: Matrix4, patientFromRoom: Matrix4) {
    super();
    this.#viewer = viewer;
    this.#roomFromPatient = roomFromPatient;
    this.#patientFromRoom = patientFromRoom;
  }

  setCase(shown: OpenCase | null): void {
    this.#hull = shown ? hullPlanes(shown) : [];
  }

  override raycast({ ray }: Raycaster, intersects: Intersection[]): void {
    if (this.#hull.length === 0) {
      return;
    }
    const inPatient = this.#ray.copy(ray).applyMatrix4(this.#patientFromRoom);
    const met = entry(this.#bounds, inPatient);
    if (met) {
      const point = inPatient.at(met.t, new Vector3()).applyMatrix4(this.#roomFromPatient);
      const normal = met.plane.normal.clone().negate().transformDirection(this.#roomFromPatient);
      intersects.push({ object: this, point, distance: point.distanceTo(ray.origin), normal });
    }
  }

  /** As pointers from near ask for it. */
  override spherecast({ center, radius }: Sphere, intersects: Intersection[]): void {
    if (this.#hull.length === 0) {
      return;
    }
    const inPatient = this.#point.copy(center).applyMatrix4(this.#patientFromRoom);
    const { distance, plane } = outside(this.#bounds, inPatient);
    const scale = this.#roomFromPatient.getMaxScaleOnAxis();
    if (distance * scale <= radius) {
      const point = plane ? inPatient.addScaledVector(plane.normal, distance) : inPatient;
      intersects.push({
        object: this,
        point: point.clone().applyMatrix4(this.#roomFromPatient),
        distance: distance * scale,
      });
    }
  }

  get #bounds(): Bounds {
    return [...this.#hull, ...planesOf(this.#viewer.state.cuts)];
  }
}
