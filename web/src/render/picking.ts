import type { Ray, Vector3 } from "three";

import { type Cut, planesOf } from "../model/cut";
import { faceUnder, gridMiddle, isOnFace } from "../model/faces";
import { type Plane, projectOnto, signedDistance } from "../model/geometry";
import type { Grip } from "../model/plane_drag";
import type { ViewerState } from "../model/viewer_state";
import { type Reading, readSection } from "../model/values";
import type { Section } from "../sog/section";
import type { CanvasCamera } from "./canvas_camera";
import type { OpenCase } from "./open_case";
import type { PlaneWidget } from "./plane_widget";

/** A mark belongs to a face this near to it, mm. */
const kReach = 1;
/** Of the handle, CSS px. */
const kMouseReach = 14;
const kFingerReach = 28;
/** Of a point that was found on a face, mm. */
const kTouch = 1e-3;

/** What is picked of. */
export interface Picked {
  readonly state: ViewerState;
  readonly openCase: OpenCase | null;
  readonly section: Section | null;
  readonly cut: Cut | null;
}

/** What rays meet of a case: its faces with their values, and the plane's handle. RAS mm, and CSS px of the canvas. */
export class Picking {
  readonly #shown: Picked;
  readonly #camera: CanvasCamera;
  readonly #widget: PlaneWidget;

  constructor(shown: Picked, camera: CanvasCamera, widget: PlaneWidget) {
    this.#shown = shown;
    this.#camera = camera;
    this.#widget = widget;
  }

  /** What the face under a place shows there; null where there is no face or only air. */
  readingAt(x: number, y: number): Reading | null {
    return this.readingAlong(this.#camera.ray(x, y));
  }

  /** The same of the face that a ray meets. */
  readingAlong(ray: Ray): Reading | null {
    const { section } = this.#shown;
    const point = section && faceUnder(section, this.#facePlanes, ray);
    return point && readSection(section, point);
  }

  /** The plane of the face that a point was found on, its normal towards what it keeps; null: of none. */
  faceOf(point: Vector3): Plane | null {
    return this.#facePlanes.find((plane) => Math.abs(signedDistance(plane, point)) < kTouch) ?? null;
  }

  /** Whether a point lies on a face that is seen from `eye`. */
  isSeen(point: Vector3, eye = this.#camera.eye): boolean {
    const { section } = this.#shown;
    return section !== null && isOnFace(section, this.#facePlanes, eye, point, kReach);
  }

  /** The middle of the cut face, or of the volume where nothing is cut. */
  get faceMiddle(): Vector3 | null {
    const { section, cut } = this.#shown;
    const middle = section && gridMiddle(section);
    return middle && cut ? projectOnto(cut, middle) : middle;
  }

  /** The handle's centre and radius. */
  get handle(): { center: Vector3; radius: number } {
    this.placeHandle();
    return { center: this.#widget.center, radius: this.#widget.radius };
  }

  /** In the uniaxial mode all of the handle slides the plane. A finger covers more than it means. */
  gripAt(x: number, y: number, byFinger = false): Grip | null {
    this.placeHandle();
    const { handle, mode } = this.#shown.state;
    const reach = byFinger ? kFingerReach : kMouseReach;
    const grip = handle ? this.#widget.gripAt(x, y, reach, (point) => this.#camera.project(point)) : null;
    return grip && mode === "uniaxial" ? "arrow" : grip;
  }

  /** To where the plane is. */
  placeHandle(): void {
    const { state, openCase, cut } = this.#shown;
    this.#widget.setPlane(state.handle && openCase ? cut : null);
  }

  /** What exposes faces: the cut and, with the body, the ends of the volume. */
  get #facePlanes(): Plane[] {
    const { openCase, state } = this.#shown;
    const ends = openCase?.mesh.visible ? openCase.faces?.ends : undefined;
    return [...planesOf(state.cuts), ...(ends ?? [])];
  }
}
