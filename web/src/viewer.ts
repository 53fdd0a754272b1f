import { ColorManagement, LinearSRGBColorSpace, PerspectiveCamera, Ray, Scene, Vector3, WebGLRenderer } from "three";

import { type CaseInfo, parseCaseInfo } from "./model/case_info";
import { kWorldFromPatient, type Plane } from "./model/geometry";
import type { Grip } from "./model/plane_drag";
import { applyView, type View, viewFrom } from "./model/view";
import { GpuScene } from "./render/gpu_scene";
import { PlaneWidget } from "./render/plane_widget";
import { writeSortView } from "./render/scene_camera";
import { type Picture, SplatLayer } from "./render/splat_layer";
import { SplatMesh } from "./render/splat_mesh";
import { CaseClient } from "./worker/case_client";
import { type ClipOperator, kViewFloats } from "./worker/protocol";

export interface ViewerState {
  view: View;
  plane: Plane | null;
  clip: ClipOperator;
  handle: boolean; // whether the plane is drawn
}

/** What the last frames cost. */
export interface ViewerStats {
  frameMs: number; // between frames while something moves
  sortMs: number; // culling and sorting, in the worker
  drawn: number; // splats
  total: number;
  scale: number; // resolution while something moves, 1: full
}

interface OpenCase {
  name: string;
  info: CaseInfo;
  bytes: number;
  ticket: number;
  mesh: SplatMesh;
  spare: Uint32Array; // an order buffer that neither the GPU nor the worker has
}

/** Without changes for this long the picture is drawn at full resolution. */
const kSettleMs = 160;
const kSlowFrameMs = 40;
const kFastFrameMs = 20;
const kMinScale = 0.4;
const kMaxPixelRatio = 2;
const kMmFromWorld = kWorldFromPatient.clone().invert();

/**
 * A case in a canvas: decoding, sorting and drawing, without any panels. Everything is said in patient space (RAS mm).
 * `changed` is called after every change of the state, `drawnFrame` after every frame.
 */
export class Viewer {
  readonly canvas: HTMLCanvasElement;
  readonly state: ViewerState = { view: viewFrom(0, 0), plane: null, clip: "exact", handle: true };
  readonly stats: ViewerStats = { frameMs: 0, sortMs: 0, drawn: 0, total: 0, scale: 1 };
  changed: () => void = () => {};
  drawnFrame: () => void = () => {};

  readonly #renderer: WebGLRenderer;
  readonly #camera = new PerspectiveCamera();
  readonly #scene = new Scene();
  readonly #layer: SplatLayer;
  readonly #widget = new PlaneWidget();
  readonly #client = new CaseClient();
  #case: OpenCase | null = null;
  #width = 1; // CSS px
  #height = 1;

  #orderStale = false; // something moved since the last sort began
  #splatsStale = false;
  #canvasStale = true;
  #capturing = false;
  #lastChange = 0;
  #lastSplatFrame = 0;
  #firstFrame: (() => void)[] = [];

  constructor(canvas: HTMLCanvasElement) {
    ColorManagement.enabled = false; // colours are display sRGB from the file to the screen
    this.canvas = canvas;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: "high-performance" });
    this.#renderer.outputColorSpace = LinearSRGBColorSpace;
    this.#renderer.autoClear = false;
    this.#renderer.setClearColor(0, 0);
    this.#layer = new SplatLayer(this.#renderer);
    this.#scene.add(this.#layer.object, this.#widget.object);
    canvas.addEventListener("webglcontextrestored", () => {
      this.#case?.mesh.invalidateColors();
      this.#touch();
    });
    this.resize();
    requestAnimationFrame(this.#frame);
  }

  get caseName(): string | null {
    return this.#case?.name ?? null;
  }

  get info(): CaseInfo | null {
    return this.#case?.info ?? null;
  }

  /** Shows the case at `url`; the view and plane stay. Resolves with its first picture; rejects with CaseError. */
  async open(name: string, url: string, progress: (share: number) => void = () => {}): Promise<void> {
    const loaded = await this.#client.load(url, progress);
    const info = parseCaseInfo(loaded.clipgs);
    await this.#sortDone();
    this.#case?.mesh.free();
    const scene = new GpuScene(loaded.scene);
    const mesh = new SplatMesh(scene, info.sceneToPatient, info.mmPerUnit);
    mesh.matrix.multiplyMatrices(kWorldFromPatient, info.sceneToPatient);
    mesh.matrixWorld.copy(mesh.matrix);
    const spare = new Uint32Array(scene.capacity);
    this.#case = { name, info, bytes: loaded.bytes, ticket: loaded.ticket, mesh, spare };
    this.#widget.setSphere(info.sphere);
    this.stats.total = loaded.scene.count;
    this.#touch();
    await new Promise<void>((resolve) => this.#firstFrame.push(resolve));
  }

  /** Fits the drawing buffer to the canvas's size on the page. */
  resize(): void {
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

  setPlane(plane: Plane | null): void {
    this.state.plane = plane;
    this.#touch();
  }

  setClip(clip: ClipOperator): void {
    this.state.clip = clip;
    this.#touch();
  }

  setHandle(visible: boolean): void {
    this.state.handle = visible;
    this.#touch();
  }

  setHover(grip: Grip | null): void {
    this.#widget.setHover(grip);
    this.#canvasStale = true;
  }

  /** The handle's centre and radius, RAS mm. */
  get handle(): { center: Vector3; radius: number } {
    return { center: this.#widget.center, radius: this.#widget.radius };
  }

  gripAt(x: number, y: number): Grip | null {
    return this.state.handle ? this.#widget.gripAt(x, y, (point) => this.project(point)) : null;
  }

  /** Where a point (RAS mm) appears, CSS px from the canvas's top left; null behind the camera. */
  project(point: Vector3): { x: number; y: number } | null {
    this.#placeCamera(this.#width, this.#height);
    const p = point.clone().applyMatrix4(kWorldFromPatient);
    if (p.clone().applyMatrix4(this.#camera.matrixWorldInverse).z >= 0) {
      return null;
    }
    p.project(this.#camera);
    return { x: 0.5 * (p.x + 1) * this.#width, y: 0.5 * (1 - p.y) * this.#height };
  }

  /** The ray (RAS mm) through a place on the canvas, CSS px. */
  ray(x: number, y: number): Ray {
    this.#placeCamera(this.#width, this.#height);
    const through = new Vector3((2 * x) / this.#width - 1, 1 - (2 * y) / this.#height, 0.5).unproject(this.#camera);
    const origin = this.#camera.position.clone().applyMatrix4(kMmFromWorld);
    return new Ray(origin, through.applyMatrix4(kMmFromWorld).sub(origin).normalize());
  }

  /** The picture of exactly width × height px without the handle, as `clipgs render` writes it. */
  async renderToPixels(width: number, height: number): Promise<Picture> {
    await this.#sortDone();
    const current = this.#case;
    if (!current) {
      throw new Error("no case is open");
    }
    this.#capturing = true;
    try {
      this.#placeCamera(width, height);
      await this.#sort(current, width, height);
      this.#placeCamera(width, height);
      return await this.#layer.read(current.mesh, this.#camera, width, height);
    } finally {
      this.#capturing = false;
      this.#touch();
    }
  }

  dispose(): void {
    this.#client.dispose();
    this.#case?.mesh.free();
    this.#widget.dispose();
    this.#layer.dispose();
    this.#renderer.dispose();
  }

  #touch(): void {
    this.#orderStale = true;
    this.#splatsStale = true;
    this.#canvasStale = true;
    this.#lastChange = performance.now();
    this.changed();
  }

  #placeCamera(width: number, height: number): void {
    const sphere = this.#case?.info.sphere ?? { center: new Vector3(), radius: 100 };
    applyView(this.#camera, this.state.view, sphere, width, height);
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
    mesh.setClip(this.state.plane, this.state.clip);
    writeSortView(view, mesh.sceneCamera(this.#camera, width, height), mesh.plane.toArray());
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
    if (this.#capturing) {
      return;
    }
    const current = this.#case;
    const settled = now - this.#lastChange > kSettleMs;
    if (current) {
      this.#placeCamera(this.#width, this.#height);
      if (this.#orderStale && !this.#client.sorting) {
        this.#orderStale = false;
        void this.#sort(current, this.#width, this.#height).then(() => this.#firstOrder());
      }
      if (settled && this.stats.scale < 1) {
        this.#drawSplats(current, 1);
        this.stats.scale = 1;
      } else if (this.#splatsStale) {
        this.#drawSplats(current, this.#govern(now, settled));
      }
    }
    if (this.#canvasStale) {
      this.#canvasStale = false;
      this.#drawCanvas();
      this.drawnFrame();
    }
  };

  #firstOrder(): void {
    const waiting = this.#firstFrame;
    this.#firstFrame = [];
    if (waiting.length > 0) {
      requestAnimationFrame(() => waiting.forEach((resolve) => resolve()));
    }
  }

  /** The resolution at which this frame of a movement is drawn, from how long the last ones took. */
  #govern(now: number, settled: boolean): number {
    const elapsed = now - this.#lastSplatFrame;
    this.#lastSplatFrame = now;
    if (settled || elapsed > 1000) {
      return this.stats.scale;
    }
    this.stats.frameMs = this.stats.frameMs > 0 ? 0.8 * this.stats.frameMs + 0.2 * elapsed : elapsed;
    if (this.stats.frameMs > kSlowFrameMs) {
      this.stats.scale = Math.max(kMinScale, 0.92 * this.stats.scale);
    } else if (this.stats.frameMs < kFastFrameMs) {
      this.stats.scale = Math.min(1, 1.05 * this.stats.scale);
    }
    return this.stats.scale;
  }

  #drawSplats(current: OpenCase, scale: number): void {
    this.#splatsStale = false;
    this.#canvasStale = true;
    current.mesh.setClip(this.state.plane, this.state.clip);
    this.#layer.draw(current.mesh, this.#camera, scale);
  }

  #drawCanvas(): void {
    this.#widget.setPlane(this.state.handle && this.#case ? this.state.plane : null);
    this.#widget.update(this.#camera, this.#height);
    this.#renderer.clear();
    this.#renderer.render(this.#scene, this.#camera);
  }
}
