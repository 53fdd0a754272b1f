import { batch, computed, signal } from "@preact/signals-core";
import { type Ray, Vector3 } from "three";

import { type Plane, signedDistance } from "./geometry";
import { isFlat, isShape, kMostCorners, kPointsOf, type MarkKind, type MarkShape } from "./marks";

/** Points that are nearer to each other make no mark, mm. */
const kLeastLength = 0.05;
/** Of an outline's size: so near to its first corner it is closed. */
const kClosing = 0.08;

/** What a point is put onto: a face of the cut, where there is one. */
export interface Touched {
  point: Vector3;
  /** Of the face. */
  plane: Plane | null;
}

/**
 * Takes points one after the other until they make a mark of the kind that is wanted. `add` is given what was made and
 * says whether there was something to mark.
 */
export class Marking {
  readonly #add: (shape: MarkShape) => boolean;
  readonly #kind = signal<MarkKind | null>(null);
  readonly #points = signal<readonly Vector3[]>([]);
  #plane: Plane | null = null; // of what is begun

  constructor(add: (shape: MarkShape) => boolean) {
    this.#add = add;
  }

  /** What the next point is for; null: nothing. */
  get kind(): MarkKind | null {
    return this.#kind.value;
  }

  /** Of what is begun. */
  get points(): readonly Vector3[] {
    return this.#points.value;
  }

  /** What is wanted; the same once more, or null: nothing. What was begun is called off. */
  toggle(kind: MarkKind | null): void {
    this.#begin(kind === this.#kind.peek() ? null : kind);
  }

  /** Marks a point as what is wanted, or else begins `otherwise`. Returns whether it was taken. */
  put(touched: Touched, otherwise: MarkKind = "point"): boolean {
    const kind = this.#kind.peek();
    if (kind !== null) {
      return this.#take(kind, touched);
    }
    this.#begin(otherwise);
    const taken = this.#take(otherwise, touched);
    if (!taken) {
      this.#begin(null);
    }
    return taken;
  }

  #take(kind: MarkKind, touched: Touched): boolean {
    const before = this.#points.peek();
    if (before.length === 0) {
      this.#plane = touched.plane;
    }
    const point = this.#onPlane(kind, touched.point);
    if (this.#closes(kind, point)) {
      return this.finish();
    }
    if (before.some((other) => other.distanceTo(point) < kLeastLength)) {
      return false;
    }
    const points = [...before, point];
    if (kind === "outline" || points.length < kPointsOf[kind]) {
      this.#points.value = points.slice(0, kMostCorners);
      return true;
    }
    return this.#end(kind, points);
  }

  /** Ends an outline, which may have any number of corners. Returns whether there was one to end. */
  finish(): boolean {
    const kind = this.#kind.peek();
    return kind === "outline" && this.#end(kind, this.#points.peek());
  }

  /** What the mark would be if `point` were its next one; null: nothing is begun. */
  preview(point: Vector3 | null): MarkShape | null {
    const kind = this.#kind.value;
    const points = this.#points.value;
    if (kind === null || points.length === 0) {
      return null;
    }
    const next = point && this.#onPlane(kind, point);
    const all = next ? [...points, next] : points;
    return all.length > 1 ? { kind, points: all, normal: this.#normal(kind) } : null;
  }

  /** Where a ray (RAS mm) meets the plane that what is begun lies in; null: it does not, or lies in none. */
  meet(ray: Ray): Vector3 | null {
    const kind = this.#kind.peek();
    if (!this.#plane || this.#points.peek().length === 0 || !isFlat(kind)) {
      return null;
    }
    const distance = -signedDistance(this.#plane, ray.origin) / this.#plane.normal.dot(ray.direction);
    return distance > 0 ? ray.at(distance, new Vector3()) : null;
  }

  readonly isBegun = computed(() => this.#points.value.length > 0);

  #begin(kind: MarkKind | null): void {
    batch(() => {
      this.#kind.value = kind;
      this.#points.value = [];
      this.#plane = null;
    });
  }

  #end(kind: MarkKind, points: readonly Vector3[]): boolean {
    const shape = { kind, points, normal: this.#normal(kind) };
    if (!isShape(shape) || !this.#add(shape)) {
      return false;
    }
    this.#begin(null);
    return true;
  }

  /** Regions and outlines are flat. */
  #normal(kind: MarkKind): Vector3 | null {
    return isFlat(kind) ? (this.#plane?.normal ?? null) : null;
  }

  #onPlane(kind: MarkKind, point: Vector3): Vector3 {
    const plane = isFlat(kind) ? this.#plane : null;
    return plane ? point.clone().addScaledVector(plane.normal, -signedDistance(plane, point)) : point;
  }

  /** Whether a point is an outline's first one again. */
  #closes(kind: MarkKind, point: Vector3): boolean {
    const points = this.#points.peek();
    const [first] = points;
    if (kind !== "outline" || points.length < kPointsOf.outline) {
      return false;
    }
    const around = Math.max(...points.map((one) => one.distanceTo(first!)));
    return point.distanceTo(first!) < kClosing * around;
  }
}
