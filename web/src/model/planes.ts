import { Vector3 } from "three";

import { texts } from "../text/text";
import { type Box, type Plane, projectBox } from "./geometry";
import { decimal, directionLetters } from "./values";

export const kOrientations = ["axial", "coronal", "sagittal"] as const;
export type Orientation = (typeof kOrientations)[number];

export const kAxes: Readonly<Record<Orientation, Vector3>> = {
  axial: new Vector3(0, 0, 1),
  coronal: new Vector3(0, 1, 0),
  sagittal: new Vector3(1, 0, 0),
};

/**
 * The plane across `axis` through the middle of `bounds` that removes what lies towards `viewer`
 * (unit vector, RAS), so that the cut is seen.
 */
export function planeAcross(axis: Vector3, bounds: Box, viewer: Vector3): Plane {
  const normal = axis.clone().multiplyScalar(viewer.dot(axis) >= 0 ? -1 : 1);
  const [min, max] = projectBox(bounds, normal);
  return { normal, offset: 0.5 * (min + max) };
}

/** The body axis that is farthest from the normals of `planes`, the first of those that are as far. */
export function freeAxis(planes: readonly Plane[]): Vector3 {
  const nearest = (axis: Vector3) => Math.max(...planes.map(({ normal }) => Math.abs(normal.dot(axis))), 0);
  return kOrientations
    .map((name) => kAxes[name])
    .reduce((best, axis) => (nearest(axis) < nearest(best) - 1e-6 ? axis : best));
}

/** Which body plane this is parallel to, if any. */
export function orientationOf(plane: Plane): Orientation | null {
  return kOrientations.find((name) => Math.abs(plane.normal.dot(kAxes[name])) > 0.99999) ?? null;
}

/** The side that a plane removes, in words: "superior" for one that keeps what lies below. */
function removedSide(plane: Plane): string {
  const n = plane.normal;
  const sizes = n.toArray().map(Math.abs);
  const axis = sizes.indexOf(Math.max(...sizes));
  const { sides } = texts();
  const names = [
    [sides.right, sides.left],
    [sides.anterior, sides.posterior],
    [sides.superior, sides.inferior],
  ][axis]!;
  return n.getComponent(axis) < 0 ? names[0]! : names[1]!;
}

/**
 * Where a plane is in the patient, along the letters that its normal leads to, so that a point that it goes through has
 * the same coordinate: "S 12.3 mm" of an axial one, "RA −4.0 mm" of one that is turned between R and A.
 */
export function planePosition({ normal, offset }: Plane, digits = 1): string {
  const parts = normal.toArray();
  const largest = parts.reduce((best, part) => (Math.abs(part) > Math.abs(best) ? part : best));
  const sign = largest < 0 ? -1 : 1;
  const letters = directionLetters(normal.clone().multiplyScalar(sign));
  return `${letters} ${decimal(sign * offset, digits)} mm`;
}

/** "Axial, superior removed" */
export function planeText(plane: Plane): string {
  const orientation = orientationOf(plane);
  const t = texts();
  return t.plane.removed(orientation ? t.orientations[orientation] : t.plane.oblique, removedSide(plane));
}
