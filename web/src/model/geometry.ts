import { Matrix4, Vector3 } from "three";

// Patient space is RAS: x to the patient's Right, y Anterior, z Superior, in millimetres.

export type Triple = [number, number, number];

/** A clipping plane: keeps dot(normal, x) >= offset. Unit normal; offset in mm. */
export interface Plane {
  normal: Vector3;
  offset: number;
}

export interface Sphere {
  center: Vector3;
  radius: number;
}

export interface Box {
  min: Vector3;
  max: Vector3;
}

export function signedDistance(plane: Plane, point: Vector3): number {
  return plane.normal.dot(point) - plane.offset;
}

/** The same plane keeping the other side. */
export function flipped(plane: Plane): Plane {
  return { normal: plane.normal.clone().negate(), offset: -plane.offset };
}

/** The point of the plane nearest to `point`. */
export function projectOnto(plane: Plane, point: Vector3): Vector3 {
  return point.clone().addScaledVector(plane.normal, -signedDistance(plane, point));
}

/** The plane with normal `normal` through `point`. */
export function planeThrough(normal: Vector3, point: Vector3): Plane {
  const unit = normal.clone().normalize();
  return { normal: unit, offset: unit.dot(point) };
}

/** Two unit vectors in a plane, right-handed with its normal. */
export function axesIn(normal: Vector3): [Vector3, Vector3] {
  const aside = Math.abs(normal.z) < 0.9 ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0);
  const u = new Vector3().crossVectors(aside, normal).normalize();
  return [u, new Vector3().crossVectors(normal, u)];
}

/** Interval of dot(normal, x) over a box: where a plane cuts something. */
export function projectBox(box: Box, normal: Vector3): [number, number] {
  let min = 0;
  let max = 0;
  for (const axis of ["x", "y", "z"] as const) {
    const a = normal[axis] * box.min[axis];
    const b = normal[axis] * box.max[axis];
    min += Math.min(a, b);
    max += Math.max(a, b);
  }
  return [min, max];
}

/** RAS mm → the viewer's world: metres, y up, the patient upright and facing +z. */
export const kWorldFromPatient = new Matrix4().set(
  -0.001,
  0,
  0,
  0,
  0,
  0,
  0.001,
  0,
  0,
  0.001,
  0,
  0,
  0,
  0,
  0,
  1,
);
