import { JsonReader } from "./json_reader";
import { type Archive, CaseError } from "./zip";

/** Splats that a case may hold: its textures stay within what every WebGL 2 device can make. */
export const kMaxSplats = 4 << 20;
const kCodebookSize = 256;
export const kPaletteRow = 64;
const kShCoefficients = [0, 3, 8, 15] as const;
/** Of face colours: SH of degree 1 in the plane's normal. */
export const kFaceCoefficients = 4;
const kFaceKey = "clipgs_faces";

/** Sets of colours, of which each splat has one. */
interface PaletteMeta {
  entries: number;
  coefficients: number;
  codebook: number[];
  files: string[];
}

/** The layers of splats, each one of `count` states. */
interface LayersMeta {
  count: number;
  file: string;
}

/** What meta.json says, checked: every list has its length, every number is finite, every file is there. */
export interface SogMeta {
  count: number;
  means: { mins: number[]; maxs: number[]; files: string[] };
  scales: { codebook: number[]; files: string[] };
  quats: { files: string[] };
  sh0: { codebook: number[]; files: string[] };
  shN: PaletteMeta | null;
  faces: PaletteMeta | null;
  layers: LayersMeta | null;
  /** The block that clipgs adds, as it stands: see case_info.ts. */
  clipgs: unknown;
}

/** An image of data texels: RGBA bytes, row-major from the top left. */
export interface Texels {
  width: number;
  height: number;
  rgba: Uint8Array;
}

interface PaletteImages {
  centroids: Texels;
  labels: Texels;
}

/** The images of a SOG, decoded. */
export interface SogImages {
  meansLow: Texels;
  meansHigh: Texels;
  scales: Texels;
  quats: Texels;
  sh0: Texels;
  shN: PaletteImages | null;
  faces: PaletteImages | null;
  layers: Texels | null;
}

/**
 * A scene ready for textures and for the WASM module: one RGBA32UI texel of 16 bytes a splat
 * (laid out as in shaders/packed.glsl), SOG's own numbers unchanged.
 */
export interface PackedScene {
  count: number;
  packed: Uint32Array; // [count, 4]
  sh0: Uint8Array; // [count, 4], codebook indices and 255
  meanMin: number[]; // in SOG's logarithmic domain
  meanMax: number[];
  scaleCodebook: Float32Array; // 256 standard deviations, scene units
  sh0Codebook: Float32Array; // 256
  shN: { coefficients: number; codebook: Float32Array; centroids: Texels } | null;
  /** Face colours: a palette entry of every splat, and kFaceCoefficients RGBA texels an entry, kPaletteRow entries a row. */
  faces: { labels: Uint16Array; palette: { width: number; height: number; rgba: Float32Array } } | null;
  /** The state that each splat comes from. */
  layers: Uint16Array | null;
}

type Json = Record<string, unknown>;

function isObject(value: unknown): value is Json {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function object(parent: Json, key: string): Json {
  const value = parent[key];
  if (!isObject(value)) {
    throw new CaseError(`meta.json has no "${key}"; this is not a SOG scene`);
  }
  return value;
}

function numbers(parent: Json, key: string, length: number, where: string): number[] {
  const value = parent[key];
  if (!Array.isArray(value) || value.length !== length || !value.every((v) => Number.isFinite(v))) {
    throw new CaseError(`meta.json: ${where}.${key} is not a list of ${length} numbers`);
  }
  return value as number[];
}

function integer(parent: Json, key: string, min: number, max: number, where: string): number {
  const value = parent[key];
  if (!Number.isInteger(value) || (value as number) < min || (value as number) > max) {
    throw new CaseError(`meta.json: ${where}${key} is not a whole number from ${min} to ${max}`);
  }
  return value as number;
}

function files(parent: Json, length: number, where: string, archive: Pick<Archive, "has">): string[] {
  const value = parent["files"];
  if (!Array.isArray(value) || value.length !== length || !value.every((v) => typeof v === "string")) {
    throw new CaseError(`meta.json: ${where}.files is not a list of ${length} file names`);
  }
  for (const name of value) {
    if (!archive.has(name)) {
      throw new CaseError(`${name} is missing from the case; build or copy it again`);
    }
  }
  return value;
}

function paletteMeta(
  meta: Json,
  key: string,
  bands: [number, number],
  coefficients: (bands: number) => number,
  archive: Pick<Archive, "has">,
): PaletteMeta | null {
  if (meta[key] === undefined) {
    return null;
  }
  const block = object(meta, key);
  return {
    entries: integer(block, "count", 1, 65536, `${key}.`),
    coefficients: coefficients(integer(block, "bands", ...bands, `${key}.`)),
    codebook: numbers(block, "codebook", kCodebookSize, key),
    files: files(block, 2, key, archive),
  };
}

/** Of the `clipgs` block, whose states may have layers. */
function layersMeta(block: unknown, archive: Pick<Archive, "has">): LayersMeta | null {
  if (!isObject(block) || !isObject(block["states"]) || block["states"]["file"] === undefined) {
    return null;
  }
  const states = new JsonReader(block["states"], "clipgs.states");
  const file = states.text("file");
  if (!archive.has(file)) {
    throw new CaseError(`${file} is missing from the case; build or copy it again`);
  }
  return { count: states.integer("count", 1, 65536), file };
}

/** Checks meta.json of an archive. Throws CaseError. */
export function parseSogMeta(archive: Archive): SogMeta {
  const text = archive.get("meta.json");
  if (!text) {
    throw new CaseError("there is no meta.json in the archive; this is not a SOG scene");
  }
  let meta: unknown;
  try {
    meta = JSON.parse(new TextDecoder().decode(text));
  } catch {
    throw new CaseError("meta.json cannot be read as JSON; build the case again");
  }
  if (!isObject(meta)) {
    throw new CaseError("meta.json is not an object; build the case again");
  }
  if (meta["version"] !== 2) {
    throw new CaseError(
      `SOG version ${String(meta["version"])} is not supported; convert the scene to version 2`,
    );
  }
  const means = object(meta, "means");
  const scales = object(meta, "scales");
  const sh0 = object(meta, "sh0");
  const quats = object(meta, "quats");
  return {
    count: integer(meta, "count", 1, kMaxSplats, ""),
    means: {
      mins: numbers(means, "mins", 3, "means"),
      maxs: numbers(means, "maxs", 3, "means"),
      files: files(means, 2, "means", archive),
    },
    scales: {
      codebook: numbers(scales, "codebook", kCodebookSize, "scales"),
      files: files(scales, 1, "scales", archive),
    },
    quats: { files: files(quats, 1, "quats", archive) },
    sh0: { codebook: numbers(sh0, "codebook", kCodebookSize, "sh0"), files: files(sh0, 1, "sh0", archive) },
    shN: paletteMeta(meta, "shN", [1, 3], (bands) => kShCoefficients[bands as 1 | 2 | 3], archive),
    faces: paletteMeta(meta, kFaceKey, [1, 1], () => kFaceCoefficients, archive),
    layers: layersMeta(meta["clipgs"], archive),
    clipgs: meta["clipgs"],
  };
}

/** The images of the splats that meta.json names. */
export function splatFiles({ means, scales, quats, sh0, shN, faces, layers }: SogMeta): string[] {
  const palettes = [...(shN?.files ?? []), ...(faces?.files ?? [])];
  const own = [means, scales, quats, sh0].flatMap(({ files }) => files);
  return [...own, ...palettes, ...(layers ? [layers.file] : [])];
}

function requireTexels(image: Texels, count: number, name: string): void {
  if (image.width * image.height < count || image.rgba.length !== image.width * image.height * 4) {
    throw new CaseError(
      `${name} is ${image.width}×${image.height}, too small for ${count} splats; build the case again`,
    );
  }
}

/** Gathers the images' bytes into one texel a splat. Throws CaseError where an image does not fit. */
export function packScene(meta: SogMeta, images: SogImages): PackedScene {
  const { count } = meta;
  requireTexels(images.meansLow, count, meta.means.files[0]!);
  requireTexels(images.meansHigh, count, meta.means.files[1]!);
  requireTexels(images.scales, count, meta.scales.files[0]!);
  requireTexels(images.quats, count, meta.quats.files[0]!);
  requireTexels(images.sh0, count, meta.sh0.files[0]!);
  const low = images.meansLow.rgba;
  const high = images.meansHigh.rgba;
  const scales = images.scales.rgba;
  const quats = images.quats.rgba;
  const sh0 = images.sh0.rgba;
  const labels = packLabels(count, meta.shN, images.shN);
  const packed = new Uint32Array(count * 4);
  const colors = new Uint8Array(count * 4);
  for (let i = 0, b = 0; i < count; ++i, b += 4) {
    const largest = quats[b + 3]! - 252;
    if (largest < 0) {
      throw new CaseError(`${meta.quats.files[0]!}: splat ${i} has no valid rotation; build the case again`);
    }
    packed[b] = (low[b]! | (high[b]! << 8) | (low[b + 1]! << 16) | (high[b + 1]! << 24)) >>> 0;
    packed[b + 1] = (low[b + 2]! | (high[b + 2]! << 8) | ((labels ? labels[i]! : 0) << 16)) >>> 0;
    packed[b + 2] = (quats[b]! | (quats[b + 1]! << 8) | (quats[b + 2]! << 16) | (largest << 24)) >>> 0;
    packed[b + 3] = (scales[b]! | (scales[b + 1]! << 8) | (scales[b + 2]! << 16) | (sh0[b + 3]! << 24)) >>> 0;
    colors[b] = sh0[b]!;
    colors[b + 1] = sh0[b + 1]!;
    colors[b + 2] = sh0[b + 2]!;
    colors[b + 3] = 255;
  }
  return {
    count,
    packed,
    sh0: colors,
    meanMin: meta.means.mins,
    meanMax: meta.means.maxs,
    scaleCodebook: Float32Array.from(meta.scales.codebook, Math.exp),
    sh0Codebook: Float32Array.from(meta.sh0.codebook),
    shN:
      meta.shN && images.shN
        ? {
            coefficients: meta.shN.coefficients,
            codebook: Float32Array.from(meta.shN.codebook),
            centroids: images.shN.centroids,
          }
        : null,
    faces: packFaces(meta, images),
    layers: packLayers(meta, images),
  };
}

/** Palette entry of every splat, checked to exist; null without a palette. */
function packLabels(
  count: number,
  meta: PaletteMeta | null,
  images: PaletteImages | null,
): Uint16Array | null {
  if (!meta || !images) {
    return null;
  }
  const { centroids, labels } = images;
  requireTexels(labels, count, meta.files[1]!);
  const rows = Math.ceil(meta.entries / kPaletteRow);
  if (centroids.width !== kPaletteRow * meta.coefficients || centroids.height < rows) {
    throw new CaseError(
      `${meta.files[0]!} does not hold ${meta.entries} palette entries; build the case again`,
    );
  }
  const result = new Uint16Array(count);
  for (let i = 0; i < count; ++i) {
    const label = labels.rgba[4 * i]! | (labels.rgba[4 * i + 1]! << 8);
    if (label >= meta.entries) {
      throw new CaseError(`${meta.files[1]!}: splat ${i} names palette entry ${label} of ${meta.entries}`);
    }
    result[i] = label;
  }
  return result;
}

/** The layer of every splat, checked to be a state; null without layers. */
function packLayers({ count, layers: meta }: SogMeta, { layers: image }: SogImages): Uint16Array | null {
  if (!meta || !image) {
    return null;
  }
  requireTexels(image, count, meta.file);
  const result = new Uint16Array(count);
  for (let i = 0; i < count; ++i) {
    const layer = image.rgba[4 * i]! | (image.rgba[4 * i + 1]! << 8);
    if (layer >= meta.count) {
      throw new CaseError(
        `${meta.file}: splat ${i} is of layer ${layer} of ${meta.count}; build the case again`,
      );
    }
    result[i] = layer;
  }
  return result;
}

/** The palette through its codebook: it is looked up while planes move. */
function packFaces(meta: SogMeta, images: SogImages): PackedScene["faces"] {
  const labels = packLabels(meta.count, meta.faces, images.faces);
  if (!labels) {
    return null;
  }
  const { width, height, rgba } = images.faces!.centroids;
  const { codebook } = meta.faces!;
  return { labels, palette: { width, height, rgba: Float32Array.from(rgba, (code) => codebook[code]!) } };
}
