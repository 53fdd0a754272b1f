import { Scene, WebGLRenderer } from "three";

import type { CaseInfo } from "../model/case_info";
import type { FaceEffort } from "../model/face_style";
import type { Window } from "../model/grey";
import type { Grip } from "../model/plane_drag";
import type { Inset } from "../model/view";
import { CaseError } from "../sog/zip";
import { Background } from "./background";
import { CanvasCamera } from "./canvas_camera";
import type { OpenCase } from "./open_case";
import { type Picked, Picking } from "./picking";
import { PlaneWidget } from "./plane_widget";
import { SplatLayer, type Subject } from "./splat_layer";

const kMaxPixelRatio = 2;

/** What is painted. */
export interface Painted extends Picked {
  readonly info: CaseInfo | null;
  readonly window: Window | null;
}

export function makeCanvas(width: number, height: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  return canvas;
}

/** Paints a case into a canvas: its body, and over that the plane's handle, before what lies behind it. */
export class Painter {
  readonly canvas: HTMLCanvasElement;
  readonly renderer: WebGLRenderer;
  /** What draws the body. */
  readonly layer: SplatLayer;
  /** Where things are on the canvas. */
  readonly camera: CanvasCamera;
  /** What is met there. */
  readonly picking: Picking;
  readonly background = new Background();
  readonly #painted: Painted;
  readonly #scene = new Scene();
  readonly #widget = new PlaneWidget();

  /** `restored` is called when the canvas can be drawn into again. Throws CaseError where the browser cannot draw. */
  constructor(canvas: HTMLCanvasElement, painted: Painted, restored: () => void) {
    this.canvas = canvas;
    this.#painted = painted;
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
    this.renderer = new WebGLRenderer({ canvas, context });
    this.renderer.autoClear = false;
    this.renderer.setClearColor(0, 0);
    this.layer = new SplatLayer(this.renderer);
    this.#scene.add(this.layer.object, this.#widget.object);
    canvas.addEventListener("webglcontextrestored", () => {
      this.renderer.setClearColor(0, 0); // three.js forgets it
      restored();
    });
    this.camera = new CanvasCamera(() => ({
      view: painted.state.view,
      sphere: painted.info?.sphere ?? null,
    }));
    this.picking = new Picking(painted, this.camera, this.#widget);
  }

  /** Fits the drawing buffer to the canvas's size on the page; `inset` (CSS px) is covered by panels. */
  resize(inset: Inset): void {
    const { clientWidth, clientHeight } = this.canvas;
    const [width, height] = [Math.max(1, clientWidth), Math.max(1, clientHeight)];
    this.camera.frame = { width, height, inset };
    this.renderer.setPixelRatio(Math.min(kMaxPixelRatio, devicePixelRatio));
    this.renderer.setSize(width, height, false);
  }

  /** Of another case. */
  fit({ sphere }: CaseInfo): void {
    this.#widget.setSphere(sphere);
  }

  setHover(grip: Grip | null): void {
    this.#widget.setHover(grip);
  }

  /** What is drawn of a case, as the state says, with `effort`, in a picture of `height` px. */
  subject(current: OpenCase, effort: FaceEffort, height: number): Subject {
    const { state, window } = this.#painted;
    return current.subject(this.camera.camera, height, state, window, effort);
  }

  /** Draws the body at `scale` times the canvas's resolution, for speed if `moving`. */
  drawBody(current: OpenCase, effort: FaceEffort, scale: number, moving: boolean): void {
    const { camera, frame } = this.camera;
    const subject = this.subject(current, effort, frame.height);
    this.#placeBackground();
    subject.cue.setBackdrop(this.background.shown, scale);
    this.layer.draw(subject, camera, scale, moving);
  }

  /** Draws the canvas, with the body as it was drawn last. */
  drawCanvas(): void {
    const { camera, eye, frame } = this.camera;
    this.picking.placeHandle();
    this.#widget.update(eye, (2 * Math.tan((camera.fov * Math.PI) / 360)) / frame.height);
    this.renderer.clear();
    this.#placeBackground();
    this.background.draw(this.renderer);
    this.layer.object.visible = this.#painted.openCase !== null; // its last picture is of a case that may have been refused
    this.renderer.render(this.#scene, camera);
  }

  /** What the canvas shows, without what panels cover of it. */
  copy(): HTMLCanvasElement {
    this.drawCanvas();
    const ratio = this.renderer.getPixelRatio();
    const { width, height } = this.camera.freeSize;
    const copy = makeCanvas(Math.round(ratio * width), Math.round(ratio * height));
    copy.getContext("2d")!.drawImage(this.canvas, 0, 0);
    return copy;
  }

  dispose(): void {
    this.#widget.dispose();
    this.layer.dispose();
    this.background.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // browsers keep few contexts, and collect them late
  }

  #placeBackground(): void {
    this.background.place(this.renderer, this.#painted.state.backdrop, this.camera.frame.inset);
  }
}
