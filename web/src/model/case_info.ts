import { Matrix4, Vector3 } from "three";

import { CaseError } from "../sog/zip";
import type { Box, Sphere } from "./geometry";

/** What the `clipgs` block of a case says (docs/format.md), checked. */
export interface CaseInfo {
  /** Scene space → RAS mm: a rotation, a uniform scale and a translation. */
  sceneToPatient: Matrix4;
  mmPerUnit: number;
  axis: Vector3;
  extent: [number, number];
  sphere: Sphere;
  bounds: Box;
  title: string;
  preset: string;
}

function fail(key: string): never {
  throw new CaseError(`meta.json: clipgs.${key} is missing or out of range; build the case again`);
}

function member(value: unknown, key: string): unknown {
  let result = value;
  for (const part of key.split(".")) {
    if (typeof result !== "object" || result === null || !(part in result)) {
      fail(key);
    }
    result = (result as Record<string, unknown>)[part];
  }
  return result;
}

function numbers(value: unknown, key: string, length: number): number[] {
  const list = (member(value, key) as unknown[]).valueOf();
  if (!Array.isArray(list) || list.length !== length || !list.every((v) => Number.isFinite(v))) {
    fail(key);
  }
  return list as number[];
}

function vector(value: unknown, key: string): Vector3 {
  return new Vector3().fromArray(numbers(value, key, 3));
}

function text(value: unknown, key: string): string {
  const result = member(value, key);
  return typeof result === "string" ? result : fail(key);
}

/** Rows of a 4×4 similarity with determinant > 0. */
function similarity(value: unknown, key: string): Matrix4 {
  const rows = member(value, key);
  const flat = Array.isArray(rows) ? rows.flat() : [];
  if (flat.length !== 16 || !flat.every((v) => Number.isFinite(v))) {
    fail(key);
  }
  const matrix = new Matrix4().fromArray(flat as number[]).transpose();
  const axes = [new Vector3(), new Vector3(), new Vector3()] as const;
  matrix.extractBasis(...axes);
  const scale = axes[0].length();
  const tolerance = 1e-4 * scale;
  const even = axes.every((a) => Math.abs(a.length() - scale) < tolerance);
  const upright =
    Math.abs(axes[0].dot(axes[1])) + Math.abs(axes[1].dot(axes[2])) + Math.abs(axes[2].dot(axes[0]));
  if (!(scale > 0) || !even || upright > tolerance * scale || matrix.determinant() <= 0) {
    fail(key);
  }
  return matrix;
}

/** Throws CaseError. */
export function parseCaseInfo(block: unknown): CaseInfo {
  if (block === undefined) {
    throw new CaseError(
      "this SOG has no clipgs block, which says how it lies in the patient; make it with clipgs pack",
    );
  }
  if (member(block, "version") !== 1) {
    throw new CaseError("the case is of a version that this viewer does not know; use a newer clipgs");
  }
  const sceneToPatient = similarity(block, "world.scene_to_ras_mm");
  const [radius] = numbers({ radius: [member(block, "sphere.radius")] }, "radius", 1);
  const extent = numbers(block, "extent", 2) as [number, number];
  if (!(radius! > 0)) {
    fail("sphere.radius");
  }
  return {
    sceneToPatient,
    mmPerUnit: new Vector3().setFromMatrixColumn(sceneToPatient, 0).length(),
    axis: vector(block, "axis").normalize(),
    extent,
    sphere: { center: vector(block, "sphere.center"), radius: radius! },
    bounds: { min: vector(block, "bounds.min"), max: vector(block, "bounds.max") },
    title: text(block, "title"),
    preset: text(block, "preset"),
  };
}
