import { CaseError } from "../sog/zip";
import { type PlyElement, readPlyElements } from "./ply_header";
import { makeCloud, requireCount, type SplatCloud } from "./splat_cloud";

/** Coefficients above degree 0 that splats may have, by their properties for three channels. */
const kCoefficients = new Map([
  [0, 0],
  [9, 3],
  [24, 8],
  [45, 15],
]);
const kLargestSh = 4;
/** Of SuperSplat's compressed PLY: splats that share ranges, and the reach of its SH bytes. */
const kChunk = 256;
const kCompressedReach = 4;
const kShC0 = 0.28209479177387814;

/** The splats of a PLY file: as 3DGS trainers write them, or compressed by SuperSplat. Throws CaseError. */
export function readPly(bytes: Uint8Array): SplatCloud {
  const elements = readPlyElements(bytes);
  const vertex = elements.get("vertex");
  if (!vertex || vertex.count === 0) {
    throw new CaseError("has no splats: it has no points");
  }
  requireCount(vertex.count);
  const chunk = elements.get("chunk");
  return chunk && vertex.has("packed_position")
    ? readCompressed(vertex, chunk, elements.get("sh") ?? null)
    : readPlain(vertex);
}

function readPlain(vertex: PlyElement): SplatCloud {
  const { count } = vertex;
  const columns = (names: readonly string[]) => names.map((name) => vertex.column(name));
  const means = columns(["x", "y", "z"]);
  const scales = columns(["scale_0", "scale_1", "scale_2"]);
  const rotations = columns(["rot_0", "rot_1", "rot_2", "rot_3"]);
  const opacity = vertex.column("opacity");
  const sh0 = columns(["f_dc_0", "f_dc_1", "f_dc_2"]);
  const sh = columns(shNames(vertex));
  const reach = shReach(sh, count);
  const cloud = makeCloud(count, sh.length / 3, reach);
  for (let i = 0; i < count; ++i) {
    means.forEach((read, c) => (cloud.means[3 * i + c] = read(i)));
    scales.forEach((read, c) => (cloud.logScales[3 * i + c] = read(i)));
    rotations.forEach((read, c) => (cloud.rotations[4 * i + c] = read(i)));
    cloud.opacities[i] = 1 / (1 + Math.exp(-opacity(i)));
    sh0.forEach((read, c) => (cloud.sh0[3 * i + c] = read(i)));
  }
  if (cloud.sh) {
    const { codes, coefficients } = cloud.sh;
    sh.forEach((read, k) => {
      // All of red, then all of green, then all of blue.
      const channel = Math.floor(k / coefficients);
      const at = 3 * (k % coefficients) + channel;
      for (let i = 0; i < count; ++i) {
        codes[3 * coefficients * i + at] = shCode(read(i), reach);
      }
    });
  }
  return cloud;
}

/** The names of SH coefficients above degree 0, as far as their degrees are known. */
function shNames(vertex: PlyElement): string[] {
  let count = 0;
  while (vertex.has(`f_rest_${count}`)) {
    ++count;
  }
  const known = kCoefficients.get(count);
  if (known === undefined) {
    throw new CaseError(
      `has ${count} properties "f_rest_…", which fit no degree of spherical harmonics up to 3`,
    );
  }
  return Array.from({ length: 3 * known }, (_, k) => `f_rest_${k}`);
}

/** How far coefficients go, so that bytes say them as finely as they can. */
function shReach(sh: readonly ((row: number) => number)[], count: number): number {
  let reach = 1e-3;
  for (const read of sh) {
    for (let i = 0; i < count; ++i) {
      const value = Math.abs(read(i));
      reach = value > reach ? value : reach;
    }
  }
  return Math.min(reach, kLargestSh);
}

function shCode(value: number, reach: number): number {
  return Math.round(255 * Math.min(1, Math.max(0, 0.5 + value / (2 * reach)))) || 0;
}

/** The part of `value` that lies in `bits` bits from bit `from` on, 0 … 1. */
function unpack(value: number, from: number, bits: number): number {
  const most = 2 ** bits - 1;
  return ((value >>> from) & most) / most;
}

function readCompressed(vertex: PlyElement, chunk: PlyElement, sh: PlyElement | null): SplatCloud {
  const { count } = vertex;
  if (chunk.count < Math.ceil(count / kChunk) || (sh && sh.count < count)) {
    throw new CaseError("is damaged: it has fewer chunks or harmonics than splats; copy it again");
  }
  const ranges = (names: readonly string[]) =>
    names.map((name) => [chunk.column(`min_${name}`), chunk.column(`max_${name}`)] as const);
  const axes = ["x", "y", "z"];
  const positions = ranges(axes);
  const scales = ranges(axes.map((axis) => `scale_${axis}`));
  const colors = chunk.has("min_r") ? ranges(["r", "g", "b"]) : null;
  const [position, rotation, scale, color] = ["position", "rotation", "scale", "color"].map((name) =>
    vertex.column(`packed_${name}`),
  ) as [Read, Read, Read, Read];
  const harmonics = sh ? shNames(sh).map((name) => sh.column(name)) : [];
  const coefficients = harmonics.length / 3;
  const cloud = makeCloud(count, coefficients, kCompressedReach);
  const kThird = [21, 11, 0] as const; // 11, 10 and 11 bits
  const kBits = [11, 10, 11] as const;
  for (let i = 0; i < count; ++i) {
    const row = Math.floor(i / kChunk);
    const within = ([least, most]: readonly [Read, Read], t: number): number =>
      least(row) + t * (most(row) - least(row));
    const [packedPosition, packedScale, packedColor] = [position(i), scale(i), color(i)];
    for (let c = 0; c < 3; ++c) {
      cloud.means[3 * i + c] = within(positions[c]!, unpack(packedPosition, kThird[c]!, kBits[c]!));
      cloud.logScales[3 * i + c] = within(scales[c]!, unpack(packedScale, kThird[c]!, kBits[c]!));
      const share = unpack(packedColor, 24 - 8 * c, 8);
      cloud.sh0[3 * i + c] = ((colors ? within(colors[c]!, share) : share) - 0.5) / kShC0;
    }
    cloud.opacities[i] = unpack(packedColor, 0, 8);
    cloud.rotations.set(compressedRotation(rotation(i)), 4 * i);
    harmonics.forEach((read, k) => {
      cloud.sh!.codes[3 * (coefficients * i + (k % coefficients)) + Math.floor(k / coefficients)] = read(i);
    });
  }
  return cloud;
}

type Read = (row: number) => number;

/** The largest component, whose number stands in the first two bits, is that which the others leave. */
function compressedRotation(packed: number): number[] {
  const others = [20, 10, 0].map((from) => (unpack(packed, from, 10) - 0.5) * Math.SQRT2);
  const largest = Math.sqrt(Math.max(0, 1 - others.reduce((sum, v) => sum + v * v, 0)));
  others.splice(packed >>> 30, 0, largest);
  return others;
}
