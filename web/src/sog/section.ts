import type { Triple } from "../model/geometry";
import { requireChecksum } from "./checksum";
import { JsonReader } from "./json_reader";
import type { Texels } from "./sog";
import { type Archive, CaseError } from "./zip";

export const kCodes = 256;
/** Air around the body has code 0, everything else codes from this on. */
export const kFirstInside = 16;
export const kMaxKeys = 8;
const kMaxSide = 1024;
const kMaxImage = 16383;
const kBlock = 16;
export const kErrorBands = 16;
/** 2: with a tone curve, 3: as a video, which viewers that know earlier ones alone would miss. */
const kVersions = new Set<unknown>([1, 2, 3]);
/** What is wrong with a section alone: splats can be shown all the same. */
export class SectionError extends CaseError {
  override name = "SectionError";
}

const kMaxExtinction = 1e6;
const kMaxReflectance = 100;

export const kModalities = ["CT", "MR", "photographs", "PET", "ultrasound", "unknown"] as const;
export type Modality = (typeof kModalities)[number];

/** How light is brought into the range of a display before the sRGB curve: not at all, or with a soft shoulder. */
export const kToneCurves = ["srgb", "filmic"] as const;
export type ToneCurve = (typeof kToneCurves)[number];

/** Linear RGB. The sky's colour runs linearly along S; keys are discs of an angular radius (radians). */
export interface LightRig {
  skyTop: Triple;
  skyHorizon: Triple;
  skyBottom: Triple;
  keys: { direction: Triple; radiance: Triple; angularRadius: number }[];
}

/** What faces show of matter, over the codes. Reflectances are linear RGB. */
export interface FaceMaterials {
  extinction: number[]; // 1/mm
  specular: number[];
  roughness: number[];
  surface: [number[], number[], number[]]; // at the face
  interior: [number[], number[], number[]]; // beneath it
}

/** Where values are steep (per mm), walls of cavities look otherwise: as a boundary does from `to` on. */
export interface BoundaryLook {
  from: number;
  to: number;
  reflectance: [number[], number[], number[]]; // linear RGB over the codes
}

/** The `section` block of a case (docs/format.md), checked: plain data, to be passed between threads. */
export interface SectionInfo {
  file: string;
  /** Of the voxels; absent in older cases. */
  checksum: string | undefined;
  dims: Triple;
  channels: 1 | 3;
  /** How slices lie in the image of `file`; null: it is a video of them. */
  mosaic: Mosaic | null;
  origin: Triple; // RAS mm of the first voxel's centre
  spacing: Triple; // mm
  axes: [Triple, Triple, Triple];
  sourceSpacing: Triple; // mm, of the volume that was traced
  modality: Modality;
  curve: number[]; // values of the codes
  /** Rms errors of values where the code is 16k … 16k + 15. */
  valueErrors: number[];
  materials: FaceMaterials;
  /** Null where walls look as faces do. */
  boundary: BoundaryLook | null;
  rig: LightRig;
  exposure: number;
  tone: ToneCurve;
}

/** The volume that faces are drawn from. */
export interface Section extends SectionInfo {
  voxels: Uint8Array; // [nz, ny, nx] codes, or [nz, ny, nx, 3] sRGB
  counts: number[]; // how often each byte is there
}

/** Code of a voxel: of photographs, their luma (Rec. 709). */
export function codeOfVoxel({ dims, channels, voxels }: Section, x: number, y: number, z: number): number {
  const at = (z * dims[1] + y) * dims[0] + x;
  return channels === 1
    ? voxels[at]!
    : 0.2126 * voxels[3 * at]! + 0.7152 * voxels[3 * at + 1]! + 0.0722 * voxels[3 * at + 2]!;
}

/** How slices of constant z lie in the image: row by row, each in a tile of whole blocks. */
export interface Mosaic {
  tileWidth: number;
  tileHeight: number;
  columns: number;
  rows: number;
}

function unit(reader: JsonReader, key: string): Triple {
  const v = reader.vector(key);
  const length = Math.hypot(...v);
  return Math.abs(length - 1) <= 1e-3 ? (v.map((x) => x / length) as Triple) : reader.fail(key);
}

function readAxes(reader: JsonReader): [Triple, Triple, Triple] {
  const [x, y, z] = [unit(reader, "axis_x"), unit(reader, "axis_y"), unit(reader, "axis_z")];
  const determinant =
    z[0] * (x[1] * y[2] - x[2] * y[1]) +
    z[1] * (x[2] * y[0] - x[0] * y[2]) +
    z[2] * (x[0] * y[1] - x[1] * y[0]);
  return Math.abs(determinant - 1) <= 1e-2 ? [x, y, z] : reader.fail("axis_z");
}

function readMosaic(reader: JsonReader, dims: Triple): Mosaic {
  const [tileWidth, tileHeight] = reader.numbers("tile", 2) as [number, number];
  const blocks = (n: number) => Math.ceil(n / kBlock) * kBlock;
  if (tileWidth !== blocks(dims[0]) || tileHeight !== blocks(dims[1])) {
    reader.fail("tile");
  }
  const columns = reader.integer("columns", 1, Math.min(dims[2], Math.floor(kMaxImage / tileWidth)));
  const rows = Math.ceil(dims[2] / columns);
  return rows * tileHeight <= kMaxImage ? { tileWidth, tileHeight, columns, rows } : reader.fail("columns");
}

/** How the voxels are coded; photographs have no video. */
function readCoding(reader: JsonReader, dims: Triple, channels: number): Mosaic | null {
  if (!reader.has("coding")) {
    return readMosaic(reader, dims);
  }
  return reader.text("coding") === "av1" && channels === 1 ? null : reader.fail("coding");
}

function readCurve(reader: JsonReader): number[] {
  const curve = reader.numbers("curve", kCodes);
  return curve.every((v, i) => i === 0 || v > curve[i - 1]!) ? curve : reader.fail("curve");
}

/** A table for each of red, green and blue, whose names end so. */
function readColors(reader: JsonReader, prefix: string): FaceMaterials["surface"] {
  return ["r", "g", "b"].map((c) =>
    reader.numbers(prefix + c, kCodes, 0, kMaxReflectance),
  ) as FaceMaterials["surface"];
}

function readMaterials(reader: JsonReader): FaceMaterials {
  const table = (key: string, most: number) => reader.numbers(key, kCodes, 0, most);
  return {
    extinction: table("extinction", kMaxExtinction),
    specular: table("specular", 1),
    roughness: table("roughness", 1),
    surface: readColors(reader, "surface_"),
    interior: readColors(reader, "interior_"),
  };
}

function readBoundary(reader: JsonReader): BoundaryLook {
  const from = reader.number("from", 0);
  const to = reader.number("to", 0);
  return to > from ? { from, to, reflectance: readColors(reader, "") } : reader.fail("to");
}

function readRig(reader: JsonReader): LightRig {
  return {
    skyTop: reader.vector("sky_top", 0),
    skyHorizon: reader.vector("sky_horizon", 0),
    skyBottom: reader.vector("sky_bottom", 0),
    keys: reader.children("keys", kMaxKeys).map((key) => ({
      direction: unit(key, "direction"),
      radiance: key.vector("radiance", 0),
      angularRadius: key.number("angular_radius", 0, 1.6),
    })),
  };
}

/** Absent in sections that are displayed by the sRGB curve alone. */
function readTone(lights: JsonReader): ToneCurve {
  const name = lights.has("tone") ? lights.text("tone") : "srgb";
  const known = kToneCurves.find((tone) => tone === name);
  if (!known) {
    throw new CaseError(
      `the case is shown by a tone curve "${name}" that this viewer does not know; use a newer clipgs`,
    );
  }
  return known;
}

/** The section that the `clipgs` block of a case names; null where there is none. Throws CaseError. */
export function parseSection(clipgs: unknown, archive: Pick<Archive, "has">): SectionInfo | null {
  const block = (clipgs as { section?: unknown } | null | undefined)?.section;
  if (block === undefined) {
    return null;
  }
  const reader = new JsonReader(block, "clipgs.section");
  if (!kVersions.has(reader.value("version"))) {
    throw new CaseError(
      "the case's section is of a version that this viewer does not know; use a newer clipgs",
    );
  }
  const dims = reader.vector("dims", 1, kMaxSide);
  if (!dims.every(Number.isInteger)) {
    reader.fail("dims");
  }
  const channels = reader.integer("channels", 1, 3);
  const modality = reader.text("modality") as Modality;
  const lights = reader.child("lights");
  const file = reader.text("file");
  if (channels === 2) {
    reader.fail("channels");
  }
  if (!archive.has(file)) {
    throw new CaseError(`${file} is missing from the case; build or copy it again`);
  }
  return {
    file,
    checksum: reader.has("checksum") ? reader.text("checksum") : undefined,
    dims,
    channels: channels as 1 | 3,
    mosaic: readCoding(reader, dims, channels),
    origin: reader.vector("origin"),
    spacing: reader.vector("spacing", Number.MIN_VALUE),
    axes: readAxes(reader),
    sourceSpacing: reader.vector("source_spacing", Number.MIN_VALUE),
    modality: kModalities.includes(modality) ? modality : "unknown",
    curve: readCurve(reader),
    valueErrors: reader.numbers("value_errors", kErrorBands, 0),
    materials: readMaterials(reader.child("materials")),
    boundary: reader.has("boundary") ? readBoundary(reader.child("boundary")) : null,
    rig: readRig(lights),
    exposure: lights.number("exposure", Number.MIN_VALUE),
    tone: readTone(lights),
  };
}

/**
 * The voxels of an image whose slices lie as `mosaic` says. Throws CaseError where the image has another size.
 */
export function readMosaicVoxels(
  { dims, channels, file }: SectionInfo,
  mosaic: Mosaic,
  { width, height, rgba }: Texels,
): Uint8Array {
  const [nx, ny, nz] = dims;
  if (width !== mosaic.columns * mosaic.tileWidth || height !== mosaic.rows * mosaic.tileHeight) {
    throw new CaseError(
      `${file} is ${width}×${height}, which does not fit the section; build the case again`,
    );
  }
  const voxels = new Uint8Array(nx * ny * nz * channels);
  for (let z = 0, to = 0; z < nz; ++z) {
    const left = (z % mosaic.columns) * mosaic.tileWidth;
    const top = Math.floor(z / mosaic.columns) * mosaic.tileHeight;
    for (let y = 0; y < ny; ++y) {
      const from = 4 * ((top + y) * width + left);
      for (let at = from; at < from + 4 * nx; at += 4) {
        for (let c = 0; c < channels; ++c) {
          voxels[to++] = rgba[at + c]!;
        }
      }
    }
  }
  return voxels;
}

/** The section of its voxels. Throws CaseError where they are not what was written. */
export function sectionOf(info: SectionInfo, voxels: Uint8Array): Section {
  requireChecksum(info.checksum, voxels, info.file);
  return { ...info, voxels, counts: countCodes(voxels) };
}

/** How often each byte is there. */
export function countCodes(voxels: Uint8Array): number[] {
  const counts = new Array<number>(kCodes).fill(0);
  for (const code of voxels) {
    ++counts[code]!;
  }
  return counts;
}
