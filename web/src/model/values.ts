import { Vector3 } from "three";

import { codeOfVoxel, kCodes, kErrorBands, kFirstInside, type Section } from "../sog/section";
import { indexFromPatient } from "./faces";

// What is said about points of a section: the twin of Section::read and of src/section/annotate.cpp.

/** A value and its rms error at a point (RAS mm). */
export interface Reading {
  point: Vector3;
  value: number;
  error: number;
  modality: Section["modality"]; // of the case that it was read of
}

/** What `meaning` says of the codes around a voxel index, interpolated. */
export function interpolated(section: Section, index: Vector3, meaning: (code: number) => number): number {
  const at = index.toArray().map((v, k) => Math.min(section.dims[k]! - 1, Math.max(0, v)));
  const low = at.map((v, k) => Math.max(0, Math.min(Math.floor(v), section.dims[k]! - 2)));
  let sum = 0;
  for (let corner = 0; corner < 8; ++corner) {
    let weight = 1;
    const [x, y, z] = low.map((l, k) => {
      const upper = (corner >> k) & 1;
      weight *= upper ? at[k]! - l : 1 - (at[k]! - l);
      return Math.min(l + upper, section.dims[k]! - 1);
    });
    sum += weight * meaning(codeOfVoxel(section, x!, y!, z!));
  }
  return sum;
}

/** Of a table over the codes, between which it is linear. */
export function between(table: readonly number[], code: number): number {
  const low = Math.min(Math.floor(code), kCodes - 2);
  return table[low]! + (code - low) * (table[low + 1]! - table[low]!);
}

/** The code, a fraction, that means a value. */
export function codeOfValue(curve: readonly number[], value: number): number {
  const above = curve.findIndex((v) => v > value);
  if (above <= 0) {
    return above === 0 ? 0 : kCodes - 1;
  }
  return above - 1 + (value - curve[above - 1]!) / (curve[above]! - curve[above - 1]!);
}

/** What is at a point; null outside the volume and in the air around the body. */
export function readSection(section: Section, point: Vector3): Reading | null {
  const index = point.clone().applyMatrix4(indexFromPatient(section));
  const kRounding = 1e-3;
  const inside = index.toArray().every((v, k) => v >= -kRounding && v <= section.dims[k]! - 1 + kRounding);
  if (!inside || interpolated(section, index, (code) => code) < kFirstInside) {
    return null;
  }
  const value = interpolated(section, index, (code) => between(section.curve, code));
  const band = Math.floor((codeOfValue(section.curve, value) * kErrorBands) / kCodes);
  const error = section.valueErrors[Math.min(kErrorBands - 1, band)]!;
  return { point: point.clone(), value, error, modality: section.modality };
}

/** With a minus of its own width, and no negative zero. */
export function decimal(value: number, digits: number): string {
  return (Number(value.toFixed(digits)) + 0).toFixed(digits).replace("-", "\u2212");
}

/** After a number: only CT has a unit. */
export function unitOf(modality: Section["modality"]): string {
  return modality === "CT" ? " HU" : "";
}

/** "63 ± 4 HU" */
export function valueText({ value, error, modality }: Reading): string {
  return `${decimal(value, 0)} ± ${decimal(error, error < 0.95 ? 1 : 0)}${unitOf(modality)}`;
}

/** "R 12.3 A −4.0 S 88.1 mm" */
export function pointText(point: Vector3): string {
  return `R ${decimal(point.x, 1)} A ${decimal(point.y, 1)} S ${decimal(point.z, 1)} mm`;
}

/** Where in the patient a direction (RAS) leads, by its main parts, the largest first: "S", "LA". */
export function directionLetters(direction: Vector3): string {
  const kWeak = 0.3;
  const letters = ["RL", "AP", "SI"];
  const parts = direction
    .toArray()
    .map((v, k) => ({ strength: Math.abs(v), letter: letters[k]![v < 0 ? 1 : 0]! }))
    .sort((a, b) => b.strength - a.strength);
  return parts
    .filter(({ strength }, i) => i === 0 || strength > kWeak)
    .map(({ letter }) => letter)
    .join("");
}

/** Length of a scale bar: the longest of 1, 2, 5, 10, … 500 mm that is at most `most`, or else 1. */
export function barLength(most: number): number {
  return [500, 200, 100, 50, 20, 10, 5, 2].find((mm) => mm <= most) ?? 1;
}

/** A word as a sentence begins with it. */
export function capital(word: string): string {
  return word[0]!.toUpperCase() + word.slice(1);
}

/** 95 s as "1:35". */
export function clock(seconds: number): string {
  return `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;
}
