import type { PackedScene } from "../sog/sog";
import { CaseError } from "../sog/zip";
import { makePalette } from "./palette";
import type { SplatCloud } from "./splat_cloud";

const kCodes = 256;
/** Values beyond these parts of them, from below and above, are those at their ends. */
const kOutliers = 1e-4;
const kSampled = 1 << 16;
const kFarthest = 1e6; // of a mean, so that its logarithm stays fine enough
const kLeastOpacity = 0.5 / 255;

/** Values between the ends of almost all of them, as bytes. */
class ByteCodes {
  readonly codebook: Float32Array;
  readonly #least: number;
  readonly #step: number;

  constructor(values: Float32Array, splats: readonly number[]) {
    const stride = Math.max(1, Math.floor((3 * splats.length) / kSampled));
    const sample: number[] = [];
    for (let k = 0; k < 3 * splats.length; k += stride) {
      sample.push(values[3 * splats[Math.floor(k / 3)]! + (k % 3)]!);
    }
    const sorted = Float32Array.from(sample).sort();
    const at = (part: number): number => sorted[Math.round(part * (sorted.length - 1))]!;
    this.#least = at(kOutliers);
    this.#step = Math.max(1e-6, (at(1 - kOutliers) - this.#least) / (kCodes - 1));
    this.codebook = Float32Array.from({ length: kCodes }, (_, code) => this.#least + code * this.#step);
  }

  code(value: number): number {
    return Math.min(kCodes - 1, Math.max(0, Math.round((value - this.#least) / this.#step)));
  }
}

function logarithm(v: number): number {
  return Math.sign(v) * Math.log1p(Math.abs(v));
}

/** Numbers of the splats that can be seen and whose values are numbers. */
function soundSplats({ count, means, logScales, rotations, opacities, sh0 }: SplatCloud): number[] {
  const isSound = (values: Float32Array, size: number, i: number, most: number): boolean => {
    for (let k = size * i; k < size * (i + 1); ++k) {
      if (!(Math.abs(values[k]!) <= most)) {
        return false;
      }
    }
    return true;
  };
  const sound: number[] = [];
  for (let i = 0; i < count; ++i) {
    if (
      opacities[i]! >= kLeastOpacity &&
      isSound(means, 3, i, kFarthest) &&
      isSound(logScales, 3, i, 50) &&
      isSound(rotations, 4, i, 1e10) &&
      isSound(sh0, 3, i, 1e3)
    ) {
      sound.push(i);
    }
  }
  return sound;
}

/** Three bytes, and which component is left out: the largest, which is positive. */
function rotationCode(rotations: Float32Array, i: number): number {
  const q = [...rotations.subarray(4 * i, 4 * i + 4)];
  const length = Math.hypot(...q);
  const unit = length > 0 ? q.map((v) => v / length) : [1, 0, 0, 0];
  const largest = unit.reduce((best, v, k) => (Math.abs(v) > Math.abs(unit[best]!) ? k : best), 0);
  const sign = unit[largest]! < 0 ? -1 : 1;
  const [a, b, c] = unit
    .filter((_, k) => k !== largest)
    .map((v) => Math.min(255, Math.max(0, Math.round(255 * ((sign * v) / Math.SQRT2 + 0.5))))) as [
    number,
    number,
    number,
  ];
  return (a | (b << 8) | (c << 16) | (largest << 24)) >>> 0;
}

/** Splats as the viewer draws them (PackedScene), without those that cannot be seen. Throws CaseError. */
export function packCloud(cloud: SplatCloud): PackedScene {
  const splats = soundSplats(cloud);
  const count = splats.length;
  if (count === 0) {
    throw new CaseError("has no splats that could be seen");
  }
  const meanMin = [Infinity, Infinity, Infinity];
  const meanMax = [-Infinity, -Infinity, -Infinity];
  for (const i of splats) {
    for (let c = 0; c < 3; ++c) {
      const v = logarithm(cloud.means[3 * i + c]!);
      meanMin[c] = Math.min(meanMin[c]!, v);
      meanMax[c] = Math.max(meanMax[c]!, v);
    }
  }
  const meanCode = (i: number, c: number): number => {
    const size = meanMax[c]! - meanMin[c]!;
    return size > 0 ? Math.round((65535 * (logarithm(cloud.means[3 * i + c]!) - meanMin[c]!)) / size) : 0;
  };
  const scales = new ByteCodes(cloud.logScales, splats);
  const colors = new ByteCodes(cloud.sh0, splats);
  const shN = cloud.sh && packSh(cloud.sh, splats);
  const packed = new Uint32Array(4 * count);
  const sh0 = new Uint8Array(4 * count);
  splats.forEach((i, k) => {
    const scale = (c: number): number => scales.code(cloud.logScales[3 * i + c]!);
    const opacity = Math.round(255 * Math.min(1, cloud.opacities[i]!));
    packed[4 * k] = (meanCode(i, 0) | (meanCode(i, 1) << 16)) >>> 0;
    packed[4 * k + 1] = (meanCode(i, 2) | ((shN?.labels[k] ?? 0) << 16)) >>> 0;
    packed[4 * k + 2] = rotationCode(cloud.rotations, i);
    packed[4 * k + 3] = (scale(0) | (scale(1) << 8) | (scale(2) << 16) | (opacity << 24)) >>> 0;
    sh0.set(
      [0, 1, 2].map((c) => colors.code(cloud.sh0[3 * i + c]!)),
      4 * k,
    );
    sh0[4 * k + 3] = 255;
  });
  return {
    count,
    packed,
    sh0,
    meanMin,
    meanMax,
    scaleCodebook: scales.codebook.map(Math.exp),
    sh0Codebook: colors.codebook,
    shN: shN && { coefficients: shN.coefficients, codebook: shN.codebook, centroids: shN.centroids },
    faces: null,
    layers: null,
  };
}

function packSh({ coefficients, codes, reach }: NonNullable<SplatCloud["sh"]>, splats: readonly number[]) {
  const dims = 3 * coefficients;
  const kept = new Uint8Array(dims * splats.length);
  splats.forEach((i, k) => kept.set(codes.subarray(dims * i, dims * (i + 1)), dims * k));
  const codebook = Float32Array.from({ length: kCodes }, (_, code) => 2 * reach * (code / 255 - 0.5));
  return { coefficients, codebook, ...makePalette(kept, dims) };
}
