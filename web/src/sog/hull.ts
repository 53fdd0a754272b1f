import type { PackedScene } from "./sog";

/** Pairs of planes around a hull: Hull::kDirections of src/splat/hull.h. */
export const kHullDirections = 32;

/** Of opacity 255, less than a tenth: faint splats are not part of the body. */
const kFaint = 26;

/** A convex body between two planes across each of a few directions, scene space: the twin of src/splat/hull.h. */
export interface Hull {
  directions: Float32Array; // [kHullDirections, 3], unit
  low: Float32Array;
  high: Float32Array;
}

/** The axes, and a half of directions spread over the sphere. */
function patientDirections(): number[][] {
  const spread = 2 * (kHullDirections - 3);
  return Array.from({ length: kHullDirections }, (_, k) => {
    if (k < 3) {
      return [0, 1, 2].map((axis) => (axis === k ? 1 : 0));
    }
    const z = 1 - (2 * (k - 3) + 1) / spread;
    const r = Math.sqrt(Math.max(0, 1 - z * z));
    const phi = Math.PI * (3 - Math.sqrt(5)) * (k - 3);
    return [r * Math.cos(phi), r * Math.sin(phi), z];
  });
}

/** Around the means of a scene's splats, and their largest deviation farther. `patientFromScene`: rows of a similarity. */
export function hullOf(scene: PackedScene, patientFromScene: readonly (readonly number[])[]): Hull {
  const directions = new Float32Array(3 * kHullDirections);
  patientDirections().forEach((d, k) => {
    const along = [0, 1, 2].map((c) => d.reduce((sum, v, row) => sum + v * patientFromScene[row]![c]!, 0));
    const length = Math.hypot(...along);
    along.forEach((v, c) => (directions[3 * k + c] = v / length));
  });
  const low = new Float32Array(kHullDirections).fill(Infinity);
  const high = new Float32Array(kHullDirections).fill(-Infinity);
  const { count, packed, meanMin, meanMax, scaleCodebook } = scene;
  const mean = (code: number, axis: number): number => {
    const v = meanMin[axis]! + (code / 65535) * (meanMax[axis]! - meanMin[axis]!);
    return Math.sign(v) * Math.expm1(Math.abs(v));
  };
  for (let i = 0; i < 4 * count; i += 4) {
    if (packed[i + 3]! >>> 24 < kFaint) {
      continue;
    }
    const x = mean(packed[i]! & 0xffff, 0);
    const y = mean(packed[i]! >>> 16, 1);
    const z = mean(packed[i + 1]! & 0xffff, 2);
    const scales = packed[i + 3]!;
    const reach = Math.max(
      scaleCodebook[scales & 255]!,
      scaleCodebook[(scales >>> 8) & 255]!,
      scaleCodebook[(scales >>> 16) & 255]!,
    );
    for (let k = 0; k < kHullDirections; ++k) {
      const t = x * directions[3 * k]! + y * directions[3 * k + 1]! + z * directions[3 * k + 2]!;
      low[k] = Math.min(low[k]!, t - reach);
      high[k] = Math.max(high[k]!, t + reach);
    }
  }
  return { directions, low, high };
}
