import { Vector3 } from "three";

import { type Plane, signedDistance } from "../model/geometry";
import { errorFrom, type Target } from "./plan";

/** A movement that begins so long after the last one is another. */
const kRestMs = 400;
const kDegrees = 180 / Math.PI;

/** Times between frames. */
export class FrameTimes {
  readonly #times: number[] = [];
  #last: number | null = null;

  /** A frame is shown at `now`, ms. */
  count(now: number): void {
    if (this.#last !== null && now > this.#last) {
      this.#times.push(now - this.#last);
    }
    this.#last = now;
  }

  /** Of a display of so many Hz; null: as often as most frames came. */
  summary(displayHz: number | null): {
    frames: number;
    frame_ms: number | null;
    low_fps: number | null;
    dropped: number | null;
  } {
    const times = [...this.#times].sort((a, b) => a - b);
    const frames = times.length;
    if (frames === 0) {
      return { frames, frame_ms: null, low_fps: null, dropped: null };
    }
    const mean = (list: number[]) => list.reduce((sum, ms) => sum + ms, 0) / list.length;
    const period = displayHz ? 1000 / displayHz : times[Math.floor(frames / 2)]!;
    const dropped = times.reduce((sum, ms) => sum + Math.max(0, Math.round(ms / period) - 1), 0);
    return {
      frames,
      frame_ms: rounded(mean(times), 2),
      low_fps: rounded(1000 / mean(times.slice(-Math.ceil(frames / 100))), 1),
      dropped,
    };
  }
}

/** How far something goes and turns. */
class Path {
  length = 0;
  turned = 0;
  readonly #at = new Vector3();
  readonly #direction = new Vector3();
  #begun = false;

  go(at: Vector3, direction: Vector3): void {
    if (this.#begun) {
      this.length += at.distanceTo(this.#at);
      this.turned += kDegrees * this.#direction.angleTo(direction);
    }
    this.#begun = true;
    this.#at.copy(at);
    this.#direction.copy(direction);
  }

  get begun(): boolean {
    return this.#begun;
  }
}

/** What is measured of a task. */
export class TaskMeasures {
  readonly frames = new FrameTimes();
  readonly #target: Target;
  readonly #center: Vector3;
  readonly #begin: number;
  readonly #head = new Path();
  #travel = 0;
  #rotation = 0;
  #plane: Plane | null = null;
  #moved = -Infinity;
  #movements = 0;
  #held = false;
  #grasps: number | null = null; // null: nothing can be held

  /** `center`: of the case, RAS mm. */
  constructor(target: Target, center: Vector3, now: number) {
    this.#target = target;
    this.#center = center;
    this.#begin = now;
  }

  /** The plane is there now. It travels by what moves at the case's middle. */
  plane(plane: Plane | null, now: number): void {
    const before = this.#plane;
    this.#plane = plane && { normal: plane.normal.clone(), offset: plane.offset };
    if (!plane || !before) {
      return;
    }
    const way = Math.abs(signedDistance(plane, this.#center) - signedDistance(before, this.#center));
    const angle = kDegrees * before.normal.angleTo(plane.normal);
    if (way > 0 || angle > 0) {
      this.#travel += way;
      this.#rotation += angle;
      this.#movements += now - this.#moved > kRestMs ? 1 : 0;
      this.#moved = now;
    }
  }

  /** Whether a hand holds the plane; never called at the desk. */
  holds(held: boolean): void {
    this.#grasps = (this.#grasps ?? 0) + (held && !this.#held ? 1 : 0);
    this.#held = held;
  }

  /** Where the head is, m, and where it looks. */
  head(position: Vector3, forward: Vector3): void {
    this.#head.go(position, forward);
  }

  seconds(now: number): number {
    return (now - this.#begin) / 1000;
  }

  /** As records have them (src/study/records.h). */
  summary(now: number, displayHz: number | null) {
    const error = this.#plane && errorFrom(this.#target, this.#plane, this.#center);
    const grasps = this.#grasps ?? this.#movements;
    return {
      seconds: rounded(this.seconds(now), 3),
      travel_mm: rounded(this.#travel, 2),
      rotation_deg: rounded(this.#rotation, 2),
      head_mm: this.#head.begun ? rounded(1000 * this.#head.length, 1) : null,
      head_deg: this.#head.begun ? rounded(this.#head.turned, 1) : null,
      angle_deg: error?.angle == null ? null : rounded(error.angle, 3),
      distance_mm: error ? rounded(error.distance, 3) : null,
      regrasps: Math.max(0, grasps - 1),
      ...this.frames.summary(displayHz),
      display_hz: displayHz,
    };
  }
}

function rounded(value: number, digits: number): number {
  return Number(value.toFixed(digits));
}
