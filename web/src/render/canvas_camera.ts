import { PerspectiveCamera, Ray, Vector3 } from "three";

import { kWorldFromPatient, type Sphere } from "../model/geometry";
import { applyView, focalLength, type Inset, type View } from "../model/view";

const kMmFromWorld = kWorldFromPatient.clone().invert();
/** Where no case is open, mm. */
const kNothing: Sphere = { center: new Vector3(), radius: 100 };

/** What a picture is seen by: the view, and what is looked at. */
export interface Sight {
  view: View;
  sphere: Sphere | null;
}

/** A picture's size and what panels cover of it, px. */
export interface Frame {
  width: number;
  height: number;
  inset: Inset;
}

/** The camera of the page: where points of the patient (RAS mm) are on the canvas, CSS px from its top left. */
export class CanvasCamera {
  readonly camera = new PerspectiveCamera();
  frame: Frame = { width: 1, height: 1, inset: { right: 0, bottom: 0 } };
  readonly #sight: () => Sight;

  constructor(sight: () => Sight) {
    this.#sight = sight;
  }

  /** Where it is to stand now, for a picture of that size. */
  place({ width, height, inset } = this.frame): void {
    const { view, sphere } = this.#sight();
    applyView(this.camera, view, sphere ?? kNothing, width, height, inset);
  }

  /** What panels leave of the canvas, from its top left. */
  get freeSize(): { width: number; height: number } {
    const { width, height, inset } = this.frame;
    return { width: width - inset.right, height: height - inset.bottom };
  }

  get focalLength(): number {
    const { width, height } = this.freeSize;
    return focalLength(this.#sight().view.zoom, width, height);
  }

  /** As it was placed last, RAS mm. */
  get eye(): Vector3 {
    return this.camera.position.clone().applyMatrix4(kMmFromWorld);
  }

  /** Of lengths across the view at a point; null behind the camera. */
  pixelsPerMm(point: Vector3): number | null {
    this.place();
    const depth =
      -1000 * point.clone().applyMatrix4(kWorldFromPatient).applyMatrix4(this.camera.matrixWorldInverse).z;
    return depth > 0 ? this.focalLength / depth : null;
  }

  /** Null behind the camera. */
  project(point: Vector3): { x: number; y: number } | null {
    this.place();
    const { width, height } = this.frame;
    const p = point.clone().applyMatrix4(kWorldFromPatient);
    if (p.clone().applyMatrix4(this.camera.matrixWorldInverse).z >= 0) {
      return null;
    }
    p.project(this.camera);
    return { x: 0.5 * (p.x + 1) * width, y: 0.5 * (1 - p.y) * height };
  }

  /** RAS mm. */
  ray(x: number, y: number): Ray {
    this.place();
    const { width, height } = this.frame;
    const through = new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, 0.5).unproject(this.camera);
    const origin = this.eye;
    return new Ray(origin, through.applyMatrix4(kMmFromWorld).sub(origin).normalize());
  }
}
