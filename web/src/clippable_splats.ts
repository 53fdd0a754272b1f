import {
  Box3,
  type Camera,
  Color,
  ColorManagement,
  Matrix4,
  Object3D,
  type Object3DEventMap,
  PerspectiveCamera,
  type Plane,
  Sphere,
  SRGBTransfer,
  Vector2,
  Vector4,
  type WebGLRenderer,
} from "three";

import type { ClipOperator, FaceSource, GreyWindow } from "./api";
import { canDraw, type Cut, kMaxPlanes } from "./model/cut";
import { kWorldFromPatient } from "./model/geometry";
import { kFirst, type Style } from "./model/viewer_state";
import { kAtRest, kMoving, OpenCase } from "./render/open_case";
import { kSettleMs, Schedule } from "./render/schedule";
import { SplatLayer, type Subject } from "./render/splat_layer";
import { setWorldCamera } from "./render/world_camera";
import { CaseError } from "./sog/zip";
import { CaseClient } from "./worker/case_client";
import { kSuperseded } from "./worker/protocol";

export interface ClippableSplatsEventMap extends Object3DEventMap {
  /** Something is drawn otherwise than in the last frame: whoever renders on demand renders again. */
  change: object;
}

/** What nested rendering needs otherwise than a page may have set it. */
function withOwnState(renderer: WebGLRenderer, viewport: Vector4 | undefined, draw: () => void): void {
  const { autoClear, shadowMap } = renderer;
  const { autoUpdate } = shadowMap;
  const { enabled } = renderer.xr;
  const color = renderer.getClearColor(new Color());
  const alpha = renderer.getClearAlpha();
  renderer.autoClear = shadowMap.autoUpdate = renderer.xr.enabled = false;
  renderer.setClearColor(0, 0);
  try {
    draw();
  } finally {
    renderer.autoClear = autoClear;
    shadowMap.autoUpdate = autoUpdate;
    renderer.xr.enabled = enabled;
    renderer.setClearColor(color, alpha);
    if (viewport) {
      renderer.state.viewport(viewport); // that of an eye
    }
  }
}

/**
 * A case among the objects of a three.js scene: add it, and it is drawn with them, also for a headset's eyes. Its own
 * space is the patient's (RAS mm); as it is made, it stands upright in metres and faces +z, as the viewer's world does,
 * and its position, rotation and (uniform) scale can be changed as those of any object. Of depth it has that of its cut
 * faces and surface; splats stand in the body's middle.
 */
export class ClippableSplats extends Object3D<ClippableSplatsEventMap> {
  readonly isClippableSplats = true;
  readonly #renderer: WebGLRenderer;
  readonly #client = new CaseClient();
  readonly #schedule = new Schedule(this.#client);
  readonly #layer: SplatLayer;
  #case: OpenCase | null = null;
  #planes: readonly Plane[] = [];
  #style: Style = kFirst;
  #window: GreyWindow | null = null;
  #subject: Subject | null = null;
  #subjectOf = { height: 0, still: false };
  #settling = 0; // timer
  #disposed = false;
  readonly #seen = new PerspectiveCamera(); // the viewer's world
  readonly #before = { pose: new Matrix4(), projection: new Matrix4() };
  readonly #sorted = new PerspectiveCamera(); // that it was sorted for last
  readonly #patientFromRoom = new Matrix4();
  readonly #viewport = new Vector4();

  /** Draws with `renderer` alone. */
  constructor(renderer: WebGLRenderer) {
    super();
    this.#renderer = renderer;
    this.#layer = new SplatLayer(renderer);
    kWorldFromPatient.decompose(this.position, this.quaternion, this.scale);
    this.#seen.matrixAutoUpdate = this.#seen.matrixWorldAutoUpdate = false;
    this.#sorted.matrixAutoUpdate = this.#sorted.matrixWorldAutoUpdate = false;
    const { solid } = this.#layer;
    solid.visible = false;
    const place = solid.onBeforeRender.bind(solid);
    solid.onBeforeRender = (...frame) => {
      const [drawnBy, , camera] = frame;
      this.#draw(drawnBy, camera);
      place(...frame);
    };
    this.add(solid);
  }

  /** Shows the case at `url`, in place of one before; `progress` is told the share that is there. Rejects with an Error. */
  async load(url: string, progress: (share: number) => void = () => {}): Promise<this> {
    const address = new URL(url, document.baseURI).href;
    const listener = {
      progress: (loaded: number, total: number) => progress(total > 0 ? loaded / total : 0),
    };
    const loaded = await this.#client.load(address, listener, this.#case === null);
    if (this.#disposed) {
      throw new CaseError("these splats are disposed of");
    }
    this.#release();
    const opened = (this.#case = new OpenCase(address, loaded, this.#client));
    this.#layer.solid.position.copy(opened.info.sphere.center);
    this.#layer.solid.visible = true;
    this.#changed();
    const isShown = () => this.#case === opened;
    try {
      await opened.complete(this.#renderer, isShown, () => this.#changed());
      if (!isShown()) {
        throw new CaseError(kSuperseded);
      }
    } catch (error) {
      this.#forgetIf(opened);
      throw error;
    }
    this.#changed();
    return this;
  }

  /** Shows nothing of a case that is broken from now on. */
  #forgetIf(broken: OpenCase): void {
    if (this.#case === broken && !this.#disposed) {
      this.#release();
      this.dispatchEvent({ type: "change" });
    }
  }

  /** What is wrong with the case's volume, without which splats draw cut faces; null: nothing. */
  get problem(): string | null {
    return this.#case?.sectionProblem ?? null;
  }

  /** Its title; empty without a case. */
  get title(): string {
    return this.#case?.info.title ?? "";
  }

  /** Around the body, RAS mm; null without a case. */
  get sphere(): Sphere | null {
    const sphere = this.#case?.info.sphere;
    return sphere ? new Sphere(sphere.center.clone(), sphere.radius) : null;
  }

  /** Of the body, RAS mm; null without a case. */
  get bounds(): Box3 | null {
    const bounds = this.#case?.info.bounds;
    return bounds ? new Box3(bounds.min.clone(), bounds.max.clone()) : null;
  }

  /** RAS mm, with unit normals: what lies on the negative side of one is cut away. Set it anew for changes to be seen. */
  get planes(): readonly Plane[] {
    return this.#planes;
  }

  /** Throws RangeError where they are more than six. */
  set planes(planes: readonly Plane[]) {
    const cuts: Cut[] = planes.map(({ normal, constant }) => ({
      normal: normal.clone(),
      offset: -constant,
      thickness: null,
    }));
    if (!canDraw(cuts)) {
      throw new RangeError(`${planes.length} planes: no more than ${kMaxPlanes} can be drawn`);
    }
    this.#planes = planes.map((plane) => plane.clone());
    this.#setStyle({ cuts });
  }

  /** How splats are cut. */
  get clip(): ClipOperator {
    return this.#style.clip;
  }

  set clip(clip: ClipOperator) {
    this.#setStyle({ clip });
  }

  /** What cut faces are drawn from. */
  get faces(): FaceSource {
    return this.#style.section;
  }

  set faces(section: FaceSource) {
    this.#setStyle({ section });
  }

  /** How much faces show grey values in place of tissue, 0 … 1. */
  get grey(): number {
    return this.#style.grey;
  }

  set grey(grey: number) {
    this.#setStyle({ grey: Math.min(1, Math.max(0, grey)) });
  }

  /** Of grey values; null: the case's own. */
  get window(): GreyWindow | null {
    return this.#window;
  }

  set window(window: GreyWindow | null) {
    this.#window = window && { ...window };
    this.#changed();
  }

  /** Whether the last frame was drawn at its best: nothing moves or is still to come. */
  get settled(): boolean {
    const current = this.#case;
    if (!current) {
      return false;
    }
    // How it can be lit comes last.
    return current.canChangeRig !== null && this.#schedule.isSettled(current, this.#style);
  }

  /** Ends the worker and gives back what the GPU holds. Nothing can be shown then. */
  override dispose(): void {
    this.#disposed = true;
    clearTimeout(this.#settling);
    this.#release();
    this.#client.dispose();
    this.removeFromParent();
    this.#layer.dispose();
  }

  #release(): void {
    this.#layer.solid.visible = false;
    this.#layer.forget();
    this.#case?.free();
    this.#case = null;
    this.#subject = null;
  }

  #setStyle(change: Partial<Style>): void {
    this.#style = { ...this.#style, ...change };
    this.#changed();
  }

  /** The next frames are drawn for speed, until nothing has changed for a while. */
  #changed(): void {
    if (this.#disposed) {
      return;
    }
    this.#subject = null;
    // The material must be there before a frame begins, which goes on with the one that it began with.
    const byVolume = this.#style.section === "volume" && this.#style.layers.faces;
    this.#layer.outlineBy((byVolume && this.#case?.faces) || null);
    this.#moved();
    this.dispatchEvent({ type: "change" });
  }

  #moved(): void {
    this.#schedule.touch();
    clearTimeout(this.#settling);
    this.#settling = window.setTimeout(() => this.dispatchEvent({ type: "change" }), kSettleMs + 1);
  }

  /** What a camera of the page's scene sees, within its frame. */
  #draw(renderer: WebGLRenderer, camera: Camera): void {
    const current = this.#case;
    if (!current || !(camera as PerspectiveCamera).isPerspectiveCamera) {
      return;
    }
    const eye = camera as PerspectiveCamera & { viewport?: Vector4 };
    const target = renderer.getRenderTarget();
    const isForScreen =
      target === null || (target as { isXRRenderTarget?: boolean }).isXRRenderTarget === true;
    this.#layer.toLinear =
      !isForScreen && ColorManagement.getTransfer(target.texture.colorSpace) !== SRGBTransfer;
    const viewport = this.#viewport;
    if (eye.viewport) {
      viewport.copy(eye.viewport);
    } else if (target) {
      viewport.copy(target.viewport);
    } else {
      const { x, y } = renderer.getDrawingBufferSize(new Vector2());
      viewport.set(0, 0, x, y);
    }
    this.#follow(eye);
    setWorldCamera(this.#seen, eye, this.#patientFromRoom);
    this.#seen.fov = eye.fov;
    const still = !eye.viewport && !this.#schedule.isMoving(performance.now());
    this.#prepare(current, viewport.w, still);
    this.#sort(current, viewport.z, viewport.w);
    withOwnState(renderer, eye.viewport, () => {
      if (viewport.x === 0) {
        // of two eyes, the left one's colours do
        current.mesh.updateColors(renderer, current.mesh.scenePoint(this.#seen.position.clone()));
      }
      this.#layer.drawEye(this.#subject!, this.#seen, viewport, still);
    });
    this.#schedule.drawn(!still);
  }

  /** Notices where the camera or the object moved. */
  #follow(eye: PerspectiveCamera): void {
    const { pose, projection } = this.#before;
    this.#patientFromRoom.copy(this.matrixWorld).invert();
    const now = new Matrix4().multiplyMatrices(this.#patientFromRoom, eye.matrixWorld);
    if (!now.equals(pose) || !eye.projectionMatrix.equals(projection)) {
      pose.copy(now);
      projection.copy(eye.projectionMatrix);
      this.#moved();
    }
  }

  #prepare(current: OpenCase, height: number, still: boolean): void {
    const { height: before, still: wasStill } = this.#subjectOf;
    if (!this.#subject || before !== height || wasStill !== still) {
      const [usual] = current.windows.values();
      const effort = still ? kAtRest : kMoving;
      this.#subjectOf = { height, still };
      this.#subject = current.subject(
        this.#seen,
        height,
        this.#style,
        usual ? (this.#window ?? usual) : null,
        effort,
      );
    }
    current.followLight(this.#style, !still);
  }

  /** Orders the splats for what is seen now, unless that is being done. */
  #sort(current: OpenCase, width: number, height: number): void {
    if (!this.#schedule.wantsOrder) {
      return;
    }
    this.#sorted.copy(this.#seen, false);
    const frame = { camera: this.#sorted, width, height, leastPixels: 0 };
    void this.#schedule.order(current, frame, this.#style).then(
      () => this.dispatchEvent({ type: "change" }),
      (error: CaseError) => {
        this.#forgetIf(current);
        console.error(`clipgs: ${error.message}`);
      },
    );
  }
}
