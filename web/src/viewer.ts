import {
  ColorManagement,
  LinearSRGBColorSpace,
  PerspectiveCamera,
  Ray,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";

import type { Picture, ViewerStats } from "./api";
import { kBackdrops } from "./model/backdrop";
import { type CaseInfo, isSameVolume } from "./model/case_info";
import { canDraw, type Cut, planesOf } from "./model/cut";
import type { FaceEffort } from "./model/face_style";
import { type FaceSource, faceUnder, gridMiddle, isOnFace } from "./model/faces";
import { kWorldFromPatient, type Plane, projectOnto, type Triple } from "./model/geometry";
import type { GreyOpenings } from "./model/face_style";
import type { Window } from "./model/grey";
import { kAllLayers, type Layers } from "./model/layers";
import type { LinkPin } from "./model/link";
import { type Pin, withoutPin, withPin } from "./model/pins";
import type { Grip } from "./model/plane_drag";
import { kRigs } from "./model/rigs";
import { type Mode, nearestState, type PlaneStates, stateCut } from "./model/states";
import { type Reading, readSection } from "./model/values";
import { applyView, focalLength, type Inset, reframed, type View, viewFrom } from "./model/view";
import { makeBackdrop } from "./render/depth_cue";
import { FrameRate } from "./render/frame_rate";
import { FullScreenPass } from "./render/full_screen";
import { kAtRest, kMoving, OpenCase, type SortResult, type Style } from "./render/open_case";
import { PlaneWidget } from "./render/plane_widget";
import { SplatLayer, type Subject } from "./render/splat_layer";
import type { Section } from "./sog/section";
import { CaseError } from "./sog/zip";
import type { CaseClient, DecodedSection } from "./worker/case_client";
import { type ClipOperator, kSuperseded, type LoadedCase } from "./worker/protocol";

export interface ViewerState extends Style {
  view: View;
  mode: Mode; // uniaxial: no more than one plane, which is that of a state
  active: number; // the cut that is moved, by its index
  window: Window | null; // of grey values; null: the case's own
  handle: boolean; // whether the plane is drawn
  pins: readonly Pin[]; // points that are marked, the oldest first
  backdrop: string | null; // what lies behind the case, one of kBackdrops; null: as the page is
}

/** A picture's size and what panels cover of it, px. */
interface Frame {
  width: number;
  height: number;
  inset: Inset;
}

/** What splats are sorted for: without those that reach no farther than `leastPixels`. */
interface SortFrame {
  camera: PerspectiveCamera;
  width: number;
  height: number;
  leastPixels: number;
}

/** Behind the case where none is chosen, display sRGB: a quiet glow, from its middle outwards. */
const kGlows = {
  dark: {
    inner: new Vector3(0.14, 0.175, 0.222),
    middle: new Vector3(0.078, 0.1, 0.131),
    outer: new Vector3(0.043, 0.055, 0.075),
  },
  light: {
    inner: new Vector3(0.965, 0.975, 0.985),
    middle: new Vector3(0.9, 0.918, 0.937),
    outer: new Vector3(0.82, 0.843, 0.87),
  },
};

/** Why there is no picture, to whoever waited for it. */
const kNotPictured = "the case was closed, or a headset put on, before its picture was drawn; try again";
/** On the browser's performance timeline: a case is seen for the first time. */
const kPictureMark = "clipgs: picture";
/** Without changes for this long the picture is drawn at full resolution. */
const kSettleMs = 160;
/** While something moves, resolution is given up for frames of this length. */
const kFrameMs = 30;
const kMinScale = 0.35;
const kMaxPixelRatio = 2;
/** A pin belongs to a face this near to it, mm. */
const kPinReach = 1;
const kMmFromWorld = kWorldFromPatient.clone().invert();

/**
 * A case in a canvas: decoding, sorting and drawing, without any panels. Everything is said in patient space (RAS mm).
 * `changed` is called after every change of the state, `drawnFrame` after every frame, `failed` where a case that was
 * shown cannot be shown any more.
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
    openings: "cinematic",
    rig: null,
    turn: 0,
    lamp: null,
    window: null,
    handle: true,
    layers: kAllLayers,
    depthCue: 0,
    pins: [],
    backdrop: null,
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
  /** Counts what changes the picture. */
  version = 0;
  changed: () => void = () => {};
  drawnFrame: () => void = () => {};
  failed: (error: CaseError) => void = () => {};

  readonly #renderer: WebGLRenderer;
  readonly #camera = new PerspectiveCamera();
  readonly #scene = new Scene();
  readonly #layer: SplatLayer;
  readonly #widget = new PlaneWidget();
  readonly #backdrop = makeBackdrop(); // of the canvas
  readonly #gradient = new FullScreenPass("background.frag.glsl", { uBackdrop: { value: this.#backdrop } });
  #glow: keyof typeof kGlows | null = "dark";
  readonly #client: CaseClient;
  #case: OpenCase | null = null;
  #width = 1; // CSS px
  #height = 1;

  #orderStale = false; // something moved since the last sort began
  #splatsStale = false;
  #coarse = false; // what is shown was drawn for speed
  #canvasStale = true;
  #captured: Promise<void> | null = null; // while a picture is drawn apart
  #lastChange = 0; // ms, and as an animation frame
  #changeTick = 0;
  readonly #rate = new FrameRate(kFrameMs, kMinScale);
  #inset: Inset = { right: 0, bottom: 0 };
  #ticks = 0; // animation frames
  #sortedFor: SortFrame | null = null; // last, by who draws
  #ordered = false; // whether the case's splats have an order
  #pictured = false; // whether the page has drawn it
  readonly #firstFrame: (() => void)[] = [];
  #worn = false; // a headset draws
  #disposed = false;

  /** Takes over the client. Throws CaseError where the browser cannot draw. */
  constructor(canvas: HTMLCanvasElement, client: CaseClient) {
    ColorManagement.enabled = false; // colours are display sRGB from the file to the screen
    this.canvas = canvas;
    this.#client = client;
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
      void this.#case?.faces?.giveValues(this.#renderer).then(() => this.#touch());
      this.#touch();
    });
    this.resize(this.#inset);
    requestAnimationFrame(this.#frame);
  }

  get renderer(): WebGLRenderer {
    return this.#renderer;
  }

  /** What draws the body. */
  get layer(): SplatLayer {
    return this.#layer;
  }

  get openCase(): OpenCase | null {
    return this.#case;
  }

  get caseName(): string | null {
    return this.#case?.name ?? null;
  }

  get info(): CaseInfo | null {
    return this.#case?.info ?? null;
  }

  /** Why faces are not drawn from a volume, whatever the state asks for; null: they are. */
  get noSection(): string | null {
    return this.#case?.noSection ?? null;
  }

  /** What is wrong with the section that the case should have; null: nothing. */
  get sectionProblem(): string | null {
    return this.#case?.sectionProblem ?? null;
  }

  /** The volume that faces can be drawn from. */
  get section(): Section | null {
    return this.#case?.faces?.section ?? null;
  }

  /** The windows that the case is usually seen through; none for photographs and without a section. */
  get windows(): ReadonlyMap<string, Window> {
    return this.#case?.windows ?? new Map();
  }

  /** The window in use. */
  get window(): Window | null {
    const [usual] = this.windows.values();
    return usual ? (this.state.window ?? usual) : null;
  }

  /**
   * Shows the case at `url`. The view and plane stay, and of another look of the same volume the camera itself, the
   * window and the marks, too, unless `begin`, called before the first picture, says otherwise.
   * The body is shown, uncut, before its section is there; resolves with the first picture after. Rejects with CaseError.
   */
  async open(
    name: string,
    url: string,
    progress: (share: number) => void = () => {},
    begin: () => void = () => {},
  ): Promise<void> {
    const loaded = await this.#client.load(url, progress);
    const opened = await this.#alone(async () => {
      if (this.#disposed) {
        throw new CaseError("the viewer is gone");
      }
      const fresh = this.#take(name, loaded);
      this.#replaceCase(fresh);
      this.stats.total = loaded.scene.count;
      begin();
      return fresh;
    });
    void this.#nextPicture().then(() => this.#case === opened && performance.mark(kPictureMark));
    if (loaded.section) {
      await this.#complete(opened, loaded.ticket);
    }
    await this.#nextPicture();
    if (this.#case !== opened) {
      throw opened.refusal ?? new CaseError(kSuperseded);
    }
  }

  /**
   * Puts a newer version of the case that is shown in its place, once all of it is there: until then that stays as it
   * is, and nothing else changes. Returns whether it did: not where another case is shown by then. Rejects with
   * CaseError.
   */
  async renew(url: string): Promise<boolean> {
    const before = this.#case;
    if (!before) {
      return false;
    }
    const loaded = await this.#client.load(url, () => {});
    const fresh = new OpenCase(before.name, loaded, this.#client);
    const isWanted = () => this.#case === before && !this.#disposed;
    try {
      if (loaded.sectionProblem) {
        throw new CaseError(loaded.sectionProblem);
      }
      const decoded = loaded.section && (await this.#client.section(loaded.ticket));
      if (decoded) {
        await fresh.setSection(decoded, this.#renderer, () => this.#case === fresh && this.#relit());
        await fresh.light(this.state);
      }
      const renewed = await this.#alone(
        async () => isWanted() && (await this.#swap(fresh, loaded.scene.count)),
      );
      if (!renewed) {
        fresh.free();
        return false;
      }
      this.stats.sectionMs = decoded?.milliseconds ?? 0;
    } catch (error) {
      fresh.free();
      throw error;
    }
    // Nothing moved: the next picture is drawn at its best.
    this.#lastChange = -Infinity;
    this.#changeTick = -Infinity;
    return true;
  }

  /** Shows another version of a case, in the order that it has for the picture of now. */
  async #swap(fresh: OpenCase, total: number): Promise<boolean> {
    if (!this.#worn) {
      this.#placeCamera();
    }
    const { camera, width, height, leastPixels } = this.#sortedFor ?? this.#sortOfCanvas;
    const sorted = await fresh.sort(camera, width, height, this.state, leastPixels);
    this.#replaceCase(fresh);
    this.#ordered = sorted !== null;
    this.#pictured = true;
    this.stats.total = total;
    this.stats.drawn = sorted?.count ?? 0;
    this.stats.sectionBytes = fresh.faces?.bytes ?? 0;
    return true;
  }

  get #sortOfCanvas(): SortFrame {
    return { camera: this.#camera, width: this.#width, height: this.#height, leastPixels: 0 };
  }

  /** The worker sorts for a case from when it is loaded: one that cannot be shown leaves none. */
  #take(name: string, loaded: LoadedCase): OpenCase {
    try {
      return new OpenCase(name, loaded, this.#client);
    } catch (error) {
      if (this.#case) {
        this.#refuse(this.#case, new CaseError(kSuperseded));
      }
      throw error;
    }
  }

  #replaceCase(opened: OpenCase): void {
    const { info, state } = this;
    if (info && isSameVolume(info, opened.info)) {
      Object.assign(state.view, reframed(state.view, info.sphere, opened.info.sphere));
    } else {
      state.window = null;
      state.pins = [];
    }
    this.#free(this.#case);
    this.#case = opened;
    this.#ordered = false;
    this.#pictured = false;
    this.stats.sectionBytes = 0;
    this.stats.sectionMs = 0;
    this.#rate.restart();
    this.#widget.setSphere(opened.info.sphere);
    this.setCuts(state.cuts, state.active);
  }

  /** Until the case has been drawn as it is, or is shown no more. */
  async #nextPicture(): Promise<void> {
    if (this.#case) {
      await new Promise<void>((resolve) => this.#firstFrame.push(resolve));
    }
  }

  #endWaiting(): void {
    this.#firstFrame.splice(0).forEach((resolve) => resolve());
  }

  /** Gives a case its section, after its first picture: both wait for the GPU. */
  async #complete(opened: OpenCase, ticket: number): Promise<void> {
    await this.#nextPicture();
    let decoded: DecodedSection;
    try {
      decoded = await this.#client.section(ticket);
    } catch (error) {
      const { message } = error as CaseError;
      if (message === kSuperseded) {
        throw error;
      }
      opened.loseSection(message);
      this.#touch();
      return;
    }
    if (this.#case === opened) {
      await opened.setSection(decoded, this.#renderer, () => this.#case === opened && this.#relit());
    } else {
      decoded.light.dispose();
    }
    if (this.#case === opened) {
      this.stats.sectionBytes = opened.faces?.bytes ?? 0;
      this.stats.sectionMs = decoded.milliseconds;
      this.#touch();
    }
  }

  #free(gone: OpenCase | null): void {
    this.#layer.forget();
    gone?.free();
  }

  /** Shows nothing of a case from now on. */
  #refuse(refused: OpenCase, why: CaseError): void {
    if (this.#case === refused) {
      refused.refusal = why;
      this.#free(refused);
      this.#case = null;
      this.#ordered = false;
      this.stats.total = 0;
      this.#touch();
      this.#endWaiting();
    }
  }

  /** An order that never comes would leave splats in that of a view before. */
  #fail(failed: OpenCase, error: CaseError): void {
    if (this.#case === failed && !this.#disposed) {
      this.#refuse(failed, error);
      this.failed(error);
    }
  }

  /** Fetches a case that may be opened next. */
  prefetch(url: string): void {
    this.#client.prefetch(url);
  }

  /** What lies behind the case where none of kBackdrops is chosen: a quiet glow; null: black. */
  setGlow(glow: keyof typeof kGlows | null): void {
    if (this.#glow !== glow) {
      this.#glow = glow;
      this.#splatsStale = true; // they may fade towards it
      this.#canvasStale = true;
    }
  }

  /** What lies behind the case: one of kBackdrops; null: as the page is. Returns whether there is such a one. */
  setBackdrop(backdrop: string | null): boolean {
    const possible = backdrop === null || kBackdrops.has(backdrop);
    if (possible) {
      this.state.backdrop = backdrop;
      this.#touch();
    }
    return possible;
  }

  /** How much what is far away fades towards what lies behind the case, 0 … 1. */
  setDepthCue(strength: number): void {
    this.state.depthCue = Math.min(1, Math.max(0, strength));
    this.#touch();
  }

  /** While something moves, the surface and resolution are given up where frames would come late. */
  steady = true;

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

  /** Whether the case has layers to clip by. */
  get hasLayers(): boolean {
    return this.#case?.hasLayers ?? false;
  }

  /** Whether layers are to be clipped by, but cannot: the case has none, or the cut is not along its axis. */
  get missesLayers(): boolean {
    const { cuts, clip } = this.state;
    return cuts.length > 0 && clip === "layers" && this.#case?.layersAt(planesOf(cuts)) === null;
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

  /** What grey shows in gaps of a face that the window has black. */
  setOpenings(openings: GreyOpenings): void {
    this.state.openings = openings;
    this.#touch();
  }

  /** Whether the case can be seen in other lights than its own: null until that is known. */
  get canChangeRig(): boolean | null {
    return this.#case?.canChangeRig ?? null;
  }

  /** Lights by one of kRigs; null: by those that the case was made in. Returns whether there is such a rig. */
  setRig(rig: string | null): boolean {
    const possible = rig === null || kRigs.has(rig);
    if (possible) {
      this.state.rig = rig;
      this.#touch();
    }
    return possible;
  }

  /** Turns the lights about the patient's long axis by degrees, counterclockwise seen from the head. */
  setTurn(turn: number): void {
    this.state.turn = turn;
    this.#touch();
  }

  /** A lamp instead of the rig's, that shines from a direction (RAS); null: none. */
  setLamp(from: Triple | null): void {
    this.state.lamp = from && new Vector3(...from).normalize().toArray();
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

  setLayers(layers: Partial<Layers>): void {
    this.state.layers = { ...this.state.layers, ...layers };
    this.#touch();
  }

  /**
   * Marks a point (RAS mm), `joined`: measured from the pin before it. The oldest pin goes where there are too many.
   * Returns whether the point has a value; none is marked else. Marks that were hidden are shown again.
   */
  addPin(point: Vector3, joined = false): boolean {
    const reading = this.section && readSection(this.section, point);
    if (reading) {
      this.state.layers = { ...this.state.layers, marks: true };
      this.#setPins(withPin(this.state.pins, { ...reading, joined }));
    }
    return reading !== null;
  }

  /** Marks these points alone, without those that have no value. */
  setPins(pins: readonly LinkPin[]): void {
    this.#setPins([]);
    pins.forEach(({ point, joined }) => this.addPin(point, joined));
  }

  removePin(index: number): void {
    this.#setPins(withoutPin(this.state.pins, index));
  }

  /** Whether a pin lies on a face that is seen, from `eye` (RAS mm). */
  showsPin({ point }: Reading, eye = this.#eye): boolean {
    const { section } = this;
    return section !== null && isOnFace(section, this.#facePlanes, eye, point, kPinReach);
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
    return this.readingAlong(this.ray(x, y));
  }

  /** The same of the face that a ray (RAS mm) meets. */
  readingAlong(ray: Ray): Reading | null {
    const { section } = this;
    const point = section && faceUnder(section, this.#facePlanes, ray);
    return point && readSection(section, point);
  }

  /**
   * The picture of exactly width × height px without the handle: as `clipgs render` writes it, or as it is drawn while
   * something moves.
   */
  async renderToPixels(width: number, height: number, moving = false): Promise<Picture> {
    const current = this.#case;
    if (!current || this.#worn) {
      throw new Error(current ? "the case is in the headset; take it off first" : "no case is open");
    }
    const frame = { width, height, inset: { right: 0, bottom: 0 } };
    const effort = moving ? kMoving : kAtRest;
    return this.#capture(
      current,
      () => frame,
      () =>
        this.#layer.read(this.#subject(current, effort, height), {
          camera: this.#camera,
          width,
          height,
          moving,
        }),
    );
  }

  /**
   * What the canvas shows, handle and all, as good as it gets, without what panels cover of it. `finish` is called when
   * that is drawn, while the viewer is in the state that was.
   */
  async snapshot(finish: (picture: HTMLCanvasElement) => void): Promise<HTMLCanvasElement> {
    const current = this.#case;
    const copy = (): HTMLCanvasElement => {
      this.#drawCanvas();
      const picture = this.#copyCanvas();
      finish(picture);
      return picture;
    };
    if (!current || this.#worn) {
      return copy();
    }
    return this.#capture(
      current,
      () => this.#frameOfCanvas,
      () => {
        this.#drawSplats(current, false);
        return copy();
      },
    );
  }

  /** Who draws: a headset, in its own frames, or the page. */
  yieldTo(headset: object | null): void {
    this.#worn = headset !== null;
    if (!this.#worn) {
      this.#case?.mesh.invalidateColors();
      this.resize(this.#inset);
    }
  }

  /** At the start of every frame, by who draws it: it is the first one of a case whose order has come. */
  tick(): void {
    if (this.#ordered) {
      this.#endWaiting();
    }
  }

  /**
   * Lets the light follow the cut, and begins to cull and sort for `camera` and a picture of width × height px, without splats that reach no farther than
   * `leastPixels`, unless that is being done.
   */
  sortFor(camera: PerspectiveCamera, width: number, height: number, leastPixels: number): void {
    this.#case?.followLight(this.state, performance.now() - this.#lastChange < kSettleMs);
    if (this.#case && !this.#client.sorting) {
      void this.#sort(this.#case, camera, width, height, leastPixels);
    }
  }

  /** Ends the worker and gives back what the GPU holds. Nothing can be done with it then. */
  dispose(): void {
    this.#disposed = true;
    this.#client.dispose();
    this.#case?.free();
    this.#case = null;
    this.#widget.dispose();
    this.#layer.dispose();
    this.#gradient.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss(); // browsers keep few contexts, and collect them late
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
  #setPins(pins: readonly Pin[]): void {
    this.state.pins = pins;
    this.#canvasStale = true;
    this.changed();
  }

  #touch(): void {
    ++this.version;
    this.#orderStale = true;
    this.#splatsStale = true;
    this.#canvasStale = true;
    this.#lastChange = performance.now();
    this.#changeTick = this.#ticks;
    this.stats.settled = false;
    this.changed();
  }

  /** What cuts open looks otherwise. */
  #relit(): void {
    ++this.version;
    this.#splatsStale = true;
    this.stats.settled = false;
    this.changed(); // whether lights can be chosen is known by now
  }

  #placeCamera(width = this.#width, height = this.#height, inset = this.#inset): void {
    const sphere = this.#case?.info.sphere ?? { center: new Vector3(), radius: 100 };
    applyView(this.#camera, this.state.view, sphere, width, height, inset);
  }

  /**
   * Does `work` while nobody else sorts or takes pictures. It begins in the same turn as the last look at whether
   * somebody does: some browsers draw frames, which sort, between a promise's end and those who wait for it.
   */
  async #alone<T>(work: () => Promise<T>): Promise<T> {
    while (this.#client.sorting || this.#captured) {
      await (this.#client.sorting ?? this.#captured);
    }
    const done = work();
    this.#captured = done.then(
      () => {},
      () => {},
    );
    try {
      return await done;
    } finally {
      this.#captured = null;
      this.#touch();
    }
  }

  /**
   * Sorts for a frame of a case, then calls `draw`: both in the state of now, whatever has changed meanwhile. What `draw`
   * looks at of the state, it looks at in the turn that it is called in.
   */
  async #capture<T>(current: OpenCase, frame: () => Frame, draw: () => T | Promise<T>): Promise<T> {
    const state = { ...this.state, view: { ...this.state.view } };
    return this.#alone(async () => {
      await this.#inState(state, current, frame, ({ width, height }) =>
        this.#sort(current, this.#camera, width, height),
      );
      await current.light(state);
      return this.#inState(state, current, frame, draw);
    });
  }

  /** Does `work` as if the viewer were in that state, with the camera for a frame of `current`. Throws CaseError. */
  #inState<T>(state: ViewerState, current: OpenCase, frame: () => Frame, work: (frame: Frame) => T): T {
    if (this.#case !== current || this.#worn) {
      throw new CaseError(kNotPictured);
    }
    const newest = { ...this.state };
    Object.assign(this.state, state);
    try {
      const { width, height, inset } = frame();
      this.#placeCamera(width, height, inset);
      return work({ width, height, inset });
    } finally {
      Object.assign(this.state, newest);
    }
  }

  get #frameOfCanvas(): Frame {
    return { width: this.#width, height: this.#height, inset: this.#inset };
  }

  /** Without what panels cover of it. */
  #copyCanvas(): HTMLCanvasElement {
    const ratio = this.#renderer.getPixelRatio();
    const { width, height } = this.freeSize;
    const copy = document.createElement("canvas");
    copy.width = Math.round(ratio * width);
    copy.height = Math.round(ratio * height);
    copy.getContext("2d")!.drawImage(this.canvas, 0, 0);
    return copy;
  }

  async #sort(
    current: OpenCase,
    camera: PerspectiveCamera,
    width: number,
    height: number,
    leastPixels = 0,
  ): Promise<void> {
    let sorted: SortResult | null;
    this.#sortedFor = { camera, width, height, leastPixels };
    try {
      sorted = await current.sort(camera, width, height, this.state, leastPixels);
    } catch (error) {
      this.#fail(current, error as CaseError);
      return;
    }
    if (sorted) {
      this.#ordered = current === this.#case;
      this.stats.sortMs = sorted.milliseconds;
      this.stats.drawn = sorted.count;
      this.#splatsStale = true;
    }
  }

  readonly #frame = (now: number): void => {
    if (this.#disposed) {
      return;
    }
    requestAnimationFrame(this.#frame);
    ++this.#ticks;
    if (this.#captured || this.#worn) {
      return;
    }
    const current = this.#case;
    if (this.#pictured) {
      this.tick();
    }
    if (current) {
      this.#placeCamera();
      if (this.#orderStale && !this.#client.sorting) {
        this.#orderStale = false;
        void this.#sort(current, this.#camera, this.#width, this.#height);
      }
      // Where a frame takes long, so do the pauses within a movement.
      const pause = Math.max(kSettleMs, 2 * this.stats.frameMs);
      const changed = this.#ticks - this.#changeTick < 2 || now - this.#lastChange < pause;
      const moving = !this.#pictured || current.awaitsSection || changed;
      current.followLight(this.state, moving);
      const due = moving
        ? this.#splatsStale
        : (this.#splatsStale || this.#coarse) && !this.#orderStale && !this.#client.sorting;
      if (this.#ordered && due) {
        this.#pictured = true;
        this.#rate.count(now, this.#ticks);
        this.stats.frameMs = this.#rate.frameMs;
        this.#drawSplats(current, moving);
      }
    }
    if (this.#canvasStale) {
      this.#canvasStale = false;
      this.#drawCanvas();
      this.drawnFrame();
    }
    this.stats.settled =
      current !== null &&
      !current.awaitsSection &&
      current.isLit(this.state) &&
      !this.#orderStale &&
      !this.#client.sorting &&
      !this.#splatsStale &&
      !this.#coarse;
  };

  #drawSplats(current: OpenCase, moving: boolean): void {
    this.#splatsStale = false;
    this.#canvasStale = true;
    this.stats.scale = moving && this.steady ? this.#rate.scale : 1;
    this.#coarse = moving;
    const detail = this.steady && this.#rate.lean ? "outline" : kMoving.detail;
    const subject = this.#subject(current, moving ? { ...kMoving, detail } : kAtRest, this.#height);
    this.#placeBackdrop();
    subject.cue.setBackdrop(this.#backdrop, this.stats.scale);
    this.#layer.draw(subject, this.#camera, this.stats.scale, moving);
  }

  /** What is drawn of a case, as the state says, with `effort`, in a picture of `height` px. */
  #subject(current: OpenCase, effort: FaceEffort, height: number): Subject {
    return current.subject(this.#camera, height, this.state, this.window, effort);
  }

  /** What exposes faces: the cut and, with the body, the ends of the volume. */
  get #facePlanes(): Plane[] {
    const ends = this.#case?.mesh.visible ? this.#case.faces?.ends : undefined;
    return [...planesOf(this.state.cuts), ...(ends ?? [])];
  }

  /** Where the glow is follows the canvas and its panels. */
  #placeBackdrop(): void {
    const { size, center, inner, middle, outer } = this.#backdrop;
    const chosen = kBackdrops.get(this.state.backdrop ?? (this.#glow === null ? "black" : ""));
    this.#backdrop.isGlow = !chosen;
    if (chosen) {
      inner.set(...chosen.top);
      outer.set(...chosen.bottom);
    } else {
      const glow = kGlows[this.#glow!];
      inner.copy(glow.inner);
      middle.copy(glow.middle);
      outer.copy(glow.outer);
    }
    this.#renderer.getDrawingBufferSize(size);
    const ratio = this.#renderer.getPixelRatio();
    const { right, bottom } = this.#inset;
    center.set(size.x - ratio * right, size.y + ratio * bottom).multiplyScalar(0.5);
  }

  #placeWidget(): void {
    this.#widget.setPlane(this.state.handle && this.#case ? this.cut : null);
  }

  #drawCanvas(): void {
    this.#placeWidget();
    this.#widget.update(this.#eye, (2 * Math.tan((this.#camera.fov * Math.PI) / 360)) / this.#height);
    this.#renderer.clear();
    this.#placeBackdrop();
    this.#gradient.render(this.#renderer, null);
    this.#layer.object.visible = this.#case !== null; // its last picture is of a case that may have been refused
    this.#renderer.render(this.#scene, this.#camera);
  }
}
