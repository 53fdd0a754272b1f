import { crc32 } from "../../src/sog/zip";
import type { SogImages, SogMeta, Texels } from "../../src/sog/sog";

/** A ZIP of stored entries, written by the letter of the format. */
export function makeZip(entries: Record<string, Uint8Array>): Uint8Array {
  const parts: Uint8Array[] = [];
  const directory: Uint8Array[] = [];
  let offset = 0;
  for (const [name, data] of Object.entries(entries)) {
    const text = new TextEncoder().encode(name);
    const common = (view: DataView, at: number): void => {
      view.setUint32(at + 10, crc32(data), true);
      view.setUint32(at + 14, data.length, true);
      view.setUint32(at + 18, data.length, true);
      view.setUint16(at + 22, text.length, true);
    };
    const local = new Uint8Array(30 + text.length);
    const localView = new DataView(local.buffer);
    localView.setUint32(0, 0x04034b50, true);
    common(localView, 4);
    local.set(text, 30);
    const central = new Uint8Array(46 + text.length);
    const centralView = new DataView(central.buffer);
    centralView.setUint32(0, 0x02014b50, true);
    common(centralView, 6);
    centralView.setUint32(42, offset, true);
    central.set(text, 46);
    parts.push(local, data);
    directory.push(central);
    offset += local.length + data.length;
  }
  const size = directory.reduce((sum, entry) => sum + entry.length, 0);
  const end = new Uint8Array(22);
  const view = new DataView(end.buffer);
  view.setUint32(0, 0x06054b50, true);
  view.setUint16(8, directory.length, true);
  view.setUint16(10, directory.length, true);
  view.setUint32(12, size, true);
  view.setUint32(16, offset, true);
  return concatenate([...parts, ...directory, end]);
}

function concatenate(parts: Uint8Array[]): Uint8Array {
  const result = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    result.set(part, at);
    at += part.length;
  }
  return result;
}

/** meta.json of a scene of `count` splats with harmonics of degree 1. */
export function makeMeta(count: number): Record<string, unknown> {
  const codebook = (from: number, to: number) =>
    Array.from({ length: 256 }, (_, i) => from + ((to - from) * i) / 255);
  return {
    version: 2,
    count,
    means: { mins: [-0.2, -0.2, -0.2], maxs: [0.2, 0.2, 0.2], files: ["means_l.webp", "means_u.webp"] },
    scales: { codebook: codebook(-7, -4), files: ["scales.webp"] },
    quats: { files: ["quats.webp"] },
    sh0: { codebook: codebook(-2, 2), files: ["sh0.webp"] },
    shN: { count: 3, bands: 1, codebook: codebook(-1, 1), files: ["shN_centroids.webp", "shN_labels.webp"] },
    clipgs_faces: {
      count: 2,
      bands: 1,
      codebook: codebook(-0.5, 0.5),
      files: ["clipgs_faces_centroids.webp", "clipgs_faces_labels.webp"],
    },
    clipgs: { states: { count: 200, first: -0.2, spacing: 0.002, keeps: "below", file: "layers.webp" } },
  };
}

export function makeArchive(meta: unknown): Map<string, Uint8Array> {
  const names = ["means_l", "means_u", "scales", "quats", "sh0", "shN_centroids", "shN_labels"];
  names.push("clipgs_faces_centroids", "clipgs_faces_labels", "layers");
  const archive = new Map(names.map((name) => [`${name}.webp`, new Uint8Array(4)]));
  archive.set("meta.json", new TextEncoder().encode(typeof meta === "string" ? meta : JSON.stringify(meta)));
  return archive;
}

/** Repeatable numbers in [0, 1) (mulberry32). */
export function makeRandom(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

function texels(width: number, height: number, value: () => number): Texels {
  return { width, height, rgba: Uint8Array.from({ length: width * height * 4 }, value) };
}

/** Random images that are valid for `makeMeta`. */
export function makeImages(meta: SogMeta, seed = 1): SogImages {
  const random = makeRandom(seed);
  const width = 4 * Math.ceil(Math.sqrt(meta.count) / 4);
  const height = 4 * Math.ceil(meta.count / (4 * width));
  const byte = () => Math.floor(256 * random());
  const quats = texels(width, height, byte);
  for (let i = 0; i < width * height; ++i) {
    quats.rgba[4 * i + 3] = 252 + Math.floor(4 * random());
  }
  const labels = (entries: number) => {
    const image = texels(width, height, () => 0);
    for (let i = 0; i < width * height; ++i) {
      image.rgba[4 * i] = Math.floor(entries * random());
    }
    return image;
  };
  return {
    meansLow: texels(width, height, byte),
    meansHigh: texels(width, height, byte),
    scales: texels(width, height, byte),
    quats,
    sh0: texels(width, height, byte),
    shN: { centroids: texels(192, 1, byte), labels: labels(3) },
    faces: { centroids: texels(256, 1, byte), labels: labels(2) },
    layers: meta.layers && labels(meta.layers.count),
  };
}
