import { HandleStore, type HandleState } from "@pmndrs/handle";
import {
  type Intersection,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  Object3D,
  PlaneGeometry,
  Quaternion,
  Ray,
  type Raycaster,
  Vector3,
} from "three";

import { kWorldFromPatient, type Plane, planeThrough, projectOnto, type Sphere } from "../model/geometry";
import { OrientationSnap } from "../model/orientation_snap";
import { kRim, tangents } from "../render/plane_widget";
import type { Viewer } from "../viewer";
import { type Hand, handOf } from "./hand";
import { PoseFilter } from "./pose_filter";

/** How far from the rim it is met from afar, in radii of the case. */
const kRimThickness = 0.06;
const kPatientFromWorld = kWorldFromPatient.clone().invert();
const kRotation = new Quaternion();
kWorldFromPatient.decompose(new Vector3(), kRotation, new Vector3());

/** The plane (RAS mm) of a pose in the viewer's world: through its position, its z is the normal. */
export function planeOfPose(position: Vector3, quaternion: Quaternion): Plane {
  const normal = new Vector3(0, 0, 1).applyQuaternion(quaternion);
  normal.applyQuaternion(kRotation.clone().invert());
  return planeThrough(normal, position.clone().applyMatrix4(kPatientFromWorld));
}

/** A pose in the viewer's world of a plane, at its point that is nearest to `middle` (both RAS mm). */
export function poseOfPlane(plane: Plane, middle: Vector3, position: Vector3, quaternion: Quaternion): void {
  const [x, y] = tangents(plane.normal);
  quaternion.setFromRotationMatrix(new Matrix4().makeBasis(x, y, plane.normal)).premultiply(kRotation);
  position.copy(projectOnto(plane, middle)).applyMatrix4(kWorldFromPatient);
}

const kFace = { a: 0, b: 1, c: 2, normal: new Vector3(0, 0, 1), materialIndex: 0 };

/** A ray is at the rim when it is so near, in radii of the case; one that is not after so many steps passes it by. */
const kNear = 1e-4;
const kMostSteps = 100;

/**
 * How far along a ray, whose direction is a unit vector, it meets the rim, a ring about z in radii of the case; null: it does
 * not. By steps of the distance that the rim has: its triangles would be a thousand, and garbage for each.
 */
export function rimDistance({ origin, direction }: Ray): number | null {
  let along = 0;
  for (let i = 0; i < kMostSteps && along < origin.length() + 2; ++i) {
    const x = origin.x + along * direction.x;
    const y = origin.y + along * direction.y;
    const z = origin.z + along * direction.z;
    const away = Math.hypot(Math.hypot(x, y) - kRim, z) - kRimThickness;
    if (away < kNear) {
      return along;
    }
    along += away;
  }
  return null;
}

/** From afar it is met at its rim alone, so that the case can be pointed at through it; from near anywhere. */
class Disc extends Mesh<PlaneGeometry, MeshBasicMaterial> {
  readonly #ray = new Ray(); // scratch
  readonly #inverse = new Matrix4();

  constructor(material: MeshBasicMaterial) {
    super(new PlaneGeometry(2, 2), material);
  }

  /** As pointers from near ask for it: what is seen of it is round. */
  override spherecast({ center, radius }: Pick<Sphere, "center" | "radius">, met: Intersection[]): void {
    const point = this.worldToLocal(center.clone())
      .setZ(0)
      .clampLength(0, kRim)
      .applyMatrix4(this.matrixWorld);
    const distance = point.distanceTo(center);
    if (distance <= radius) {
      met.push({ object: this, point, distance, face: kFace });
    }
  }

  override raycast({ ray, near, far }: Raycaster, intersects: Intersection[]): void {
    const local = this.#ray.copy(ray).applyMatrix4(this.#inverse.copy(this.matrixWorld).invert());
    const along = rimDistance(local);
    if (along === null) {
      return;
    }
    const point = local.at(along, new Vector3()).applyMatrix4(this.matrixWorld);
    const distance = point.distanceTo(ray.origin);
    if (near <= distance && distance <= far) {
      intersects.push({ object: this, point, distance, face: kFace });
    }
  }
}

/** The active plane as a thing to take hold of and turn: in six degrees of freedom, in the uniaxial mode in one. */
export class PlaneGrip {
  /** In the viewer's world. */
  readonly object = new Object3D();
  readonly #viewer: Viewer;
  readonly #disc: Disc;
  readonly #held = new Object3D(); // what hands move
  readonly #store: HandleStore<unknown>;
  /** Of planes that are turned. */
  readonly snap = new OrientationSnap();
  readonly #filter = new PoseFilter();
  readonly #middle = new Vector3(); // scratch
  readonly #release: () => void;
  /** Whether hands go through the plane, to the case. */
  locked = false;
  /** Whether hands meet it at all now. */
  enabled = true;
  #time = 0;
  #holding: Hand | null = null;
  readonly #at = new Set<number>(); // pointers
  #sphere: Sphere = { center: new Vector3(), radius: 1 };
  #atEnd = false;

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
    const material = new MeshBasicMaterial();
    material.visible = false;
    this.#disc = new Disc(material);
    this.#disc.pointerEventsOrder = 1; // before the case, which it cuts
    this.object.add(this.#disc, this.#held);
    this.#store = new HandleStore(this.#held, () => ({
      scale: false,
      rotate: viewer.state.mode === "arbitrary",
      multitouch: false,
      apply: (state, target) => this.#apply(state, target),
    }));
    this.#release = this.#store.bind(this.#disc);
    this.#disc.addEventListener("pointerenter", ({ pointerId }) => this.#at.add(pointerId));
    this.#disc.addEventListener("pointerleave", ({ pointerId }) => this.#at.delete(pointerId));
  }

  get holding(): Hand | null {
    return this.#holding;
  }

  /** Whether hands hold it, or would. */
  get isMet(): boolean {
    return this.#holding !== null || this.#at.size > 0;
  }

  setSphere(sphere: Sphere): void {
    this.#sphere = sphere;
  }

  /** Before a frame: the plane goes where it is held, or the grip to where the plane is. */
  update(time: number): void {
    const { cut } = this.#viewer;
    const seconds = Math.min(0.1, 0.001 * (time - this.#time));
    this.#time = time;
    this.#disc.visible = cut !== null;
    this.#disc.pointerEvents = this.locked || !this.enabled ? "none" : "auto";
    if (!cut) {
      this.#store.cancel();
      return;
    }
    this.#store.update(time);
    if (this.#holding) {
      this.#filter.follow(this.#held.position, this.#held.quaternion, seconds);
      this.#move(this.#snapped(planeOfPose(this.#filter.position, this.#filter.quaternion)));
    } else {
      poseOfPlane(cut, this.#sphere.center, this.#held.position, this.#held.quaternion);
      this.#filter.reset(this.#held.position, this.#held.quaternion);
    }
    this.#disc.position.copy(this.#filter.position);
    this.#disc.quaternion.copy(this.#filter.quaternion);
    this.#disc.scale.setScalar(0.001 * this.#sphere.radius);
  }

  dispose(): void {
    this.#release();
    this.#disc.geometry.dispose();
    this.#disc.material.dispose();
  }

  #apply(state: HandleState<unknown>, target: Object3D): void {
    target.position.copy(state.current.position);
    target.quaternion.copy(state.current.quaternion);
    const hand = handOf(state.event);
    if (state.first && hand) {
      this.#holding = hand;
      this.snap.begin(this.#viewer.cut!.normal);
      hand.pulse(0.6, 30);
    } else if (state.last) {
      this.#holding?.pulse(0.3, 20);
      this.#holding = null;
    }
  }

  /** Where a body plane holds it, turned about the handle's middle; it ticks when one begins to. */
  #snapped(plane: Plane): Plane {
    if (this.#viewer.state.mode === "uniaxial") {
      return plane;
    }
    const { snap } = this;
    const before = snap.caught;
    const normal = snap.turn(plane.normal);
    if (snap.caught !== before && snap.caught) {
      this.#holding?.pulse(0.5, 15);
    }
    return snap.caught
      ? planeThrough(normal, this.#middle.copy(this.#filter.position).applyMatrix4(kPatientFromWorld))
      : plane;
  }

  /** Keeps the plane within the case; ticks at its ends and, in the uniaxial mode, at every state. */
  #move(plane: Plane): void {
    const { radius, center } = this.#sphere;
    const distance = plane.normal.dot(center) - plane.offset;
    const bounded = Math.max(-radius, Math.min(radius, distance));
    const before = this.#viewer.store.planeState;
    this.#viewer.store.movePlane({ normal: plane.normal, offset: plane.offset + distance - bounded });
    const atEnd = bounded !== distance;
    if (this.#viewer.store.planeState !== before || (atEnd && !this.#atEnd)) {
      this.#holding?.pulse(0.2, 8);
    }
    this.#atEnd = atEnd;
  }
}
