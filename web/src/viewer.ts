import {
  ColorManagement,
  LinearSRGBColorSpace,
  PerspectiveCamera,
  Ray,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";

import { type CaseInfo, parseCaseInfo } from "./model/case_info";
import { canDraw, type Cut, planesOf } from "./model/cut";
import { type FaceSource, faceUnder, gridMiddle, isOnFace } from "./model/faces";
import { kWorldFromPatient, type Plane, projectOnto } from "./model/geometry";
import { type Window, windowPresets } from "./model/grey";
import type { Grip } from "./model/plane_drag";
import { type Mode, nearestState, type PlaneStates, stateCut } from "./model/states";
import { type Reading, readSection } from "./model/values";
import { applyView, focalLength, type Inset, type View, viewFrom } from "./model/view";
import { FullScreenPass } from "./render/full_screen";
import { GpuScene } from "./render/gpu_scene";
import { PlaneWidget } from "./render/plane_widget";
import { writeSortView } from "./render/scene_camera";
import { SectionFaces } from "./render/section_faces";
import { type Picture, SplatLayer, type Subject } from "./render/splat_layer";
import { SplatMesh } from "./render/splat_mesh";
import type { Section } from "./sog/section";
import { CaseError } from "./sog/zip";
import { CaseClient } from "./worker/case_client";
import { type ClipOperator, kViewFloats } from "./worker/protocol";

export interface ViewerState {
  view: View;
  mode: Mode; // uniaxial: no more than one plane, which is that of a state
  cuts: readonly Cut[]; // what all of them keep is shown
  active: number; // the cut that is moved, by its index
  clip: ClipOperator;
  section: FaceSource;
  grey: number; // how faces look: 0 cinematic … 1 grey
  window: Window | null; // of grey values; null: the case's own
  handle: boolean; // whether the plane is drawn
  pins: readonly Reading[]; // points that are marked, the oldest first
}

/** What the last frames cost. */
export interface ViewerStats {
  frameMs: number; // between frames while something moves
  sortMs: number; // culling and sorting, in the worker
  drawn: number; // splats
  total: number;
  scale: number; // resolution of the picture shown, 1: full
  settled: boolean; // the picture shown is that of the state, as good as it gets
  sectionBytes: number; // on the GPU, of the volume that faces are drawn from; 0: none
  sectionMs: number; // decoding it
}

interface OpenCase {
  name: string;
  info: CaseInfo;
  bytes: number;
  ticket: number;
  mesh: SplatMesh;
  faces: SectionFaces | null;
  spare: Uint32Array; // an order buffer that neither the GPU nor the worker has
}

/** Without changes for this long the picture is drawn at full resolution. */
const kSettleMs = 160;
/** While something moves, resolution is given up for frames of this length. */
const kFrameMs = 30;
const kMinScale = 0.35;
/** The first frames of a case compile and upload: they say nothing about speed. */
const kWarmUpFrames = 4;
const kMaxPixelRatio = 2;
/** Rays through a pixel of a face once nothing moves (FaceOptions::kMostRays of src/section/faces.h). */
const kMostRays = 8;
/** Of one case. */
const kMaxPins = 20;
/** A pin belongs to a face this near to it, mm. */
const kPinReach = 1;
const kMmFromWorld = kWorldFromPatient.clone().invert();

/**
 * A case in a canvas: decoding, sorting and drawing, without any panels. Everything is said in patient space (RAS mm).
 * `changed` is called after every change of the state, `drawnFrame` after every frame.
 */
export class Viewer {
  readonly canvas: HTMLCanvasElement;
  readonly state: ViewerState = {
    view: viewFrom(0, 0),
    mode: "arbitrary",
    cuts: [],
    active: 0,
    clip: "exact",
    section: "volume",
    grey: 0,
    window: null,
    handle: true,
    pins: [],
  };
  readonly stats: ViewerStats = {
    frameMs: 0,
    sortMs: 0,
    drawn: 0,
    total: 0,
    scale: 1,
    settled: false,
    sectionBytes: 0,
    sectionMs: 0,
  };
  changed: () => void = () => {};
  drawnFrame: () => void = () => {};

  readonly #renderer: WebGLRenderer;
  readonly #camera = new PerspectiveCamera();
  readonly #scene = new Scene();
  readonly #layer: SplatLayer;
  readonly #widget = new PlaneWidget();
  readonly #background = new FullScreenPass("background.frag.glsl", {
    uSize: { value: new Vector2() },
    uCenter: { value: new Vector2() },
  });
  readonly #client = new CaseClient();
  #case: OpenCase | null = null;
  #noSection: string | null = null;
  #windows: ReadonlyMap<string, Window> = new Map();
  #width = 1; // CSS px
  #height = 1;

  #orderStale = false; // something moved since the last sort began
  #splatsStale = false;
  #coarse = false; // what is shown was drawn for speed
  #canvasStale = true;
  #capturing = false;
  #lastChange = 0;
  #movingScale = 1; // resolution while something moves
  #inset: Inset = { right: 0, bottom: 0 };
  #ticks = 0; // animation frames, and of the last one that drew splats: its number and time
  #splatTick = -1;
  #splatTime = 0;
  #splatFrames = 0; // of this case
  #firstFrame: (() => void)[] = [];

  constructor(canvas: HTMLCanvasElement) {
    ColorManagement.enabled = false; // colours are display sRGB from the file to the screen
    this.canvas = canvas;
    // An opaque canvas, which three.js does not ask for by itself, spares the page a layer to blend.
    const context = canvas.getContext("webgl2", {
      alpha: false,
      antialias: false,
      powerPreference: "high-performance",
    });
    if (!context) {
      throw new CaseError(
        "this browser has no WebGL 2, which the viewer needs; update it or turn acceleration on",
      );
    }
    this.#renderer = new WebGLRenderer({ canvas, context });
    this.#renderer.outputColorSpace = LinearSRGBColorSpace;
    this.#renderer.autoClear = false;
    this.#layer = new SplatLayer(this.#renderer);
    this.#scene.add(this.#layer.object, this.#widget.object);
    this.#renderer.setClearColor(0, 0);
    canvas.addEventListener("webglcontextrestored", () => {
      this.#renderer.setClearColor(0, 0); // three.js forgets it
      this.#case?.mesh.invalidateColors();
      this.#touch();
    });
    this.resize(this.#inset);
    requestAnimationFrame(this.#frame);
  }

  get caseName(): string | null {
    return this.#case?.name ?? null;
  }

  get info(): CaseInfo | null {
    return this.#case?.info ?? null;
  }

  /** Why faces are not drawn from a volume, whatever the state asks for; null: they are. */
  get noSection(): string | null {
    return this.#noSection;
  }

  /** The volume that faces can be drawn from. */
  get section(): Section | null {
    return this.#case?.faces?.section ?? null;
  }

  /** The windows that the case is usually seen through; none for photographs and without a section. */
  get windows(): ReadonlyMap<string, Window> {
    return this.#windows;
  }

  /** The window in use. */
  get window(): Window | null {
    return this.#windows.size > 0 ? (this.state.window ?? [...this.#windows.values()][0]!) : null;
  }

  /** Shows the case at `url`; the view and plane stay. Resolves with its first picture; rejects with CaseError. */
  async open(name: string, url: string, progress: (share: number) => void = () => {}): Promise<void> {
    const loaded = await this.#client.load(url, progress);
    const info = parseCaseInfo(loaded.clipgs);
    await this.#sortDone();
    this.#freeCase();
    const scene = new GpuScene(loaded.scene);
    const mesh = new SplatMesh(scene, info.sceneToPatient, info.mmPerUnit, info.faceGain);
    mesh.matrix.multiplyMatrices(kWorldFromPatient, info.sceneToPatient);
    mesh.matrixWorld.copy(mesh.matrix);
    const spare = new Uint32Array(scene.capacity);
    const faces = this.#makeFaces(loaded.section);
    this.#windows = faces ? windowPresets(faces.section) : new Map();
    this.state.window = null;
    this.state.pins = [];
    this.#case = { name, info, bytes: loaded.bytes, ticket: loaded.ticket, mesh, faces, spare };
    this.stats.sectionBytes = faces?.bytes ?? 0;
    this.stats.sectionMs = loaded.sectionMs;
    this.#splatFrames = 0;
    this.#widget.setSphere(info.sphere);
    this.stats.total = loaded.scene.count;
    this.setCuts(this.state.cuts, this.state.active);
    await new Promise<void>((resolve) => this.#firstFrame.push(resolve));
  }

  /** A gradient behind the case, or black. */
  background = true;

  /** Fits the drawing buffer to the canvas's size on the page; `inset` (CSS px) is covered by panels. */
  resize(inset: Inset): void {
    this.#inset = inset;
    const { clientWidth, clientHeight } = this.canvas;
    this.#width = Math.max(1, clientWidth);
    this.#height = Math.max(1, clientHeight);
    this.#renderer.setPixelRatio(Math.min(kMaxPixelRatio, devicePixelRatio));
    this.#renderer.setSize(this.#width, this.#height, false);
    this.#touch();
  }

  setView(view: Partial<View>): void {
    Object.assign(this.state.view, view);
    this.#touch();
  }

  /** The cut that is moved; null: nothing is cut. */
  get cut(): Cut | null {
    return this.state.cuts[this.state.active] ?? null;
  }

  /** The states of the uniaxial mode. */
  get states(): PlaneStates | null {
    return this.info?.states ?? null;
  }

  /** The state that is shown; null in the arbitrary mode and where nothing is cut. */
  get planeState(): number | null {
    const { info, cut } = this;
    const isState = this.state.mode === "uniaxial" && info && cut;
    return isState ? nearestState(info.states, cut, info.sphere.center) : null;
  }

  setMode(mode: Mode): void {
    this.state.mode = mode;
    this.setCuts(this.state.cuts, this.state.active);
  }

  /** Shows a state in the uniaxial mode; returns whether the case has it, nothing changes otherwise. */
  setPlaneState(state: number): boolean {
    const { states } = this;
    const possible = states !== null && Number.isInteger(state) && state >= 0 && state < states.count;
    if (possible) {
      this.state.mode = "uniaxial";
      this.setCuts([stateCut(states, state)]);
    }
    return possible;
  }

  /** Returns whether there are no more planes than can be drawn; nothing changes otherwise. */
  setCuts(cuts: readonly Cut[], active = 0): boolean {
    const possible = canDraw(cuts);
    if (possible) {
      this.state.cuts = cuts;
      this.state.active = Math.max(0, Math.min(active, cuts.length - 1));
      this.#keepToStates();
      this.#touch();
    }
    return possible;
  }

  /** Moves the active cut; a slab keeps its thickness. */
  movePlane({ normal, offset }: Plane): void {
    const { cuts, active } = this.state;
    this.setCuts(
      cuts.map((cut, i) => (i === active ? { ...cut, normal, offset } : cut)),
      active,
    );
  }

  setClip(clip: ClipOperator): void {
    this.state.clip = clip;
    this.#touch();
  }

  setSection(section: FaceSource): void {
    this.state.section = section;
    this.#touch();
  }

  setGrey(grey: number): void {
    this.state.grey = grey;
    this.#touch();
  }

  /** null: the window that the case's values suggest. */
  setWindow(window: Window | null): void {
    this.state.window = window;
    this.#touch();
  }

  setHandle(visible: boolean): void {
    this.state.handle = visible;
    this.#touch();
  }

  /** Marks a point (RAS mm); the oldest pin goes where there are too many. Returns whether it has a value. */
  addPin(point: Vector3): boolean {
    const pin = this.section && readSection(this.section, point);
    if (pin) {
      this.#setPins([...this.state.pins, pin]);
    }
    return pin !== null;
  }

  /** Marks these points (RAS mm) alone, without those that have no value. */
  setPins(points: readonly Vector3[]): void {
    const { section } = this;
    const readings = section ? points.map((point) => readSection(section, point)) : [];
    this.#setPins(readings.filter((reading) => reading !== null));
  }

  removePin(index: number): void {
    this.#setPins(this.state.pins.filter((_, i) => i !== index));
  }

  /** Whether a pin lies on a face that is seen. */
  showsPin({ point }: Reading): boolean {
    const { section } = this;
    return section !== null && isOnFace(section, this.#facePlanes, this.#eye, point, kPinReach);
  }

  setHover(grip: Grip | null): void {
    this.#widget.setHover(grip);
    this.#canvasStale = true;
  }

  /** The handle's centre and radius, RAS mm. */
  get handle(): { center: Vector3; radius: number } {
    this.#placeWidget();
    return { center: this.#widget.center, radius: this.#widget.radius };
  }

  /** In the uniaxial mode all of the handle slides the plane. */
  gripAt(x: number, y: number): Grip | null {
    this.#placeWidget();
    const grip = this.state.handle ? this.#widget.gripAt(x, y, (point) => this.project(point)) : null;
    return grip && this.state.mode === "uniaxial" ? "arrow" : grip;
  }

  /** What panels leave of the canvas, from its top left, CSS px. */
  get freeSize(): { width: number; height: number } {
    return { width: this.#width - this.#inset.right, height: this.#height - this.#inset.bottom };
  }

  /** CSS px. */
  get focalLength(): number {
    const { width, height } = this.freeSize;
    return focalLength(this.state.view.zoom, width, height);
  }

  /** Of lengths across the view at a point (RAS mm), CSS px; null behind the camera. */
  pixelsPerMm(point: Vector3): number | null {
    this.#placeCamera();
    const depth =
      -1000 * point.clone().applyMatrix4(kWorldFromPatient).applyMatrix4(this.#camera.matrixWorldInverse).z;
    return depth > 0 ? this.focalLength / depth : null;
  }

  /** The middle of the cut face, or of the volume where nothing is cut, RAS mm. */
  get faceMiddle(): Vector3 | null {
    const { section } = this;
    const middle = section && gridMiddle(section);
    return middle && this.cut ? projectOnto(this.cut, middle) : middle;
  }

  /** Where a point (RAS mm) appears, CSS px from the canvas's top left; null behind the camera. */
  project(point: Vector3): { x: number; y: number } | null {
    this.#placeCamera();
    const p = point.clone().applyMatrix4(kWorldFromPatient);
    if (p.clone().applyMatrix4(this.#camera.matrixWorldInverse).z >= 0) {
      return null;
    }
    p.project(this.#camera);
    return { x: 0.5 * (p.x + 1) * this.#width, y: 0.5 * (1 - p.y) * this.#height };
  }

  /** The ray (RAS mm) through a place on the canvas, CSS px. */
  ray(x: number, y: number): Ray {
    this.#placeCamera();
    const through = new Vector3((2 * x) / this.#width - 1, 1 - (2 * y) / this.#height, 0.5).unproject(
      this.#camera,
    );
    const origin = this.#eye;
    return new Ray(origin, through.applyMatrix4(kMmFromWorld).sub(origin).normalize());
  }

  /** What the face under a place on the canvas (CSS px) shows there; null where there is no face or only air. */
  readingAt(x: number, y: number): Reading | null {
    const { section } = this;
    const point = section && faceUnder(section, this.#facePlanes, this.ray(x, y));
    return point && readSection(section, point);
  }

  /**
   * The picture of exactly width × height px without the handle: as `clipgs render` writes it, or while something
   * moves, with fewer rays through faces.
   */
  async renderToPixels(width: number, height: number, moving = false): Promise<Picture> {
    await this.#sortDone();
    const current = this.#case;
    if (!current) {
      throw new Error("no case is open");
    }
    this.#capturing = true;
    try {
      const noInset = { right: 0, bottom: 0 };
      this.#placeCamera(width, height, noInset);
      await this.#sort(current, width, height);
      this.#placeCamera(width, height, noInset);
      return await this.#layer.read(
        this.#subject(current, moving ? 1 : kMostRays, height),
        this.#camera,
        width,
        height,
      );
    } finally {
      this.#capturing = false;
      this.#touch();
    }
  }

  dispose(): void {
    this.#client.dispose();
    this.#freeCase();
    this.#widget.dispose();
    this.#layer.dispose();
    this.#background.dispose();
    this.#renderer.dispose();
  }

  /** Of the camera as it was placed last, RAS mm. */
  get #eye(): Vector3 {
    return this.#camera.position.clone().applyMatrix4(kMmFromWorld);
  }

  /** Of what is cut, the uniaxial mode keeps the active plane, at the nearest state. */
  #keepToStates(): void {
    const { planeState, states } = this;
    if (states && planeState !== null) {
      this.state.cuts = [stateCut(states, planeState)];
      this.state.active = 0;
    }
  }

  /** Pins lie over the picture, which stays as it is. */
  #setPins(pins: readonly Reading[]): void {
    this.state.pins = pins.slice(-kMaxPins);
    this.#canvasStale = true;
    this.changed();
  }

  #touch(): void {
    this.#orderStale = true;
    this.#splatsStale = true;
    this.#canvasStale = true;
    this.#lastChange = performance.now();
    this.stats.settled = false;
    this.changed();
  }

  #placeCamera(width = this.#width, height = this.#height, inset = this.#inset): void {
    const sphere = this.#case?.info.sphere ?? { center: new Vector3(), radius: 100 };
    applyView(this.#camera, this.state.view, sphere, width, height, inset);
  }

  async #sortDone(): Promise<void> {
    while (this.#client.sorting || this.#capturing) {
      await new Promise(requestAnimationFrame);
    }
  }

  /** Culls and sorts for the camera and plane of now, and hands the order to the GPU. */
  async #sort(current: OpenCase, width: number, height: number): Promise<void> {
    const { mesh } = current;
    const view = new Float32Array(kViewFloats);
    mesh.setClip(planesOf(this.state.cuts), this.state.clip);
    writeSortView(view, mesh.sceneCamera(this.#camera, width, height), mesh.planes);
    const sorted = await this.#client.sort(current.ticket, view, mesh.clip, current.spare);
    if (sorted.count < 0) {
      current.spare = sorted.order;
      return;
    }
    current.spare = mesh.setOrder(sorted.order, sorted.count);
    this.stats.sortMs = sorted.milliseconds;
    this.stats.drawn = sorted.count;
    this.#splatsStale = true;
  }

  readonly #frame = (now: number): void => {
    requestAnimationFrame(this.#frame);
    ++this.#ticks;
    if (this.#capturing) {
      return;
    }
    const current = this.#case;
    if (current) {
      this.#placeCamera();
      if (this.#orderStale && !this.#client.sorting) {
        this.#orderStale = false;
        void this.#sort(current, this.#width, this.#height).then(() => this.#firstOrder());
      }
      // Where a frame takes long, so do the pauses within a movement.
      const moving = now - this.#lastChange < Math.max(kSettleMs, 2 * this.stats.frameMs);
      if (this.#splatsStale || (!moving && this.#coarse)) {
        this.#measure(now);
        this.#drawSplats(current, moving);
      }
    }
    if (this.#canvasStale) {
      this.#canvasStale = false;
      this.#drawCanvas();
      this.drawnFrame();
    }
    this.stats.settled =
      current !== null && !this.#orderStale && !this.#client.sorting && !this.#splatsStale && !this.#coarse;
  };

  #firstOrder(): void {
    const waiting = this.#firstFrame;
    this.#firstFrame = [];
    if (waiting.length > 0) {
      requestAnimationFrame(() => waiting.forEach((resolve) => resolve()));
    }
  }

  /** From the time between two frames in a row: how long one takes, and the resolution for the next. */
  #measure(now: number): void {
    const elapsed = now - this.#splatTime;
    const inRow = this.#splatTick === this.#ticks - 1;
    this.#splatTick = this.#ticks;
    this.#splatTime = now;
    if (!inRow || ++this.#splatFrames < kWarmUpFrames) {
      return;
    }
    const { stats } = this;
    stats.frameMs = stats.frameMs > 0 ? 0.8 * stats.frameMs + 0.2 * elapsed : elapsed;
    const step = Math.min(1.05, Math.max(0.7, Math.sqrt(kFrameMs / stats.frameMs)));
    this.#movingScale = Math.min(1, Math.max(kMinScale, this.#movingScale * step));
  }

  #drawSplats(current: OpenCase, moving: boolean): void {
    this.#splatsStale = false;
    this.#canvasStale = true;
    this.stats.scale = moving ? this.#movingScale : 1;
    const subject = this.#subject(current, moving ? 1 : kMostRays, this.#height);
    this.#coarse = moving && (this.stats.scale < 1 || subject.faces !== null);
    this.#layer.draw(subject, this.#camera, this.stats.scale);
  }

  /** What is drawn of a case, as the state says, with `rays` a pixel of a face, in a picture of `height` px. */
  #subject({ mesh, faces, info }: OpenCase, rays: number, height: number): Subject {
    const { cuts, clip, section, grey } = this.state;
    const planes = planesOf(cuts);
    mesh.setClip(planes, clip);
    if (!faces || section === "splats") {
      return { mesh, faces: null };
    }
    // A pixel at the far side of the case, mm.
    const reach = this.#eye.distanceTo(info.sphere.center) + info.sphere.radius;
    const pixel = (2 * reach * Math.tan((this.#camera.fov * Math.PI) / 360)) / height;
    faces.setPlanes(planes, rays > 1 ? 2 * pixel : 0);
    faces.setStyle(grey, this.window);
    faces.rays = rays;
    return { mesh, faces };
  }

  /** What exposes faces: the cut, and the ends of the volume. */
  get #facePlanes(): Plane[] {
    return [...planesOf(this.state.cuts), ...(this.#case?.faces?.ends ?? [])];
  }

  #makeFaces(section: Section | null): SectionFaces | null {
    this.#noSection = null;
    const gl = this.#renderer.getContext() as WebGL2RenderingContext;
    if (!section) {
      this.#noSection = "This case has no section volume: its splats draw the faces.";
    } else if (Math.max(...section.dims) > (gl.getParameter(gl.MAX_3D_TEXTURE_SIZE) as number)) {
      this.#noSection = "This device cannot hold the section volume: splats draw the faces.";
    }
    return section && !this.#noSection ? new SectionFaces(section) : null;
  }

  #freeCase(): void {
    this.#case?.mesh.free();
    this.#case?.faces?.free();
  }

  #placeWidget(): void {
    this.#widget.setPlane(this.state.handle && this.#case ? this.cut : null);
  }

  #drawCanvas(): void {
    this.#placeWidget();
    this.#widget.update(this.#camera, this.#height);
    this.#renderer.clear();
    if (this.background) {
      const { uSize, uCenter } = this.#background.uniforms;
      const ratio = this.#renderer.getPixelRatio();
      const size = this.#renderer.getDrawingBufferSize(uSize!.value as Vector2);
      const { right, bottom } = this.#inset;
      (uCenter!.value as Vector2).set(size.x - ratio * right, size.y + ratio * bottom).multiplyScalar(0.5);
      this.#background.render(this.#renderer, null);
    }
    this.#renderer.render(this.#scene, this.#camera);
  }
}
