import { kMaxSplats } from "../sog/sog";
import { CaseError } from "../sog/zip";

/** Splats as 3DGS trainers write them, in the axes of their files: x right, y down, z forward. */
export interface SplatCloud {
  count: number;
  means: Float32Array; // [count, 3]
  logScales: Float32Array; // [count, 3], of standard deviations
  rotations: Float32Array; // [count, 4], w x y z, of any length
  opacities: Float32Array; // [count], 0 … 1
  sh0: Float32Array; // [count, 3], coefficients of degree 0
  /** Of the degrees above: [count, coefficients, 3], each the value (code/255 − ½)·2·reach; null: there are none. */
  sh: { coefficients: number; codes: Uint8Array; reach: number } | null;
}

/** Throws CaseError unless a file may hold that many. */
export function requireCount(count: number): void {
  if (!Number.isInteger(count) || count < 1) {
    throw new CaseError("has no splats");
  }
  if (count > kMaxSplats) {
    throw new CaseError(
      `has ${count} splats, and the viewer shows ${kMaxSplats} at most; thin it out, as in SuperSplat`,
    );
  }
}

/** Room for splats; `coefficients`: of SH above degree 0. */
export function makeCloud(count: number, coefficients: number, reach: number): SplatCloud {
  return {
    count,
    means: new Float32Array(3 * count),
    logScales: new Float32Array(3 * count),
    rotations: new Float32Array(4 * count),
    opacities: new Float32Array(count),
    sh0: new Float32Array(3 * count),
    sh: coefficients > 0 ? { coefficients, codes: new Uint8Array(3 * coefficients * count), reach } : null,
  };
}
