import type { PerspectiveCamera, WebGLRenderer } from "three";

import { type CaseInfo, parseCaseInfo } from "../model/case_info";
import { type Cut, planesOf } from "../model/cut";
import type { FaceEffort } from "../model/face_style";
import { kWorldFromPatient, type Plane } from "../model/geometry";
import { type Window, windowPresets } from "../model/grey";
import { isOwn, type Lighting, lightsOf } from "../model/rigs";
import { type LayerSwitch, switchLayers } from "../model/states";
import type { Style } from "../model/viewer_state";
import { type LightRig, type Section, SectionError } from "../sog/section";
import type { CaseError } from "../sog/zip";
import { texts } from "../text/text";
import type { CaseClient, DecodedSection } from "../worker/case_client";
import { type ClipOperator, kSuperseded, kViewFloats, type LoadedCase } from "../worker/protocol";
import { DepthCue } from "./depth_cue";
import { GpuScene } from "./gpu_scene";
import { OpenedLight } from "./opened_light";
import { writeSortView } from "./scene_camera";
import { SectionFaces } from "./section_faces";
import type { Subject } from "./splat_layer";
import { SplatMesh } from "./splat_mesh";

/** Of faces once nothing moves: as `clipgs render` draws them (FaceOptions::kMostRays of src/section/faces.h). */
export const kAtRest: FaceEffort = { rays: 8, fine: true, walls: "fine", detail: "surface", surfacePixel: 1 };
export const kMoving: FaceEffort = {
  rays: 2,
  fine: false,
  walls: "coarse",
  detail: "surface",
  surfacePixel: 2,
};

/** What splats are sorted for: without those that reach no farther than `leastPixels`. */
export interface SortFrame {
  camera: PerspectiveCamera;
  width: number; // px
  height: number;
  leastPixels: number;
}

/** What culling and sorting said last. */
export interface SortResult {
  count: number; // splats to draw
  milliseconds: number;
}

/** Whether `renderer` has textures that are large enough for a section. */
function hasTextureFor(section: Section, renderer: WebGLRenderer): boolean {
  const gl = renderer.getContext() as WebGL2RenderingContext;
  return Math.max(...section.dims) <= (gl.getParameter(gl.MAX_3D_TEXTURE_SIZE) as number);
}

/** A case that is open: what the GPU holds of it, and the order of its splats. Its section comes later. */
export class OpenCase {
  readonly name: string;
  readonly info: CaseInfo;
  /** How what is far away of it fades. */
  readonly cue: DepthCue;
  readonly mesh: SplatMesh;
  faces: SectionFaces | null = null;
  /** Whether its section is still to come: it is shown whole until then, for behind faces splats are hollow. */
  awaitsSection: boolean;
  /** Why faces are not drawn from a volume; null: they can be, or will. */
  noSection: string | null;
  /** What is wrong with the section that it should have; null: nothing. */
  sectionProblem: string | null = null;
  /** Why it is shown no more, if that is not for another case. */
  refusal: CaseError | null = null;
  /** The windows that its values are usually seen through; none for photographs and without a section. */
  windows: ReadonlyMap<string, Window> = new Map();
  /** Whether its splats have layers, which can be clipped by. */
  readonly hasLayers: boolean;
  /** Whether its file says how it lies in the patient. */
  readonly hasWorld: boolean;
  readonly #client: CaseClient;
  readonly #ticket: number;
  readonly #view = new Float32Array(kViewFloats); // that the worker is told
  #coming: SectionFaces | null = null; // what `faces` will be
  #light: OpenedLight | null = null;
  #lights: { name: string; lights: LightRig | null } = { name: "", lights: null }; // that it is seen in
  #spare: Uint32Array; // an order buffer that neither the GPU nor the worker has

  /** Throws CaseError. */
  constructor(name: string, loaded: LoadedCase, client: CaseClient) {
    this.name = name;
    this.info = parseCaseInfo(loaded.clipgs);
    const { sceneToPatient, mmPerUnit, faceGain } = this.info;
    const scene = new GpuScene(loaded.scene);
    this.cue = new DepthCue(this.info.sphere, sceneToPatient, mmPerUnit);
    this.mesh = new SplatMesh(scene, sceneToPatient, mmPerUnit, faceGain, loaded.hull, this.cue);
    this.mesh.placed = this.info.placed;
    this.mesh.matrix.multiplyMatrices(kWorldFromPatient, sceneToPatient);
    this.mesh.matrixWorld.copy(this.mesh.matrix);
    this.hasLayers = scene.hasLayers;
    this.hasWorld = loaded.hasWorld;
    this.awaitsSection = loaded.hasSection;
    this.noSection = loaded.hasSection ? null : texts().face.noVolume;
    if (loaded.sectionProblem) {
      this.loseSection(loaded.sectionProblem);
    }
    this.#client = client;
    this.#ticket = loaded.ticket;
    this.#spare = new Uint32Array(scene.capacity);
  }

  /** Its section is broken: splats draw the faces, and are hollow behind them. */
  loseSection(problem: string): void {
    this.awaitsSection = false;
    this.sectionProblem = this.noSection = texts().face.hollow(problem);
  }

  /**
   * Fetches the rest of it, and gives it that while it `isShown`; `relit` is called where what cuts open looks otherwise
   * then. What is wrong with its section is said in `sectionProblem`. Resolves with how long that was decoded, ms. Rejects
   * with CaseError where the file is broken, or another case was loaded meanwhile.
   */
  async complete(renderer: WebGLRenderer, isShown: () => boolean, relit: () => void): Promise<number> {
    let decoded: DecodedSection | null;
    try {
      decoded = await this.#client.section(this.#ticket);
    } catch (error) {
      const { message } = error as CaseError;
      if (error instanceof SectionError || message === kSuperseded) {
        this.loseSection(message);
      }
      if (error instanceof SectionError) {
        return 0;
      }
      throw error;
    }
    if (decoded && isShown()) {
      await this.setSection(decoded, renderer, () => isShown() && relit());
    } else {
      decoded?.light.dispose();
    }
    return decoded?.milliseconds ?? 0;
  }

  /**
   * Draws faces from the volume once `renderer` holds it, if it can, and what cuts open a little later; `relit` is called
   * when that changes.
   */
  async setSection(
    { section, light }: Pick<DecodedSection, "section" | "light">,
    renderer: WebGLRenderer,
    relit: () => void,
  ): Promise<void> {
    const faces = hasTextureFor(section, renderer) ? new SectionFaces(section, this.cue) : null;
    this.#coming = faces;
    if (faces && (await faces.upload(renderer))) {
      this.faces = faces;
      this.windows = windowPresets(section);
      this.#light = new OpenedLight(renderer, light, faces, this.mesh, relit);
    } else {
      light.dispose();
      faces?.free();
      this.#coming = null;
      this.noSection = texts().face.cannotHold;
    }
    this.awaitsSection = false;
  }

  /** Culls and sorts, and hands the order to the GPU. One at a time. Null where the worker has another case by now. Rejects with CaseError. */
  async sort(
    { camera, width, height, leastPixels }: SortFrame,
    { cuts, clip }: Style,
  ): Promise<SortResult | null> {
    const { mesh } = this;
    this.#setClip(this.#planes(cuts), clip);
    writeSortView(
      this.#view,
      mesh.sceneCamera(camera, width, height),
      mesh.planes,
      leastPixels,
      mesh.layerSwitch,
    );
    const { count, order, milliseconds } = await this.#client.sort(
      this.#ticket,
      this.#view,
      mesh.clip,
      this.#spare,
    );
    this.#spare = count < 0 ? order : mesh.setOrder(order, count);
    return count < 0 ? null : { count, milliseconds };
  }

  /** Whether it can be seen in other lights than it was made in: null until that is known. */
  get canChangeRig(): boolean | null {
    return this.#light ? this.#light.canChangeRig : this.awaitsSection ? null : false;
  }

  /** Whether the light is that of a style's cuts and lights. */
  isLit(style: Style): boolean {
    return this.#lightBy(style)?.isSettled(this.#planes(style.cuts)) ?? true;
  }

  /** Lets the light follow a style: nearly, while something is `moving`. */
  followLight(style: Style, moving: boolean): void {
    this.#lightBy(style)?.follow(this.#planes(style.cuts), moving);
  }

  /** Until the light is that of a style. */
  async light(style: Style): Promise<void> {
    await this.#light?.ready;
    await this.#lightBy(style)?.settle(this.#planes(style.cuts));
  }

  /** In the lights of a style, where it can be lit by others than its own. */
  #lightBy(style: Lighting): OpenedLight | null {
    const { rig, turn, lamp } = style;
    const wanted = JSON.stringify([rig, turn, lamp]);
    if (this.#light && this.faces && wanted !== this.#lights.name) {
      const lights = isOwn(style) ? null : lightsOf(style, this.faces.section.rig);
      this.#lights = { name: wanted, lights };
    }
    this.#light?.setRig(this.#lights.lights);
    return this.#light;
  }

  /** What is drawn in `style` with `effort`, seen by `camera` in a picture of `height` px. */
  subject(
    camera: PerspectiveCamera,
    height: number,
    { cuts, clip, section, grey, openings, layers, depthCue }: Style,
    window: Window | null,
    effort: FaceEffort,
  ): Subject {
    const { mesh, faces, info, cue } = this;
    cue.strength = depthCue;
    const planes = this.#planes(cuts);
    this.#setClip(planes, clip);
    mesh.visible = true;
    const byVolume = faces !== null && section === "volume" && layers.faces;
    mesh.relit = byVolume && (this.#light?.relights(planes) ?? false);
    if (!byVolume) {
      return { mesh, faces: null, cue };
    }
    mesh.visible = layers.body || planes.length === 0;
    // A pixel at the far side of the case, mm.
    const eye = camera.position.clone().applyMatrix4(kWorldFromPatient.clone().invert());
    const reach = eye.distanceTo(info.sphere.center) + info.sphere.radius;
    const pixel = (2 * reach * Math.tan((camera.fov * Math.PI) / 360)) / height;
    faces.setPlanes(planes, effort.rays > 1 ? 2 * pixel : 0, !mesh.visible);
    faces.setStyle(grey, openings, window);
    faces.effort = effort;
    return { mesh, faces, cue };
  }

  /** How planes switch the splats' layers; null: they do not. */
  layersAt(planes: readonly Plane[]): LayerSwitch | null {
    return this.hasLayers ? switchLayers(this.info.states, planes) : null;
  }

  #setClip(planes: readonly Plane[], clip: ClipOperator): void {
    this.mesh.setClip(planes, clip, clip === "layers" ? this.layersAt(planes) : null);
  }

  #planes(cuts: readonly Cut[]): Plane[] {
    return this.awaitsSection ? [] : planesOf(cuts);
  }

  /** Frees what the GPU holds. */
  free(): void {
    this.mesh.free();
    this.#light?.dispose();
    this.#coming?.free();
  }
}
