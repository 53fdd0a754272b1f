import { Vector3 } from "three";

import type { Section } from "../sog/section";
import { axesIn } from "./geometry";
import type { MarkShape } from "./marks";
import { readSection } from "./values";

/** Of the values within a region of a face. */
export interface RegionValues {
  mean: number;
  deviation: number; // standard, of the samples
  least: number;
  most: number;
  samples: number;
  modality: Section["modality"];
}

/** Samples within a region, about: fewer where it has few voxels. */
const kMostSamples = 20_000;
const kLeastSamples = 400;

/** A point of a region's plane. */
type Flat = readonly [u: number, v: number];

/** A region in its own plane, mm from its first point. */
interface FlatRegion {
  /** RAS. */
  origin: Vector3;
  u: Vector3;
  v: Vector3;
  corners: readonly Flat[]; // of an outline; of a circle, of the square around it
  radius: number | null; // of a circle
}

function flatten({ kind, points, normal }: MarkShape): FlatRegion {
  const origin = points[0]!;
  const [u, v] = axesIn(normal!);
  if (kind === "region") {
    const radius = origin.distanceTo(points[1]!);
    const corners: Flat[] = [
      [-radius, -radius],
      [radius, -radius],
      [radius, radius],
      [-radius, radius],
    ];
    return { origin, u, v, corners, radius };
  }
  const corners = points.map((point): Flat => {
    const from = point.clone().sub(origin);
    return [from.dot(u), from.dot(v)];
  });
  return { origin, u, v, corners, radius: null };
}

/** mm². Of an outline that crosses itself, what goes around clockwise counts less. */
export function regionArea(region: MarkShape): number {
  const { corners, radius } = flatten(region);
  if (radius !== null) {
    return Math.PI * radius * radius;
  }
  let twice = 0;
  corners.forEach(([x, y], i) => {
    const [nextX, nextY] = corners[(i + 1) % corners.length]!;
    twice += x * nextY - nextX * y;
  });
  return Math.abs(twice) / 2;
}

function isInside({ corners, radius }: FlatRegion, x: number, y: number): boolean {
  if (radius !== null) {
    return x * x + y * y <= radius * radius;
  }
  let inside = false;
  corners.forEach(([ax, ay], i) => {
    const [bx, by] = corners[(i + 1) % corners.length]!;
    if (ay > y !== by > y && x < ax + ((y - ay) * (bx - ax)) / (by - ay)) {
      inside = !inside;
    }
  });
  return inside;
}

/**
 * What the volume has within a region: samples half a voxel apart, closer in small ones, interpolated between voxels.
 * What lies outside the body does not count. Null where nothing does.
 */
export function regionValues(region: MarkShape, section: Section): RegionValues | null {
  const flat = flatten(region);
  const { origin, u, v, corners } = flat;
  const [low, high] = [Math.min, Math.max].map((most) =>
    [0, 1].map((k) => most(...corners.map((corner) => corner[k]!))),
  ) as [number[], number[]];
  const area = (high[0]! - low[0]!) * (high[1]! - low[1]!);
  const step = Math.max(
    Math.min(0.5 * Math.min(...section.spacing), Math.sqrt(area / kLeastSamples)),
    Math.sqrt(area / kMostSamples),
  );
  if (!(step > 0)) {
    return null;
  }
  let [samples, sum, squares, least, most] = [0, 0, 0, Infinity, -Infinity];
  let first: number | null = null; // values are summed from here: less is lost to rounding
  const at = new Vector3();
  for (let y = low[1]! + 0.5 * step; y < high[1]!; y += step) {
    for (let x = low[0]! + 0.5 * step; x < high[0]!; x += step) {
      const reading = isInside(flat, x, y)
        ? readSection(section, at.copy(origin).addScaledVector(u, x).addScaledVector(v, y))
        : null;
      if (reading) {
        const { value } = reading;
        first ??= value;
        ++samples;
        sum += value - first;
        squares += (value - first) ** 2;
        least = Math.min(least, value);
        most = Math.max(most, value);
      }
    }
  }
  if (first === null) {
    return null;
  }
  const offset = sum / samples;
  const variance = Math.max(0, squares / samples - offset * offset);
  return {
    mean: first + offset,
    deviation: Math.sqrt(variance),
    least,
    most,
    samples,
    modality: section.modality,
  };
}
