import {
  BufferAttribute,
  BufferGeometry,
  CustomBlending,
  Data3DTexture,
  DataTexture,
  DataUtils,
  DoubleSide,
  FrontSide,
  GLSL3,
  FloatType,
  HalfFloatType,
  type IUniform,
  LessDepth,
  LinearFilter,
  Matrix3,
  Matrix4,
  Mesh,
  NearestFilter,
  NoBlending,
  OneFactor,
  RawShaderMaterial,
  RedFormat,
  RGBAFormat,
  RGBFormat,
  UnsignedByteType,
  Vector2,
  Vector3,
  Vector4,
  type WebGLRenderer,
} from "three";

import { type Detail, type FaceEffort, kWallSteps } from "../model/face_style";
import { facePolygons, indexFromPatient, planSteps, sectionEnds, surfaceDepth } from "../model/faces";
import { kMaxPlanes } from "../model/cut";
import { faceDiffuse } from "../model/face_light";
import { kWorldFromPatient, type Plane } from "../model/geometry";
import { type GreyOpenings, kGreyOpenings } from "../model/face_style";
import { shades, type Window } from "../model/grey";
import { between, codeOfValue } from "../model/values";
import { kCodes, kMaxKeys, type LightRig, type Section } from "../sog/section";
import type { OpeningsInfo, WallLight } from "../worker/protocol";
import { kBehindSplats } from "./draw_order";
import type { DepthCue } from "./depth_cue";
import { shader } from "./shaders";
import { uploadInPieces } from "./upload";

const kTableRows = 4;
const kGlossRow = 2;
const kShade = 2; // channel of that row
const kMostShade = 1000; // as good as infinite, where half floats are still fine

/** Columns of the table of materials, evenly over the values of the curve; as face.glsl is told. */
export const kColumns = 2048;

/** At least as many bytes as this go to the GPU at once: more would stop the page for too long. */
const kUploadBytes = 4e6;

/** Whether the GPU's memory has not been enough since this was asked last. */
function wasOutOfMemory(gl: WebGLRenderingContext | WebGL2RenderingContext): boolean {
  const errors = new Set<number>();
  for (let error = gl.getError(); error !== gl.NO_ERROR; error = gl.getError()) {
    errors.add(error);
  }
  return errors.has(gl.OUT_OF_MEMORY);
}

function volumeTexture(
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
function valueBytes(curve: readonly number[]): Uint8Array {
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

function rigUniform(rig: LightRig): object {
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
function blockTexture({
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

/** A texture of light, and what 1 in it stands for. */
interface WallTexture {
  light: Data3DTexture | null;
  scale: number;
}
const kNoLight: WallTexture = { light: null, scale: 0 };

type FaceMesh = Mesh<BufferGeometry, RawShaderMaterial>;

/** Faces where no splat is seen behind them, or those elsewhere. */
function faceMesh(
  uniforms: Record<string, IUniform>,
  opaque: boolean,
  { channels, tone }: Section,
): FaceMesh {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: shader("face.vert.glsl"),
    fragmentShader: shader("face.frag.glsl"),
    uniforms,
    defines: { kOpaque: opaque ? 1 : 0, kChannels: channels, kFilmic: tone === "filmic" ? 1 : 0, kColumns },
    depthWrite: opaque,
    depthFunc: LessDepth,
    transparent: !opaque,
    forceSinglePass: true,
    blending: opaque ? NoBlending : CustomBlending,
    blendSrc: OneFactor,
    blendDst: OneFactor,
  });
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.renderOrder = kBehindSplats;
  mesh.frustumCulled = false;
  mesh.matrixAutoUpdate = false;
  mesh.matrix.copy(kWorldFromPatient);
  const inverse = uniforms["uPatientFromWorld"]!.value as Matrix4;
  mesh.onBeforeRender = () => inverse.copy(mesh.matrixWorld).invert();
  return mesh;
}

/**
 * The faces that planes expose and those where the volume ends, drawn from a section's volume. Seen from the removed
 * side a face lies in front of all that is kept, and no two of them overlap: where one is opaque it is drawn with the
 * splats, before them, so that those behind it cost nothing; elsewhere into a picture of its own, to be put before
 * that of the splats.
 */
export class SectionFaces {
  /** What is opaque and what is not, in the viewer's world. */
  readonly opaque: FaceMesh;
  readonly partial: FaceMesh;
  readonly section: Section;
  readonly #uniforms: Record<string, IUniform>;
  readonly indexFromPatient: Matrix4;
  /** mm, that optical depths of materials are told by. */
  readonly firstStep: number;
  /** What its outline is drawn by, and whether it can be. */
  readonly outlineUniforms: Record<string, IUniform>;
  /** What its surface is drawn by. */
  readonly surfaceUniforms: Record<string, IUniform>;
  /** Of its volumes, on the GPU. */
  bytes: number;
  /** How closely outline and surface are looked at. */
  fine = true;
  /** What is drawn of it beside the faces, where that can be. */
  detail: Detail = "surface";
  /** Side of a pixel of the surface, in pixels of the picture. */
  surfacePixel = 1;
  /** The sides of the volume that are faces. */
  readonly ends: readonly Plane[];
  #window: Window | null = null; // that the table holds
  #freed = false;
  #hasOpenings = false;
  #isOutlined = false;
  #hasValues: boolean;
  #rig: LightRig;
  #lights: { own: WallTexture | null; shown: WallTexture | null } = { own: null, shown: null };

  constructor(section: Section, cue: DepthCue) {
    this.section = section;
    this.#rig = section.rig;
    this.bytes = section.voxels.length;
    const steps = planSteps(section);
    const first = steps[0]!.length;
    this.firstStep = first;
    this.indexFromPatient = indexFromPatient(section);
    this.#hasValues = section.channels === 3; // of colours no table is needed
    const glossy = Math.max(...section.materials.specular) > 0;
    this.#uniforms = {
      uPatientFromWorld: { value: new Matrix4() },
      uIndexFromPatient: { value: this.indexFromPatient },
      uVoxels: { value: volumeTexture(section.voxels, section) },
      uCurve: { value: curveTexture(section.curve) },
      uMaterials: { value: materialTexture(section, first) },
      uSteps: { value: steps.map(({ middle, length }) => new Vector2(middle, length / first)) },
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
      uLight: { value: null },
      uCue: { value: cue.faces },
      uBackdrop: { value: cue.backdrop },
      uOpenings: {
        value: {
          steps: kWallSteps.fine,
          voxel: 2 * surfaceDepth(section),
          firstStep: first,
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
    const {
      uVoxels,
      uBlocks,
      uMaterials,
      uPlanes,
      uPlaneCount,
      uGrey,
      uOpenings,
      uRig,
      uExposure,
      uCue,
      uBackdrop,
    } = this.#uniforms as Record<
      | "uVoxels"
      | "uBlocks"
      | "uMaterials"
      | "uPlanes"
      | "uPlaneCount"
      | "uGrey"
      | "uOpenings"
      | "uRig"
      | "uExposure"
      | "uCue"
      | "uBackdrop",
      IUniform
    >;
    const uValues = this.#hasValues ? uVoxels : { value: volumeTexture(null, { ...section, channels: 1 }) };
    this.#uniforms["uValues"] = uValues;
    this.surfaceUniforms = {
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
      uLight: { value: null },
      uLightScale: { value: 0 },
      uSurfaceDepth: { value: surfaceDepth(section) },
    };
    this.outlineUniforms = {
      uValues,
      uBlocks,
      uMaterials,
      uPlanes,
      uPlaneCount,
      uGrey,
    };
    this.opaque = faceMesh(this.#uniforms, true, section);
    this.partial = faceMesh(this.#uniforms, false, section);
    this.ends = sectionEnds(section);
  }

  /**
   * Gives the volume to the GPU, piece by piece, so that the page can do other things in between. Returns whether there
   * is memory for it. Without memory for its values there is no outline.
   */
  async upload(renderer: WebGLRenderer): Promise<boolean> {
    const { section } = this;
    if (!(await this.#give(renderer, this.#uniforms["uVoxels"]!.value, section.channels, (codes) => codes))) {
      return false;
    }
    await this.giveValues(renderer);
    return true;
  }

  /** Gives the GPU, which may be a new one, the values that the outline is drawn by, if there is memory for them. */
  async giveValues(renderer: WebGLRenderer): Promise<void> {
    const { curve, channels, voxels } = this.section;
    if (channels === 3) {
      return;
    }
    const bytes = valueBytes(curve);
    const values = this.outlineUniforms["uValues"]!.value as Data3DTexture;
    this.#hasValues = false;
    if (await this.#give(renderer, values, 1, (codes) => codes.map((code) => bytes[code]!))) {
      this.#hasValues = true;
    } else {
      values.dispose();
    }
    this.bytes = voxels.length * (this.#hasValues ? 2 : 1);
  }

  /** Whether the outline of what is kept can be drawn: it is known where there is nothing. */
  get hasOutline(): boolean {
    return this.#isOutlined && this.#hasValues;
  }

  /** From now on it is known where the volume is empty. */
  setSpace(space: OpeningsInfo): void {
    const uBlocks = this.#uniforms["uBlocks"]!;
    (uBlocks.value as Data3DTexture).dispose();
    uBlocks.value = blockTexture(space);
    this.#isOutlined = space.outlined;
  }

  /** From now on, too, walls behind gaps are drawn: in no more than a glow until there is light of a cut. */
  setOpenings({ cells, cellSize }: WallLight): void {
    const { uOpenings } = this.#uniforms;
    this.#hasOpenings = true;
    uOpenings!.value.cell = cellSize;
    uOpenings!.value.cells.set(...cells);
  }

  /**
   * Whether the surface of what is kept can be drawn: how it is lit is known. Of photographs, brightness does not tell
   * which way a surface faces.
   */
  get hasSurface(): boolean {
    return this.#lights.own !== null && this.section.channels === 1;
  }

  /** Lights the surface by a texture, in which 1 stands for `scale`, linear, while it is uncut under its own lights. */
  setOwnLight(light: Data3DTexture, scale: number): void {
    this.#lights.own = { light, scale };
  }

  /** Lights walls, and the surface otherwise, by a texture from now on. */
  setLight(light: Data3DTexture, scale: number): void {
    this.#lights.shown = { light, scale };
    this.#uniforms["uLight"]!.value = light;
    this.#uniforms["uOpenings"]!.value.lightScale = scale;
  }

  /** Of a cut: until there is light of any, the surface has its own. */
  #lightSurface(cut: boolean): void {
    const { own, shown } = this.#lights;
    const { light, scale } = (cut || this.#rig !== this.section.rig ? shown : null) ?? own ?? kNoLight;
    this.surfaceUniforms["uLight"]!.value = light;
    this.surfaceUniforms["uLightScale"]!.value = scale;
  }

  /** Lights the faces otherwise from the next setPlanes() on. */
  setRig(rig: LightRig): void {
    this.#rig = rig;
    this.#uniforms["uRig"]!.value = rigUniform(rig);
  }

  /** Gives the GPU what `meaning` makes of the voxels. Returns whether there is memory for it. */
  async #give(
    renderer: WebGLRenderer,
    texture: Data3DTexture,
    channels: Section["channels"],
    meaning: (codes: Uint8Array) => Uint8Array,
  ): Promise<boolean> {
    const { dims, voxels } = this.section;
    const gl = renderer.getContext();
    wasOutOfMemory(gl); // before this, for something else
    const sliceBytes = dims[0] * dims[1] * channels;
    const piece = (z: number, depth: number) =>
      volumeTexture(
        meaning(voxels.subarray(z * sliceBytes, (z + depth) * sliceBytes)),
        { dims, channels },
        depth,
      );
    const slices = Math.ceil(kUploadBytes / sliceBytes);
    const lost = await uploadInPieces(renderer, texture, piece, slices, () => !this.#freed);
    return this.#freed || lost || !wasOutOfMemory(gl);
  }

  set effort({ rays, fine, walls, detail, surfacePixel }: FaceEffort) {
    this.fine = fine;
    this.detail = detail;
    this.surfacePixel = surfacePixel;
    this.#uniforms["uRays"]!.value = rays;
    this.#uniforms["uOpenings"]!.value.steps = kWallSteps[walls];
  }

  /**
   * Shows the faces that planes (RAS mm) expose, and those where the volume ends in matter. Their edges are smooth
   * where a pixel is no more than `margin` mm and has several rays. `alone`, without the body, the volume's ends are
   * none, and one face is seen from behind, too; several would lie over each other.
   */
  setPlanes(planes: readonly Plane[], margin: number, alone = false): void {
    planes.forEach(({ normal, offset }, i) => this.#uniforms["uPlanes"]!.value[i].set(...normal, offset));
    this.#uniforms["uPlaneCount"]!.value = planes.length;
    this.#lightSurface(planes.length > 0);
    this.#uniforms["uOpened"]!.value = this.#hasOpenings && planes.length > 0 && !alone;
    const all = alone ? planes : [...planes, ...this.ends];
    const corners: number[] = [];
    const outwards: number[] = [];
    const lights: number[] = [];
    facePolygons(this.section, all, margin).forEach((polygon, i) => {
      const outward = all[i]!.normal.clone().negate();
      const light = faceDiffuse(this.#rig, outward).toArray();
      const surface = surfaceDepth(this.section);
      for (let k = 2; k < polygon.length; ++k) {
        for (const corner of [polygon[0]!, polygon[k - 1]!, polygon[k]!]) {
          corners.push(...corner);
          outwards.push(...outward);
          lights.push(...light, surface);
        }
      }
    });
    const geometry = new BufferGeometry();
    const attribute = (values: number[], size: number) => new BufferAttribute(new Float32Array(values), size);
    geometry.setAttribute("position", attribute(corners, 3));
    geometry.setAttribute("outward", attribute(outwards, 3));
    geometry.setAttribute("light", attribute(lights, 4));
    this.opaque.geometry.dispose();
    for (const mesh of this.#meshes) {
      mesh.geometry = geometry;
      mesh.material.side = alone && planes.length === 1 ? DoubleSide : FrontSide;
    }
  }

  /**
   * How faces look: 0 cinematic … 1 grey values through a window (null for photographs, which have colours), and what
   * grey shows in gaps that are black.
   */
  setStyle(grey: number, openings: GreyOpenings, window: Window | null): void {
    this.#uniforms["uGrey"]!.value = grey;
    this.#uniforms["uGreyOpenings"]!.value = kGreyOpenings.indexOf(openings);
    if (!window || (window.center === this.#window?.center && window.width === this.#window.width)) {
      return;
    }
    this.#window = { ...window };
    const table = this.#uniforms["uMaterials"]!.value as DataTexture;
    shades(window, columnValues(this.section.curve)).forEach((shade, column) => {
      const clamped = Math.min(kMostShade, Math.max(-kMostShade, shade));
      table.image.data![4 * (kGlossRow * kColumns + column) + kShade] = DataUtils.toHalfFloat(clamped);
    });
    table.needsUpdate = true;
  }

  /** Frees what the GPU holds. */
  free(): void {
    this.#freed = true;
    for (const name of ["uVoxels", "uCurve", "uMaterials", "uBlocks"]) {
      this.#uniforms[name]!.value.dispose();
    }
    this.outlineUniforms["uValues"]!.value.dispose();
    for (const mesh of this.#meshes) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }

  get #meshes(): FaceMesh[] {
    return [this.opaque, this.partial];
  }
}
