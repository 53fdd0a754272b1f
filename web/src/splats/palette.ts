import { kPaletteRow } from "../sog/sog";

/** Of labels of 16 bits. */
const kMostEntries = 65536;
const kSampled = 512; // for the spread of a set

/** A palette of `codes` [count, dims], the image of its entries, and the entry of each. */
export interface CodePalette {
  labels: Uint16Array;
  centroids: { width: number; height: number; rgba: Uint8Array };
}

/**
 * Splats with like harmonics share an entry: all are halved again and again at the median of what differs most among
 * them, and a set that is not halved any more has their mean. `dims` is of three channels.
 */
export function makePalette(codes: Uint8Array, dims: number): CodePalette {
  const count = codes.length / dims;
  const members = Uint32Array.from({ length: count }, (_, i) => i);
  const labels = new Uint16Array(count);
  const means: number[][] = [];
  const divide = (begin: number, end: number, entries: number): void => {
    const dim = entries > 1 && end - begin > 1 ? widest(codes, dims, members, begin, end) : -1;
    if (dim < 0) {
      members.subarray(begin, end).forEach((i) => (labels[i] = means.length));
      means.push(meanOf(codes, dims, members, begin, end));
      return;
    }
    const middle = halve(codes, dims, members, begin, end, dim);
    const first = Math.round((entries * (middle - begin)) / (end - begin));
    const least = Math.min(entries - 1, Math.max(1, first));
    divide(begin, middle, least);
    divide(middle, end, entries - least);
  };
  divide(0, count, Math.min(count, kMostEntries));
  return { labels, centroids: imageOf(means, dims) };
}

/** The dimension in which a set's codes differ most; −1: they are all alike. */
function widest(codes: Uint8Array, dims: number, members: Uint32Array, begin: number, end: number): number {
  const step = Math.max(1, Math.floor((end - begin) / kSampled));
  let best = -1;
  let most = 0;
  for (let dim = 0; dim < dims; ++dim) {
    let [n, sum, squares] = [0, 0, 0];
    for (let k = begin; k < end; k += step) {
      const code = codes[members[k]! * dims + dim]!;
      ++n;
      sum += code;
      squares += code * code;
    }
    const variance = squares / n - (sum / n) ** 2;
    if (variance > most + 1e-6) {
      most = variance;
      best = dim;
    }
  }
  return best;
}

/** Puts those with the smaller codes first; returns where the others begin: neither half is empty. */
function halve(
  codes: Uint8Array,
  dims: number,
  members: Uint32Array,
  begin: number,
  end: number,
  dim: number,
): number {
  const counts = new Uint32Array(256);
  for (let k = begin; k < end; ++k) {
    ++counts[codes[members[k]! * dims + dim]!]!;
  }
  // The code up to which those before it are nearest to one half, and some are left.
  let [before, split, best] = [0, 0, Infinity];
  for (let code = 0; code < 255; ++code) {
    before += counts[code]!;
    const off = Math.abs(2 * before - (end - begin));
    if (before > 0 && before < end - begin && off < best) {
      best = off;
      split = code;
    }
  }
  let low = begin;
  for (let k = begin; k < end; ++k) {
    const i = members[k]!;
    if (codes[i * dims + dim]! <= split) {
      members[k] = members[low]!;
      members[low++] = i;
    }
  }
  return low;
}

function meanOf(codes: Uint8Array, dims: number, members: Uint32Array, begin: number, end: number): number[] {
  return Array.from({ length: dims }, (_, dim) => {
    let sum = 0;
    for (let k = begin; k < end; ++k) {
      sum += codes[members[k]! * dims + dim]!;
    }
    return Math.round(sum / (end - begin));
  });
}

/** As SOG has it: kPaletteRow entries a row, each a texel a coefficient. */
function imageOf(means: readonly number[][], dims: number): CodePalette["centroids"] {
  const coefficients = dims / 3;
  const width = kPaletteRow * coefficients;
  const height = Math.ceil(means.length / kPaletteRow);
  const rgba = new Uint8Array(4 * width * height);
  means.forEach((mean, entry) => {
    for (let j = 0; j < coefficients; ++j) {
      rgba.set(mean.slice(3 * j, 3 * j + 3), 4 * (entry * coefficients + j));
    }
  });
  return { width, height, rgba };
}
