import { effect, signal } from "@preact/signals-core";
import type { WebGLRenderer } from "three";

import type { ViewerStats } from "./api";
import { Captures, type Studio } from "./captures";
import type { CaseInfo } from "./model/case_info";
import { type Cut, planesOf } from "./model/cut";
import type { Grip } from "./model/plane_drag";
import type { Window } from "./model/grey";
import type { MarkShape } from "./model/marks";
import { regionValues } from "./model/region";
import { readSection } from "./model/values";
import type { Inset } from "./model/view";
import { activeCut, isSamePicture, type ViewerState, ViewerStore } from "./model/viewer_state";
import type { Background } from "./render/background";
import type { CanvasCamera } from "./render/canvas_camera";
import { FrameRate } from "./render/frame_rate";
import { kAtRest, kMoving, OpenCase, type SortFrame } from "./render/open_case";
import { Painter } from "./render/painter";
import type { Picking } from "./render/picking";
import { kSettleMs, Schedule } from "./render/schedule";
import type { SplatLayer } from "./render/splat_layer";
import type { Section } from "./sog/section";
import { CaseError } from "./sog/zip";
import type { CaseClient, LoadListener } from "./worker/case_client";
import { type CaseSource, kSuperseded, type LoadedCase } from "./worker/protocol";

/** Who waits for a case also hears when it is seen, whole. */
export interface OpeningListener extends LoadListener {
  pictured?(): void;
}

/** On the browser's performance timeline: a case is seen for the first time. */
const kPictureMark = "clipgs: picture";
/** While something moves, resolution is given up for frames of this length. */
const kFrameMs = 30;
const kMinScale = 0.35;
/** What changed within so many frames moves, however long they took. */
const kFramesOfMovement = 2;

/**
 * A case in a canvas: decoding, sorting and drawing what the store says, without any panels. `drawnFrame` is called after
 * every frame, `failed` where a case that was shown cannot be shown any more.
 */
export class Viewer implements Studio {
  readonly canvas: HTMLCanvasElement;
  readonly store = new ViewerStore();
  readonly painter: Painter;
  readonly captures: Captures;
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
  readonly #client: CaseClient;
  #case: OpenCase | null = null;
  #seen: ViewerState; // that the picture is drawn of, or will be
  readonly #unfollow: () => void;

  readonly #schedule: Schedule;
  #canvasStale = true;
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
    this.#schedule = new Schedule(client);
    this.captures = new Captures(this, client, () => this.#touch());
    this.painter = new Painter(canvas, this, () => {
      this.#case?.mesh.invalidateColors();
      void this.#case?.faces?.giveValues(this.renderer).then(() => this.#touch());
      this.#touch();
    });
    this.#seen = this.store.state;
    this.#unfollow = effect(() => this.#follow(this.store.state));
    this.resize(this.camera.frame.inset);
    requestAnimationFrame(this.#frame);
  }

  /** What is shown: that of the store, but for pictures that are drawn of what was. */
  get state(): ViewerState {
    return this.captures.asOf ?? this.store.state;
  }

  /** The cut that is moved; null: nothing is cut. */
  get cut(): Cut | null {
    return activeCut(this.state);
  }

  /** Counts what changes the picture, or what can be done with it. */
  get version(): number {
    return this.#version.value;
  }

  /** Where things are on the canvas. */
  get camera(): CanvasCamera {
    return this.painter.camera;
  }

  /** What is met there. */
  get picking(): Picking {
    return this.painter.picking;
  }

  get renderer(): WebGLRenderer {
    return this.painter.renderer;
  }

  /** What draws the body. */
  get layer(): SplatLayer {
    return this.painter.layer;
  }

  /** Whether a headset draws. */
  get isWorn(): boolean {
    return this.#worn;
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
    const opened = await this.captures.alone(async () => {
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
    await this.#complete(opened);
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
        await fresh.setSection(decoded, this.renderer, () => this.#case === fresh && this.#relit());
        await fresh.light(this.state);
      }
      const renewed = await this.captures.alone(
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
    this.#schedule.rest();
    return true;
  }

  /** Shows another version of a case, in the order that it has for the picture of now. */
  async #swap(fresh: OpenCase, total: number): Promise<boolean> {
    if (!this.#worn) {
      this.camera.place();
    }
    const sorted = await fresh.sort(this.#sortedFor ?? this.#sortOfCanvas, this.state);
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
    this.painter.fit(opened.info);
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

  /** Gives a case the rest of it, after its first picture: both wait for the GPU. Without its section it can be shown. Rejects with CaseError. */
  async #complete(opened: OpenCase): Promise<void> {
    await this.#nextPicture();
    const isShown = () => this.#case === opened;
    try {
      const sectionMs = await opened.complete(this.renderer, isShown, () => this.#relit());
      if (isShown()) {
        this.stats.sectionBytes = opened.faces?.bytes ?? 0;
        this.stats.sectionMs = sectionMs;
      }
    } catch (error) {
      if ((error as CaseError).message !== kSuperseded) {
        this.#refuse(opened, error as CaseError); // its file is broken
      }
      throw error;
    } finally {
      if (isShown()) {
        this.#touch();
      }
    }
  }

  #free(gone: OpenCase | null): void {
    this.layer.forget();
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
    const { background } = this.painter;
    if (background.glow !== glow) {
      background.glow = glow;
      this.#schedule.repaint(); // splats may fade towards it
      this.#canvasStale = true;
    }
  }

  /** While something moves, the surface and resolution are given up where frames would come late. */
  steady = true;

  /** Fits the drawing buffer to the canvas's size on the page; `inset` (CSS px) is covered by panels. */
  resize(inset: Inset): void {
    this.painter.resize(inset);
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
    this.painter.setHover(grip);
    this.#canvasStale = true;
  }

  /** Puts what the canvas shows onto another one. Returns whether it shows a case. */
  copyCanvas(onto: HTMLCanvasElement): boolean {
    if (!this.#pictured || this.#worn) {
      return false;
    }
    this.painter.drawCanvas();
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

  /** Lets the light follow the cut, and begins to cull and sort for a frame of a headset, unless that is being done. */
  sortFor(frame: SortFrame): void {
    this.#case?.followLight(this.state, this.#schedule.isMoving(performance.now()));
    if (this.#case && !this.#client.sorting) {
      void this.order(this.#case, frame);
    }
  }

  /** Ends the worker and gives back what the GPU holds. Nothing can be done with it then. */
  dispose(): void {
    this.#disposed = true;
    this.#unfollow();
    this.#client.dispose();
    this.#case?.free();
    this.#case = null;
    this.painter.dispose();
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
    this.#schedule.touch();
    this.#canvasStale = true;
    this.stats.settled = false;
    this.#tellOfChange();
  }

  /** What cuts open looks otherwise. */
  #relit(): void {
    this.#schedule.repaint();
    this.stats.settled = false;
    this.#tellOfChange(); // whether lights can be chosen is known by now
  }

  /** Has the splats of a case ordered, which is shown no more where that fails. */
  async order(current: OpenCase, frame: SortFrame): Promise<void> {
    this.#sortedFor = frame;
    try {
      const sorted = await this.#schedule.order(current, frame, this.state);
      if (sorted) {
        this.#ordered = current === this.#case;
        this.stats.sortMs = sorted.milliseconds;
        this.stats.drawn = sorted.count;
      }
    } catch (error) {
      this.#fail(current, error as CaseError);
    }
  }

  readonly #frame = (now: number): void => {
    if (this.#disposed) {
      return;
    }
    requestAnimationFrame(this.#frame);
    ++this.#ticks;
    this.#schedule.tick();
    if (this.captures.isTaking || this.#worn) {
      return;
    }
    const current = this.#case;
    if (this.#pictured) {
      this.tick();
    }
    if (current) {
      this.#proceed(current, now);
    }
    if (this.#canvasStale) {
      this.#canvasStale = false;
      this.painter.drawCanvas();
      this.drawnFrame();
    }
    this.stats.settled = current !== null && this.#schedule.isSettled(current, this.state);
  };

  /** Orders, lights and draws what is shown, as far as that is due. */
  #proceed(current: OpenCase, now: number): void {
    const schedule = this.#schedule;
    this.camera.place();
    if (schedule.wantsOrder) {
      void this.order(current, this.#sortOfCanvas);
    }
    // Where a frame takes long, so do the pauses within a movement.
    const pause = Math.max(kSettleMs, 2 * this.stats.frameMs);
    const moving =
      !this.#pictured || current.awaitsSection || schedule.isMoving(now, pause, kFramesOfMovement);
    current.followLight(this.state, moving);
    if (this.#ordered && schedule.isDue(moving)) {
      this.#pictured = true;
      this.#rate.count(now, this.#ticks);
      this.stats.frameMs = this.#rate.frameMs;
      this.#drawBody(current, moving);
    }
  }

  #drawBody(current: OpenCase, moving: boolean): void {
    this.#schedule.drawn(moving);
    this.#canvasStale = true;
    this.stats.scale = moving && this.steady ? this.#rate.scale : 1;
    const detail = this.steady && this.#rate.lean ? "outline" : kMoving.detail;
    const effort = moving ? { ...kMoving, detail } : kAtRest;
    this.painter.drawBody(current, effort, this.stats.scale, moving);
  }
}
