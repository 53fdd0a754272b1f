import type { Vector3 } from "three";

import type { Plane } from "./geometry";

/** What is moved as one: a plane, or the slab from there to `thickness` mm further on the kept side. */
export interface Cut extends Plane {
  thickness: number | null;
}

/** The cut of a normal of any length but 0; `offset` is scaled with it, the thickness is mm. */
export function makeCut(normal: Vector3, offset: number, thickness: number | null): Cut {
  const length = normal.length();
  return { normal: normal.clone().divideScalar(length), offset: offset / length, thickness };
}

/** Of all cuts together (Cut::kMostPlanes of src/core/cut.h). */
export const kMaxPlanes = 6;

/** Whether two planes keep what is between them, or nothing. */
export function areOpposite(a: Plane, b: Plane): boolean {
  return a.normal.dot(b.normal) < -1 + 1e-6;
}

/** The planes of cuts, of which all together keep what is kept; opposite ones follow each other. */
export function planesOf(cuts: readonly Cut[]): Plane[] {
  const left: Plane[] = cuts.flatMap(({ normal, offset, thickness }) => [
    { normal, offset },
    ...(thickness === null ? [] : [{ normal: normal.clone().negate(), offset: -offset - thickness }]),
  ]);
  const planes: Plane[] = [];
  for (let plane = left.shift(); plane; plane = left.shift()) {
    planes.push(plane);
    const other = left.findIndex((one) => areOpposite(plane, one));
    planes.push(...(other >= 0 ? left.splice(other, 1) : []));
  }
  return planes;
}

/** Whether cuts have no more planes than can be drawn. */
export function canDraw(cuts: readonly Cut[]): boolean {
  return planesOf(cuts).length <= kMaxPlanes;
}
