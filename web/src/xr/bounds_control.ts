import { HandleStore, type HandleState } from "@pmndrs/handle";
import type { PointerEvent } from "@pmndrs/pointer-events";
import {
  BoxGeometry,
  type BufferGeometry,
  Color,
  Group,
  InstancedMesh,
  type Intersection,
  Matrix4,
  MeshBasicMaterial,
  Object3D,
  type Raycaster,
  SphereGeometry,
  Vector3,
} from "three";

import type { Box, Sphere } from "../model/geometry";
import { kBesideCase } from "../render/draw_order";

/** In the room, m, however large the case is. */
const kEdge = 0.0016;
const kCorner = 0.016;
const kKnob = 0.018;
/** Those that are met or held grow. */
const kGrown = 1.4;
/** From afar they are met as if they were so large, as what they are seen at: a hand does not point finer. */
const kLeastAngle = 0.035;
/** Beyond the case's bounds, of their largest extent. */
const kMargin = 0.03;
/** It comes and goes in so long, and goes so long after hands have left it, ms. */
const kFadeMs = 180;
const kLingerMs = 1500;
const kPlain = new Color(0x9fb4c4);
const kMet = new Color(0x7fd8f2);
const kHeld = new Color(0xffffff);
const kAxes = ["x", "y", "z"] as const;

/** The middles of a box's edges, those along x first, then y, then z, and its corners: −1, 0 and 1 along the axes. */
const kEdges = kAxes.flatMap((_, axis) =>
  [-1, 1].flatMap((u) =>
    [-1, 1].map((v) => {
      const middle = new Vector3();
      return middle.setComponent((axis + 1) % 3, u).setComponent((axis + 2) % 3, v);
    }),
  ),
);
const kCorners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => new Vector3(x, y, z))));

/** Things of one form, each met for itself. */
class Instances extends InstancedMesh<BufferGeometry, MeshBasicMaterial> {
  readonly #matrix = new Matrix4(); // scratch
  readonly #middle = new Vector3();

  override raycast({ ray }: Raycaster, met: Intersection[]): void {
    for (let i = 0; i < this.count; ++i) {
      const size = this.#place(i);
      const point = ray.closestPointToPoint(this.#middle, new Vector3());
      const distance = point.distanceTo(ray.origin);
      if (point.distanceTo(this.#middle) < 0.5 * Math.max(size, kLeastAngle * distance)) {
        met.push({ object: this, point, distance, instanceId: i });
      }
    }
  }

  /** As pointers from near ask for it: without this they take all of them for one thing of the geometry's size. */
  override spherecast({ center, radius }: Pick<Sphere, "center" | "radius">, met: Intersection[]): void {
    for (let i = 0; i < this.count; ++i) {
      const size = this.#place(i);
      const distance = Math.max(0, this.#middle.distanceTo(center) - 0.5 * size);
      if (distance <= radius) {
        met.push({ object: this, point: this.#middle.clone(), distance, instanceId: i });
      }
    }
  }

  /** Where the middle of one is, in the room. Returns its size. */
  #place(i: number): number {
    this.getMatrixAt(i, this.#matrix);
    this.#middle.setFromMatrixPosition(this.#matrix.premultiply(this.matrixWorld));
    return this.#matrix.getMaxScaleOnAxis();
  }
}

/**
 * The box around the case, with what changes its size (corners) and turns it (knobs in the middles of edges): it is seen,
 * and can be held, while hands are at it.
 */
export class BoundsControl {
  /** Beside what is moved: in its coordinates. */
  readonly object = new Group();
  readonly #lines: Instances;
  readonly #corners: Instances;
  readonly #knobs: Instances;
  readonly #stores: HandleStore<unknown>[];
  readonly #releases: (() => void)[];
  readonly #at = new Set<number>(); // pointers
  readonly #met = new Map<number, { mesh: Instances; index: number }>(); // by pointers
  readonly #middle = new Vector3();
  readonly #half = new Vector3();
  #held: { mesh: Instances; index: number } | null = null;
  #opacity = 0;
  #left = -Infinity; // when hands did, ms
  #time = 0;
  #room = 0; // that the instances are laid out for
  readonly #matrix = new Matrix4(); // scratch
  readonly #place = new Vector3();
  readonly #size = new Vector3();

  /** Moves `target` as `apply` says; it is shown while hands are at `body`, too. */
  constructor(
    target: Object3D,
    body: Object3D,
    apply: (state: HandleState<unknown>, target: Object3D) => void,
  ) {
    const make = (geometry: BufferGeometry, count: number): Instances => {
      const material = new MeshBasicMaterial({ transparent: true, depthWrite: false });
      const mesh = new Instances(geometry, material, count);
      mesh.frustumCulled = false;
      mesh.renderOrder = kBesideCase;
      this.object.add(mesh);
      return mesh;
    };
    this.#lines = make(new BoxGeometry(1, 1, 1), kEdges.length);
    this.#corners = make(new BoxGeometry(1, 1, 1), kCorners.length);
    this.#knobs = make(new SphereGeometry(0.5, 16, 12), kEdges.length);
    this.#lines.pointerEvents = "none";
    this.object.visible = this.object.intersectChildren = false;
    const take = (mesh: Instances) => (state: HandleState<unknown>, what: Object3D) => {
      if (state.first) {
        this.#held = { mesh, index: instanceOf(state.event) ?? 0 };
      } else if (state.last) {
        this.#held = null;
      }
      apply(state, what);
    };
    const scale = new HandleStore<unknown>(target, () => ({
      translate: "as-scale",
      rotate: false,
      scale: { uniform: true },
      multitouch: false,
      apply: take(this.#corners),
    }));
    const turns = kAxes.map(
      (axis, k) =>
        new HandleStore<unknown>(target, () => ({
          translate: "as-rotate",
          rotate: axis,
          scale: false,
          multitouch: false,
          filter: (event) => Math.floor((instanceOf(event) ?? 0) / 4) === k,
          apply: take(this.#knobs),
        })),
    );
    this.#stores = [scale, ...turns];
    this.#releases = [scale.bind(this.#corners), ...turns.map((store) => store.bind(this.#knobs))];
    for (const part of [body, this.#corners, this.#knobs]) {
      this.#follow(part);
    }
  }

  /** Around a box that is given as it stands in what is moved, m. */
  setBox({ min, max }: Box): void {
    this.#middle.addVectors(min, max).multiplyScalar(0.5);
    this.#half.subVectors(max, min).multiplyScalar(0.5);
    this.#half.addScalar(2 * kMargin * Math.max(...this.#half.toArray()));
    this.#room = 0;
  }

  /** Before a frame; `scale` is that of what is moved. */
  update(time: number, scale: number, enabled: boolean): void {
    this.#stores.forEach((store) => store.update(time));
    const delta = Math.min(100, time - this.#time);
    this.#time = time;
    const isWanted = enabled && (this.#at.size > 0 || this.#held !== null || time - this.#left < kLingerMs);
    if (this.#at.size > 0) {
      this.#left = time;
    }
    const step = delta / kFadeMs;
    this.#opacity = Math.min(1, Math.max(0, this.#opacity + (isWanted ? step : -step)));
    this.object.visible = this.#opacity > 0;
    this.object.intersectChildren = isWanted && this.#opacity > 0.5;
    if (this.object.visible) {
      this.#layOut(scale);
      this.#paint(scale);
    }
  }

  dispose(): void {
    this.#releases.forEach((release) => release());
    for (const mesh of [this.#lines, this.#corners, this.#knobs]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.dispose();
    }
  }

  #follow(part: Object3D): void {
    const handle = part instanceof Instances ? part : null;
    const at = (event: PointerEvent) => {
      this.#at.add(event.pointerId);
      const index = instanceOf(event);
      if (handle && index !== undefined) {
        this.#met.set(event.pointerId, { mesh: handle, index });
      }
    };
    part.addEventListener("pointermove", at);
    part.addEventListener("pointerenter", at);
    part.addEventListener("pointerleave", ({ pointerId }: PointerEvent) => {
      this.#at.delete(pointerId);
      this.#met.delete(pointerId);
    });
  }

  /** Lines are as thick in the room as ever. */
  #layOut(scale: number): void {
    if (this.#room === scale) {
      return;
    }
    this.#room = scale;
    kEdges.forEach((at, i) => {
      const axis = Math.floor(i / 4);
      const length = 2 * this.#half.getComponent(axis);
      this.#size.setScalar(kEdge / scale).setComponent(axis, length);
      this.#put(this.#lines, i, at);
    });
    this.#lines.instanceMatrix.needsUpdate = true;
  }

  #put(mesh: Instances, i: number, at: Vector3): void {
    this.#place.copy(at).multiply(this.#half).add(this.#middle);
    mesh.setMatrixAt(i, this.#matrix.makeScale(...this.#size.toArray()).setPosition(this.#place));
  }

  /** What is lit is larger, too. */
  #paint(scale: number): void {
    const lit = this.#held ? [this.#held] : [...this.#met.values()];
    for (const [mesh, places, size] of [
      [this.#corners, kCorners, kCorner],
      [this.#knobs, kEdges, kKnob],
    ] as const) {
      for (let i = 0; i < mesh.count; ++i) {
        const isLit = lit.some((one) => one.mesh === mesh && one.index === i);
        mesh.setColorAt(i, isLit ? (this.#held ? kHeld : kMet) : kPlain);
        this.#size.setScalar((isLit ? kGrown * size : size) / scale);
        this.#put(mesh, i, places[i]!);
      }
      mesh.instanceColor!.needsUpdate = mesh.instanceMatrix.needsUpdate = true;
      mesh.material.opacity = this.#opacity;
    }
    this.#lines.material.color.copy(this.#held ? kHeld : kPlain);
    this.#lines.material.opacity = 0.6 * this.#opacity;
  }
}

/** Whether it is met as corners and knobs of a box are. */
export function isHandle(object: Object3D): boolean {
  return object instanceof Instances;
}

/** Which of several things in one mesh an event is at. */
function instanceOf(event: PointerEvent | undefined): number | undefined {
  return event?.instanceId;
}
