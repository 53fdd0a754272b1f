import {
  BufferAttribute,
  BufferGeometry,
  CustomBlending,
  type Data3DTexture,
  DoubleSide,
  FrontSide,
  GLSL3,
  LessDepth,
  type Matrix4,
  Mesh,
  NoBlending,
  OneFactor,
  RawShaderMaterial,
  type WebGLRenderer,
} from "three";

import { facePolygons, indexFromPatient, planSteps, sectionEnds, surfaceDepth } from "../model/faces";
import { faceDiffuse } from "../model/face_light";
import { kWorldFromPatient, type Plane } from "../model/geometry";
import {
  type Detail,
  type FaceEffort,
  type GreyOpenings,
  kGreyOpenings,
  kWallSteps,
} from "../model/face_style";
import type { Window } from "../model/grey";
import type { LightRig, Section } from "../sog/section";
import type { OpeningsInfo, WallLight } from "../worker/protocol";
import { kBehindSplats } from "./draw_order";
import type { DepthCue } from "./depth_cue";
import {
  blockTexture,
  type FaceUniforms,
  faceUniforms,
  kColumns,
  outlineUniformsOf,
  rigUniform,
  surfaceUniformsOf,
  valueBytes,
  volumeTexture,
  writeShades,
} from "./section_uniforms";
import { shader } from "./shaders";
import { uploadInPieces } from "./upload";

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

/** A texture of light, and what 1 in it stands for. */
interface WallTexture {
  light: Data3DTexture | null;
  scale: number;
}
const kNoLight: WallTexture = { light: null, scale: 0 };

type FaceMesh = Mesh<BufferGeometry, RawShaderMaterial>;

/** Faces where no splat is seen behind them, or those elsewhere. */
function faceMesh(uniforms: FaceUniforms, opaque: boolean, { channels, tone }: Section): FaceMesh {
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
  const inverse = uniforms.uPatientFromWorld.value;
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
  readonly #uniforms: FaceUniforms;
  readonly indexFromPatient: Matrix4;
  /** mm, that optical depths of materials are told by. */
  readonly firstStep: number;
  /** What its outline is drawn by, and whether it can be. */
  readonly outlineUniforms: ReturnType<typeof outlineUniformsOf>;
  /** What its surface is drawn by. */
  readonly surfaceUniforms: ReturnType<typeof surfaceUniformsOf>;
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
    this.firstStep = planSteps(section)[0]!.length;
    this.indexFromPatient = indexFromPatient(section);
    this.#hasValues = section.channels === 3;
    this.#uniforms = faceUniforms(section, cue, this.firstStep);
    this.surfaceUniforms = surfaceUniformsOf(this.#uniforms, section);
    this.outlineUniforms = outlineUniformsOf(this.#uniforms);
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
    if (!(await this.#give(renderer, this.#uniforms.uVoxels.value, section.channels, (codes) => codes))) {
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
    const values = this.outlineUniforms.uValues.value;
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
    const { uBlocks } = this.#uniforms;
    uBlocks.value.dispose();
    uBlocks.value = blockTexture(space);
    this.#isOutlined = space.outlined;
  }

  /** From now on, too, walls behind gaps are drawn: in no more than a glow until there is light of a cut. */
  setOpenings({ cells, cellSize }: WallLight): void {
    const { uOpenings } = this.#uniforms;
    this.#hasOpenings = true;
    uOpenings.value.cell = cellSize;
    uOpenings.value.cells.set(...cells);
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
    this.#uniforms.uLight.value = light;
    this.#uniforms.uOpenings.value.lightScale = scale;
  }

  /** Of a cut: until there is light of any, the surface has its own. */
  #lightSurface(cut: boolean): void {
    const { own, shown } = this.#lights;
    const { light, scale } = (cut || this.#rig !== this.section.rig ? shown : null) ?? own ?? kNoLight;
    this.surfaceUniforms.uLight.value = light;
    this.surfaceUniforms.uLightScale.value = scale;
  }

  /** Lights the faces otherwise from the next setPlanes() on. */
  setRig(rig: LightRig): void {
    this.#rig = rig;
    this.#uniforms.uRig.value = rigUniform(rig);
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
    this.#uniforms.uRays.value = rays;
    this.#uniforms.uOpenings.value.steps = kWallSteps[walls];
  }

  /**
   * Shows the faces that planes (RAS mm) expose, and those where the volume ends in matter. Their edges are smooth
   * where a pixel is no more than `margin` mm and has several rays. `alone`, without the body, the volume's ends are
   * none, and one face is seen from behind, too; several would lie over each other.
   */
  setPlanes(planes: readonly Plane[], margin: number, alone = false): void {
    planes.forEach(({ normal, offset }, i) =>
      this.#uniforms.uPlanes.value[i]!.set(normal.x, normal.y, normal.z, offset),
    );
    this.#uniforms.uPlaneCount.value = planes.length;
    this.#lightSurface(planes.length > 0);
    this.#uniforms.uOpened.value = this.#hasOpenings && planes.length > 0 && !alone;
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
    this.#uniforms.uGrey.value = grey;
    this.#uniforms.uGreyOpenings.value = kGreyOpenings.indexOf(openings);
    if (!window || (window.center === this.#window?.center && window.width === this.#window.width)) {
      return;
    }
    this.#window = { ...window };
    writeShades(this.#uniforms.uMaterials.value, window, this.section.curve);
  }

  /** Frees what the GPU holds. */
  free(): void {
    this.#freed = true;
    const { uVoxels, uValues, uCurve, uMaterials, uBlocks } = this.#uniforms;
    for (const { value } of [uVoxels, uValues, uCurve, uMaterials, uBlocks]) {
      value.dispose();
    }
    for (const mesh of this.#meshes) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
  }

  get #meshes(): FaceMesh[] {
    return [this.opaque, this.partial];
  }
}
