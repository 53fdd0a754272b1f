import { HandleStore, type HandleState } from "@pmndrs/handle";
import {
  Box3,
  Group,
  Matrix4,
  type Object3D,
  type PerspectiveCamera,
  Quaternion,
  Scene,
  Vector3,
} from "three";

import { isSameVolume } from "../model/case_info";
import { type Box, kWorldFromPatient } from "../model/geometry";
import type { OpenCase } from "../render/open_case";
import type { Marking } from "../model/marking";
import type { Reading } from "../model/values";
import { cameraAxes } from "../model/view";
import { PlaneWidget } from "../render/plane_widget";
import { setWorldCamera } from "../render/world_camera";
import type { Viewer } from "../viewer";
import { BodyTarget } from "./body_target";
import { BoundsControl } from "./bounds_control";
import { FaceTarget } from "./face_target";
import { handOf } from "./hand";
import { PlaneGrip } from "./plane_grip";
import { WindowGrip } from "./window_grip";
import { handedness, posture } from "./preferences";

/** Of life size. */
export const kLeastScale = 0.1;
export const kMostScale = 20;
/**
 * Where a case is put: this far before the eyes, nearer to who sits, and below them, m; never nearer than its radius and
 * kClear.
 */
const kAhead = { standing: 0.8, seated: 0.6 } as const;
const kBelow = 0.25;
const kClear = 0.35;
/** To the side of the hand that does more, where the panel is not, radians. */
const kAside = 0.12;

const kUp = new Vector3(0, 1, 0);

/**
 * What is seen in the headset, in the room (metres, y up): the case in its life size, to be held, moved, turned and
 * scaled, and the plane that cuts it.
 */
export class Stage {
  readonly scene = new Scene();
  readonly grip: PlaneGrip;
  readonly windowGrip: WindowGrip;
  /** Of the last frame. */
  readonly roomFromPatient = new Matrix4();
  readonly #anchor = new Group(); // what hands move: its origin is the middle of the volume's first case
  readonly #body = new Group(); // the viewer's world
  readonly #bodyTarget: BodyTarget;
  readonly #bounds: BoundsControl;
  readonly #widget = new PlaneWidget(true);
  readonly #store: HandleStore<unknown>;
  readonly #release: () => void;
  readonly #viewer: Viewer;
  readonly #marking: Marking;
  readonly #faceTarget: FaceTarget;
  readonly #patientFromRoom = new Matrix4();
  readonly #boxInRoom = new Box3(); // scratch
  #held = false;
  #case: OpenCase | null = null;
  /** A hand takes hold of the case. */
  grabbed: () => void = () => {};

  constructor(viewer: Viewer, marking: Marking) {
    this.#viewer = viewer;
    this.#marking = marking;
    this.windowGrip = new WindowGrip(viewer);
    this.#faceTarget = new FaceTarget(
      viewer,
      marking,
      this.windowGrip,
      this.roomFromPatient,
      this.#patientFromRoom,
    );
    this.grip = new PlaneGrip(viewer);
    this.#bodyTarget = new BodyTarget(viewer, this.roomFromPatient, this.#patientFromRoom);
    const move = (state: HandleState<unknown>, target: Object3D) => this.#moveCase(state, target);
    this.#bounds = new BoundsControl(this.#anchor, this.#bodyTarget, move);
    this.#body.matrixAutoUpdate = false;
    this.#body.add(this.#bounds.object, this.#widget.object, this.grip.object);
    this.#anchor.add(this.#body);
    this.scene.add(this.#anchor, this.#bodyTarget, this.#faceTarget, viewer.layer.solid);
    this.#store = new HandleStore<unknown>(this.#anchor, () => ({ scale: { uniform: true }, apply: move }));
    this.#release = this.#store.bind(this.#bodyTarget);
  }

  /** The case, as hands meet it. */
  get solid(): Object3D {
    return this.#bodyTarget;
  }

  /** What is pointed at, while points are marked. */
  get reading(): Reading | null {
    return this.#faceTarget.reading;
  }

  /** Whether hands hold the case. */
  get isHeld(): boolean {
    return this.#held;
  }

  /** Where the case stands in the room, or will. */
  get position(): Vector3 {
    return this.#anchor.position;
  }

  /** The highest point above the middle of a box (RAS mm), in the room. */
  top({ min, max }: Box, out: Vector3): Vector3 {
    this.#boxInRoom.set(min, max).applyMatrix4(this.roomFromPatient);
    this.#boxInRoom.getCenter(out);
    return out.setY(this.#boxInRoom.max.y);
  }

  /** How the viewer's world is turned in the room. */
  get quaternion(): Quaternion {
    return this.#anchor.quaternion;
  }

  /** Of life size. */
  get scale(): number {
    return this.#anchor.scale.x;
  }

  set scale(scale: number) {
    this.#anchor.scale.setScalar(Math.min(kMostScale, Math.max(kLeastScale, scale)));
  }

  /** Shows a case, where it lay if it is of the same volume; null: nothing. */
  setCase(shown: OpenCase | null): void {
    if (shown === this.#case) {
      return;
    }
    const before = this.#case?.info;
    this.#case = shown;
    this.#bodyTarget.setCase(shown);
    if (!shown) {
      return;
    }
    const { bounds, sphere } = shown.info;
    if (!isSameVolume(before, shown.info)) {
      const middle = sphere.center.clone().applyMatrix4(kWorldFromPatient);
      this.#body.matrix.makeTranslation(middle.negate());
    }
    this.#bounds.setBox(new Box3(bounds.min, bounds.max).clone().applyMatrix4(kWorldFromPatient));
    this.#body.matrixWorldNeedsUpdate = true;
    this.#widget.setSphere(sphere);
    this.grip.setSphere(sphere);
  }

  /** Puts the case before eyes at `eye` that look along `forward`, in life size, seen from the azimuth of the page. */
  place(eye: Vector3, forward: Vector3): void {
    const radius = 0.001 * (this.#case?.info.sphere.radius ?? 0);
    const level = new Vector3(forward.x, 0, forward.z);
    if (level.length() < 1e-3) {
      level.set(0, 0, -1);
    }
    level.normalize().applyAxisAngle(kUp, handedness.value === "left" ? kAside : -kAside);
    this.scale = 1;
    this.#anchor.position.copy(eye).addScaledVector(level, Math.max(kAhead[posture.value], radius + kClear));
    this.#anchor.position.y -= kBelow;
    const facing = Math.atan2(-level.x, -level.z);
    this.#anchor.rotation.set(0, facing - (this.#viewer.state.view.azimuth * Math.PI) / 180, 0);
  }

  /**
   * Turns the case in its place so that eyes at `eye` look at a side (RAS), the head up where it can be; or a `share` of
   * the way there.
   */
  turnTo(side: Vector3, eye: Vector3, share = 1): void {
    const { right, down } = cameraAxes(side.clone().negate());
    const [x, y, z] = [right, down.negate(), side.clone()].map((axis) =>
      axis.transformDirection(kWorldFromPatient),
    );
    const world = new Matrix4().makeBasis(x!, y!, z!);
    const towards = new Vector3().subVectors(eye, this.#anchor.position).setY(0).normalize();
    const room = new Matrix4().makeBasis(new Vector3().crossVectors(kUp, towards), kUp, towards);
    const wanted = new Quaternion().setFromRotationMatrix(room.multiply(world.transpose()));
    this.#anchor.quaternion.slerp(wanted, share);
  }

  /** Before a frame, seen from `eye` (in the room) with `pixelAngle` the tangent of a pixel's angle. */
  update(time: number, eye: Vector3, pixelAngle: number): void {
    this.#store.update(time);
    this.grip.update(time);
    const marking = this.#marking.kind !== null;
    this.#faceTarget.pointerEvents = marking || this.windowGrip.enabled ? "auto" : "none";
    this.#bodyTarget.pointerEvents = marking ? "none" : "auto";
    this.#bounds.update(time, this.scale, !marking && this.#case !== null && !this.grip.holding);
    this.grip.enabled = !marking;
    const { state, cut } = this.#viewer;
    this.#widget.setPlane(state.handle && this.#case ? cut : null);
    this.#widget.setHover(this.grip.isMet ? "rim" : null);
    this.scene.updateMatrixWorld();
    this.roomFromPatient.multiplyMatrices(this.#body.matrixWorld, kWorldFromPatient);
    this.#patientFromRoom.copy(this.roomFromPatient).invert();
    const { solid } = this.#viewer.layer;
    solid.visible = this.#case !== null;
    solid.position.copy(this.#case?.info.sphere.center ?? eye).applyMatrix4(this.roomFromPatient);
    this.#widget.update(this.toPatient(eye), pixelAngle);
  }

  /** Whether what is held is seen, where the viewer's state wants it. */
  setToolsVisible(visible: boolean): void {
    this.#widget.object.visible = visible && this.#widget.shown;
    this.#bounds.object.visible &&= visible;
  }

  /** A point of the room in the viewer's world. */
  toWorld(point: Vector3): Vector3 {
    return point.applyMatrix4(this.#patientFromRoom).applyMatrix4(kWorldFromPatient);
  }

  /** Sets `out` so that it sees of the viewer's world what a camera in the room does, as near to its near plane. */
  seeWorld(camera: PerspectiveCamera, out: PerspectiveCamera): void {
    setWorldCamera(out, camera, this.#patientFromRoom);
  }

  /** A point of the room in RAS mm. */
  toPatient(point: Vector3): Vector3 {
    return point.clone().applyMatrix4(this.#patientFromRoom);
  }

  /** A pose in the room as one among RAS mm: rigid, whatever the case's scale. */
  poseInPatient(pose: Matrix4): Matrix4 {
    const result = new Matrix4().multiplyMatrices(this.#patientFromRoom, pose);
    const scale = new Vector3().setFromMatrixScale(result).x;
    const position = new Vector3().setFromMatrixPosition(result);
    return result.scale(new Vector3().setScalar(1 / scale)).setPosition(position);
  }

  dispose(): void {
    this.#release();
    this.grip.dispose();
    this.#widget.dispose();
    this.#bounds.dispose();
  }

  #moveCase(state: HandleState<unknown>, target: Object3D): void {
    target.position.copy(state.current.position);
    target.quaternion.copy(state.current.quaternion);
    this.scale = state.current.scale.x;
    const hand = handOf(state.event);
    this.#held = !state.last;
    if (state.first) {
      this.grabbed();
      hand?.pulse(0.6, 30);
    } else if (state.last) {
      hand?.pulse(0.3, 20);
    }
  }
}
