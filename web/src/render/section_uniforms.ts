import {
  Data3DTexture,
  DataTexture,
  DataUtils,
  FloatType,
  HalfFloatType,
  LinearFilter,
  Matrix3,
  Matrix4,
  NearestFilter,
  RedFormat,
  RGBAFormat,
  RGBFormat,
  UnsignedByteType,
  Vector2,
  Vector3,
  Vector4,
} from "three";

import { kMaxPlanes } from "../model/cut";
import { kWallSteps } from "../model/face_style";
import { indexFromPatient, planSteps, surfaceDepth } from "../model/faces";
import { shades, type Window } from "../model/grey";
import { between, codeOfValue } from "../model/values";
import { kCodes, kMaxKeys, type LightRig, type Section } from "../sog/section";
import type { OpeningsInfo } from "../worker/protocol";
import type { DepthCue } from "./depth_cue";

const kTableRows = 4;
const kGlossRow = 2;
const kShade = 2; // channel of that row
const kMostShade = 1000; // as good as infinite, where half floats are still fine

/** Columns of the table of materials, evenly over the values of the curve; as face.glsl is told. */
export const kColumns = 2048;

export function volumeTexture(
  data: Uint8Array | null,
  { dims, channels }: Pick<Section, "dims" | "channels">,
  depth = dims[2],
): Data3DTexture {
  const [width, height] = dims;
  const texture = new Data3DTexture(data as BufferSource as Uint8Array<ArrayBuffer>, width, height, depth);
  texture.format = channels === 3 ? RGBFormat : RedFormat;
  texture.internalFormat = channels === 3 ? "RGB8" : "R8";
  texture.type = UnsignedByteType;
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

/** Values of the codes as bytes: codes bend, and what is interpolated of them ends elsewhere than matter. */
export function valueBytes(curve: readonly number[]): Uint8Array {
  const low = curve[0]!;
  const range = curve[kCodes - 1]! - low;
  return Uint8Array.from(curve, (value) => Math.round((255 * (value - low)) / range));
}

/** Values of the codes from 0 to 1. */
function curveTexture(curve: readonly number[]): DataTexture {
  const low = curve[0]!;
  const range = curve[kCodes - 1]! - low;
  const values = Float32Array.from(curve, (value) => (value - low) / range);
  const texture = new DataTexture(values, kCodes, 1, RedFormat, FloatType);
  texture.needsUpdate = true;
  return texture;
}

/** Values of the columns of the table of materials. */
function columnValues(curve: readonly number[]): number[] {
  const low = curve[0]!;
  const step = (curve[kCodes - 1]! - low) / (kColumns - 1);
  return Array.from({ length: kColumns }, (_, i) => low + step * i);
}

/**
 * The materials as half floats, which every device can filter, in the rows of shaders/face.glsl. Extinction is told
 * by the optical depth of the first step, at most ½, so that any fits.
 */
function materialTexture({ materials, boundary, curve }: Section, firstStep: number): DataTexture {
  const depth = materials.extinction.map((e) => e * firstStep);
  const ofValues = columnValues(curve).map((value) => codeOfValue(curve, value));
  const rows: [codes: number[], tables: number[][]][] = [
    [ofValues, [...materials.surface, depth]],
    [ofValues, [...materials.interior, depth]],
    [ofValues, [materials.specular, materials.roughness]],
    [ofValues, boundary?.reflectance ?? []],
  ];
  const data = new Uint16Array(kTableRows * kColumns * 4);
  rows.forEach(([codes, tables], row) =>
    tables.forEach((table, c) =>
      codes.forEach((code, column) => {
        data[4 * (row * kColumns + column) + c] = DataUtils.toHalfFloat(between(table, code));
      }),
    ),
  );
  const texture = new DataTexture(data, kColumns, kTableRows, RGBAFormat, HalfFloatType);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

function steepUniform({ boundary, curve }: Section): Vector2 {
  const range = curve[kCodes - 1]! - curve[0]!;
  return boundary
    ? new Vector2(boundary.from / range, range / (boundary.to - boundary.from))
    : new Vector2(0, 0);
}

export function rigUniform(rig: LightRig) {
  return {
    skyTop: new Vector3(...rig.skyTop),
    skyHorizon: new Vector3(...rig.skyHorizon),
    skyBottom: new Vector3(...rig.skyBottom),
    keyCount: rig.keys.length,
    keys: Array.from({ length: kMaxKeys }, (_, i) => {
      const key = rig.keys[i];
      return {
        direction: new Vector3(...(key?.direction ?? [0, 0, 1])),
        radiance: new Vector3(...(key?.radiance ?? [0, 0, 0])),
        spread: 0.5 * (key?.angularRadius ?? 0),
      };
    }),
  };
}

/** A volume of one channel that nothing is interpolated of. */
export function blockTexture({
  blocks,
  blockDims: [x, y, z],
}: Pick<OpeningsInfo, "blocks" | "blockDims">): Data3DTexture {
  const texture = new Data3DTexture(blocks as BufferSource as Uint8Array<ArrayBuffer>, x, y, z);
  texture.format = RedFormat;
  texture.internalFormat = "R8";
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

/** Light of openings that nothing is known of yet: a third of what comes from the sky, less than most are lit by. */
function glow({ rig }: Section): Vector3 {
  const sky = new Vector3(...rig.skyHorizon).add(new Vector3(...rig.skyTop));
  return sky.divideScalar(6);
}

/** The rows of a matrix whose columns these are. */
function transposed([x, y, z]: Section["axes"]): [
  number,
  number,
  number,
  number,
  number,
  number,
  number,
  number,
  number,
] {
  return [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]];
}

/** Uniforms of face.frag.glsl, by a section whose first step into matter is `firstStep` mm. */
export function faceUniforms(section: Section, cue: DepthCue, firstStep: number) {
  const steps = planSteps(section);
  const glossy = Math.max(...section.materials.specular) > 0;
  const uVoxels = { value: volumeTexture(section.voxels, section) };
  const ofColors = section.channels === 3; // no table is needed
  return {
    uPatientFromWorld: { value: new Matrix4() },
    uIndexFromPatient: { value: indexFromPatient(section) },
    uVoxels,
    uValues: ofColors ? uVoxels : { value: volumeTexture(null, { ...section, channels: 1 }) },
    uCurve: { value: curveTexture(section.curve) },
    uMaterials: { value: materialTexture(section, firstStep) },
    uSteps: { value: steps.map(({ middle, length }) => new Vector2(middle, length / firstStep)) },
    uPlanes: { value: Array.from({ length: kMaxPlanes }, () => new Vector4()) },
    uPlaneCount: { value: 0 },
    uRays: { value: 1 },
    uGrey: { value: 0 },
    uGreyOpenings: { value: 0 },
    uGlossy: { value: glossy },
    uRig: { value: rigUniform(section.rig) },
    uExposure: { value: section.exposure },
    uOpened: { value: false },
    uBlocks: { value: blockTexture({ blocks: new Uint8Array(1), blockDims: [1, 1, 1] }) },
    uLight: { value: null as Data3DTexture | null },
    uCue: { value: cue.faces },
    uBackdrop: { value: cue.backdrop },
    uOpenings: {
      value: {
        steps: kWallSteps.fine,
        voxel: 2 * surfaceDepth(section),
        firstStep,
        steep: steepUniform(section),
        sourceVoxel: new Vector3(...section.sourceSpacing),
        spacing: new Vector3(...section.spacing),
        axes: new Matrix3().set(...transposed(section.axes)),
        cell: 1,
        cells: new Vector3(1, 1, 1),
        lightScale: 0,
        glow: glow(section),
        glossy,
      },
    },
  };
}

export type FaceUniforms = ReturnType<typeof faceUniforms>;

/** Of those, what outlines are drawn by. */
export function outlineUniformsOf(uniforms: FaceUniforms) {
  const { uValues, uBlocks, uMaterials, uPlanes, uPlaneCount, uGrey } = uniforms;
  return { uValues, uBlocks, uMaterials, uPlanes, uPlaneCount, uGrey };
}

/** What the surface is drawn by: it has a light of its own. */
export function surfaceUniformsOf(uniforms: FaceUniforms, section: Section) {
  const { uValues, uBlocks, uMaterials, uPlanes, uPlaneCount, uOpenings, uRig, uExposure, uCue, uBackdrop } =
    uniforms;
  return {
    uValues,
    uBlocks,
    uMaterials,
    uPlanes,
    uPlaneCount,
    uOpenings,
    uRig,
    uExposure,
    uCue,
    uBackdrop,
    uLight: { value: null as Data3DTexture | null },
    uLightScale: { value: 0 },
    uSurfaceDepth: { value: surfaceDepth(section) },
  };
}

/** Writes what grey values are as seen through a window into the table of materials. */
export function writeShades(table: DataTexture, window: Window, curve: readonly number[]): void {
  shades(window, columnValues(curve)).forEach((shade, column) => {
    const clamped = Math.min(kMostShade, Math.max(-kMostShade, shade));
    table.image.data![4 * (kGlossRow * kColumns + column) + kShade] = DataUtils.toHalfFloat(clamped);
  });
  table.needsUpdate = true;
}
