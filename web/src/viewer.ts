import { effect, signal } from "@preact/signals-core";
import { type PerspectiveCamera, Scene, WebGLRenderer } from "three";

import type { Picture, ViewerStats } from "./api";
import type { CaseInfo } from "./model/case_info";
import { type Cut, planesOf } from "./model/cut";
import type { FaceEffort } from "./model/face_style";
import type { Grip } from "./model/plane_drag";
import type { Window } from "./model/grey";
import type { MarkShape } from "./model/marks";
import { regionValues } from "./model/region";
import { readSection } from "./model/values";
import type { Inset } from "./model/view";
import { isSamePicture, type ViewerState, ViewerStore } from "./model/viewer_state";
import { Background } from "./render/background";
import { CanvasCamera, type Frame } from "./render/canvas_camera";
import { FrameRate } from "./render/frame_rate";
import { kAtRest, kMoving, OpenCase, type SortResult } from "./render/open_case";
import { Picking } from "./render/picking";
import { PlaneWidget } from "./render/plane_widget";
import { SplatLayer, type Subject } from "./render/splat_layer";
import { tileCamera, tilesOf } from "./render/tiles";
import { type Section, SectionError } from "./sog/section";
import { CaseError } from "./sog/zip";
import type { CaseClient, DecodedSection, LoadListener } from "./worker/case_client";
import { type CaseSource, kSuperseded, type LoadedCase } from "./worker/protocol";

/** What splats are sorted for: without those that reach no farther than `leastPixels`. */
interface SortFrame {
  camera: PerspectiveCamera;
  width: number;
  height: number;
  leastPixels: number;
}

/** Who waits for a case also hears when it is seen, whole. */
export interface OpeningListener extends LoadListener {
  pictured?(): void;
}

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

function makeCanvas(width: number, height: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  return canvas;
}

/**
 * A case in a canvas: decoding, sorting and drawing what the store says, without any panels. `drawnFrame` is called after
 * every frame, `failed` where a case that was shown cannot be shown any more.
 */
export class Viewer {
  readonly canvas: HTMLCanvasElement;
  readonly store = new ViewerStore();
  /** Where things are on the canvas. */
  readonly camera: CanvasCamera;
  /** What is met there. */
  readonly picking: Picking;
  readonly background = new Background();
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
  drawnFrame: () => void = () => {};
  /** Called before another case takes the place of the one that is seen. */
  leaving: () => void = () => {};
  failed: (error: CaseError) => void = () => {};

  readonly #version = signal(0);
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #layer: SplatLayer;
  readonly #widget = new PlaneWidget();
  readonly #client: CaseClient;
  #case: OpenCase | null = null;
  #seen: ViewerState; // that the picture is drawn of, or will be
  #asOf: ViewerState | null = null; // while a picture is drawn of what was
  readonly #unfollow: () => void;

  #orderStale = false; // something moved since the last sort began
  #splatsStale = false;
  #coarse = false; // what is shown was drawn for speed
  #canvasStale = true;
  #captured: Promise<void> | null = null; // while a picture is drawn apart
  #lastChange = 0; // ms, and as an animation frame
  #changeTick = 0;
  readonly #rate = new FrameRate(kFrameMs, kMinScale);
  #ticks = 0; // animation frames
  #sortedFor: SortFrame | null = null; // last, by who draws
  #ordered = false; // whether the case's splats have an order
  #pictured = false; // whether the page has drawn it
  readonly #firstFrame: (() => void)[] = [];
  #worn = false; // a headset draws
  #disposed = false;

  /** Takes over the client. Throws CaseError where the browser cannot draw. */
  constructor(canvas: HTMLCanvasElement, client: CaseClient) {
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
    this.camera = new CanvasCamera(() => ({ view: this.state.view, sphere: this.info?.sphere ?? null }));
    this.picking = new Picking(this, this.camera, this.#widget);
    this.#seen = this.store.state;
    this.#unfollow = effect(() => this.#follow(this.store.state));
    this.resize(this.camera.frame.inset);
    requestAnimationFrame(this.#frame);
  }

  /** What is shown: that of the store, but for pictures that are drawn of what was. */
  get state(): ViewerState {
    return this.#asOf ?? this.store.state;
  }

  /** The cut that is moved; null: nothing is cut. */
  get cut(): Cut | null {
    return this.state.cuts[this.state.active] ?? null;
  }

  /** Counts what changes the picture, or what can be done with it. */
  get version(): number {
    return this.#version.value;
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
    return this.store.info;
  }

  /** Of the case that is shown; "": there is none. */
  get title(): string {
    return this.info?.title || (this.caseName ?? "");
  }

  /** Why faces are not drawn from a volume, whatever the state asks for; null: they are. */
  get noSection(): string | null {
    return this.#case?.noSection ?? null;
  }

  /** Whether the case's file says how it lies in the patient. */
  get hasWorld(): boolean {
    return this.#case?.hasWorld ?? true;
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
   * Shows the case of `source`. The view and plane stay, and of another look of the same volume the camera itself, the
   * window and the marks, too, unless `begin`, called before the first picture, says otherwise.
   * The body is shown, uncut, before its section is there; resolves with the first picture after. Where there is another
   * case to be seen, that stays until all of this one's file is there, and good. Rejects with CaseError.
   */
  async open(
    name: string,
    source: CaseSource,
    listener: OpeningListener | null = null,
    begin: () => void = () => {},
  ): Promise<void> {
    const loaded = await this.#client.load(source, listener, this.#case === null);
    const opened = await this.#alone(async () => {
      if (this.#disposed) {
        throw new CaseError("the viewer is gone");
      }
      const fresh = this.#take(name, loaded);
      this.leaving();
      this.#replaceCase(fresh);
      this.stats.total = loaded.scene.count;
      begin();
      return fresh;
    });
    void this.#nextPicture().then(() => {
      if (this.#case === opened) {
        performance.mark(kPictureMark);
        listener?.pictured?.();
      }
    });
    await this.#complete(opened, loaded.ticket);
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
    const loaded = await this.#client.load(url, null, false);
    const fresh = new OpenCase(before.name, loaded, this.#client);
    const isWanted = () => this.#case === before && !this.#disposed;
    try {
      if (loaded.sectionProblem) {
        throw new CaseError(loaded.sectionProblem);
      }
      const decoded = await this.#client.section(loaded.ticket);
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
      this.camera.place();
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
    const { camera, frame } = this.camera;
    return { camera, width: frame.width, height: frame.height, leastPixels: 0 };
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
    this.#free(this.#case);
    this.#case = opened;
    this.#ordered = false;
    this.#pictured = false;
    this.stats.sectionBytes = 0;
    this.stats.sectionMs = 0;
    this.#rate.restart();
    this.#widget.setSphere(opened.info.sphere);
    this.store.setCase(opened.info);
    this.#touch();
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

  /** Gives a case the rest of it, after its first picture: both wait for the GPU. Throws CaseError. */
  async #complete(opened: OpenCase, ticket: number): Promise<void> {
    await this.#nextPicture();
    let decoded: DecodedSection | null;
    try {
      decoded = await this.#client.section(ticket);
    } catch (error) {
      this.#lackRest(opened, error as CaseError);
      return;
    }
    if (!decoded) {
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

  /** Without its section a case can be shown; of a file that is broken nothing is. Throws what is wrong with the file. */
  #lackRest(opened: OpenCase, error: CaseError): void {
    if (error instanceof SectionError || error.message === kSuperseded) {
      opened.loseSection(error.message);
      this.#touch();
    } else {
      this.#refuse(opened, error);
    }
    if (!(error instanceof SectionError)) {
      throw error;
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
      this.store.setCase(null);
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

  /** What lies behind the case where none is chosen: a quiet glow; null: black. */
  setGlow(glow: Background["glow"]): void {
    if (this.background.glow !== glow) {
      this.background.glow = glow;
      this.#splatsStale = true; // they may fade towards it
      this.#canvasStale = true;
    }
  }

  /** While something moves, the surface and resolution are given up where frames would come late. */
  steady = true;

  /** Fits the drawing buffer to the canvas's size on the page; `inset` (CSS px) is covered by panels. */
  resize(inset: Inset): void {
    const { clientWidth, clientHeight } = this.canvas;
    const [width, height] = [Math.max(1, clientWidth), Math.max(1, clientHeight)];
    this.camera.frame = { width, height, inset };
    this.#renderer.setPixelRatio(Math.min(kMaxPixelRatio, devicePixelRatio));
    this.#renderer.setSize(width, height, false);
    this.#touch();
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

  /** Whether the case can be seen in other lights than its own: null until that is known. */
  get canChangeRig(): boolean | null {
    return this.#case?.canChangeRig ?? null;
  }

  /** Whether there is something to mark: values at all points, or within what lies in a face. */
  hasValues(shape: MarkShape): boolean {
    const { section } = this;
    if (!section) {
      return false;
    }
    return shape.normal
      ? regionValues(shape, section) !== null
      : shape.points.every((point) => readSection(section, point));
  }

  setHover(grip: Grip | null): void {
    this.#widget.setHover(grip);
    this.#canvasStale = true;
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
          camera: this.camera.camera,
          width,
          height,
          moving,
        }),
    );
  }

  /**
   * A picture of width × height px, without the handle: transparent, or over what lies behind the case. `label` draws over
   * it while the viewer is in the state that was, as if the canvas were of that form and no smaller than it is.
   */
  async paint(
    width: number,
    height: number,
    transparent: boolean,
    label: (over: HTMLCanvasElement) => void,
  ): Promise<HTMLCanvasElement> {
    const current = this.#case;
    if (!current || this.#worn) {
      throw new CaseError(kNotPictured);
    }
    const [picture, over] = [makeCanvas(width, height), makeCanvas(width, height)];
    const frame = { width, height, inset: { right: 0, bottom: 0 } };
    return this.#capture(
      current,
      () => frame,
      async () => {
        const subject = this.#subject(current, kAtRest, height);
        const camera = this.camera.camera.clone();
        const { backdrop } = this.state;
        this.#labelAs(frame, () => label(over));
        const context = picture.getContext("2d")!;
        for (const tile of tilesOf(width, height)) {
          const { drawn } = tile;
          const part = tileCamera(camera, width, height, tile);
          const { data } = await this.#layer.read(subject, { ...drawn, camera: part, moving: false });
          const pixels = new ImageData(new Uint8ClampedArray(data), drawn.width, drawn.height);
          const [left, top] = [tile.x - drawn.x, tile.y - drawn.y];
          context.putImageData(pixels, drawn.x, drawn.y, left, top, tile.width, tile.height);
        }
        if (!transparent) {
          this.background.paint(context, width, height, backdrop);
        }
        context.drawImage(over, 0, 0);
        return picture;
      },
    );
  }

  /** Does `work` as if the canvas were of that form. */
  #labelAs(frame: Frame, work: () => void): void {
    const before = this.camera.frame;
    const { width, height } = this.camera.freeSize;
    const scale = Math.min(frame.width, frame.height) / Math.min(width, height);
    this.camera.frame = { ...frame, width: frame.width / scale, height: frame.height / scale };
    try {
      work();
    } finally {
      this.camera.frame = before;
    }
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
      () => this.camera.frame,
      () => {
        this.#drawSplats(current, false);
        return copy();
      },
    );
  }

  /** Puts what the canvas shows onto another one. Returns whether it shows a case. */
  copyCanvas(onto: HTMLCanvasElement): boolean {
    if (!this.#pictured || this.#worn) {
      return false;
    }
    this.#drawCanvas();
    const { width, height } = this.canvas;
    Object.assign(onto, { width, height }); // begins empty
    onto.getContext("2d")!.drawImage(this.canvas, 0, 0);
    return true;
  }

  /** Who draws: a headset, in its own frames, or the page. */
  yieldTo(headset: object | null): void {
    this.#worn = headset !== null;
    if (!this.#worn) {
      this.#case?.mesh.invalidateColors();
      this.resize(this.camera.frame.inset);
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
    this.#unfollow();
    this.#client.dispose();
    this.#case?.free();
    this.#case = null;
    this.#widget.dispose();
    this.#layer.dispose();
    this.background.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss(); // browsers keep few contexts, and collect them late
  }

  /** The picture is to be that of a state. */
  #follow(state: ViewerState): void {
    const before = this.#seen;
    this.#seen = state;
    if (before !== state && isSamePicture(before, state)) {
      this.#canvasStale = true;
      this.#tellOfChange();
    } else {
      this.#touch();
    }
  }

  /** Whoever follows the version is told at once. */
  #tellOfChange(): void {
    this.#version.value = this.#version.peek() + 1;
  }

  #touch(): void {
    this.#orderStale = true;
    this.#splatsStale = true;
    this.#canvasStale = true;
    this.#lastChange = performance.now();
    this.#changeTick = this.#ticks;
    this.stats.settled = false;
    this.#tellOfChange();
  }

  /** What cuts open looks otherwise. */
  #relit(): void {
    this.#splatsStale = true;
    this.stats.settled = false;
    this.#tellOfChange(); // whether lights can be chosen is known by now
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
    const { state } = this;
    return this.#alone(async () => {
      await this.#inState(state, current, frame, ({ width, height }) =>
        this.#sort(current, this.camera.camera, width, height),
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
    this.#asOf = state;
    try {
      const wanted = frame();
      this.camera.place(wanted);
      return work(wanted);
    } finally {
      this.#asOf = null;
    }
  }

  /** Without what panels cover of it. */
  #copyCanvas(): HTMLCanvasElement {
    const ratio = this.#renderer.getPixelRatio();
    const { width, height } = this.camera.freeSize;
    const copy = makeCanvas(Math.round(ratio * width), Math.round(ratio * height));
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
      this.camera.place();
      if (this.#orderStale && !this.#client.sorting) {
        this.#orderStale = false;
        const { camera, width, height } = this.#sortOfCanvas;
        void this.#sort(current, camera, width, height);
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
    const { camera, frame } = this.camera;
    const subject = this.#subject(current, moving ? { ...kMoving, detail } : kAtRest, frame.height);
    this.#placeBackground();
    subject.cue.setBackdrop(this.background.shown, this.stats.scale);
    this.#layer.draw(subject, camera, this.stats.scale, moving);
  }

  /** What is drawn of a case, as the state says, with `effort`, in a picture of `height` px. */
  #subject(current: OpenCase, effort: FaceEffort, height: number): Subject {
    return current.subject(this.camera.camera, height, this.state, this.window, effort);
  }

  #placeBackground(): void {
    this.background.place(this.#renderer, this.state.backdrop, this.camera.frame.inset);
  }

  #drawCanvas(): void {
    const { camera, eye, frame } = this.camera;
    this.picking.placeHandle();
    this.#widget.update(eye, (2 * Math.tan((camera.fov * Math.PI) / 360)) / frame.height);
    this.#renderer.clear();
    this.#placeBackground();
    this.background.draw(this.#renderer);
    this.#layer.object.visible = this.#case !== null; // its last picture is of a case that may have been refused
    this.#renderer.render(this.#scene, camera);
  }
}
