import type { FaceEffort } from "../model/face_style";
import { kMoving } from "../render/open_case";

/** What a frame may cost: less of it looks worse. */
export interface Effort extends FaceEffort {
  /** Of the picture's width and height that the headset recommends. */
  scale: number;
  /** Standard deviations that splats are drawn to, at most. */
  extent: number;
  /** Splats that reach no farther than this, px, are left out. */
  leastPixels: number;
}

const kAll: Effort = { ...kMoving, scale: 1, extent: Infinity, leastPixels: 0, walls: "fine" };
const kOutlined: Effort = { ...kAll, walls: "coarse", rays: 1, detail: "outline" };
const kSplats: Effort = { ...kOutlined, walls: "least", detail: "splats" };
/** √5 σ leaves 92 % of a splat's light. */
const kShort = Math.sqrt(5);

/**
 * From all to the least: first what is seen least of walls is given up, then the surface and every other ray, pixels, and
 * outlines, then splats become smaller and fewer.
 */
const kEfforts: readonly Effort[] = [
  kAll,
  { ...kAll, walls: "coarse" },
  kOutlined,
  { ...kOutlined, scale: 0.9 },
  { ...kOutlined, scale: 0.8 },
  { ...kSplats, scale: 0.8 },
  { ...kSplats, scale: 0.8, extent: 2.7 },
  { ...kSplats, scale: 0.7, extent: kShort },
  { ...kSplats, scale: 0.7, extent: kShort, leastPixels: 1 },
  { ...kSplats, scale: 0.6, extent: kShort, leastPixels: 2 },
  { ...kSplats, scale: 0.5, extent: kShort, leastPixels: 3 },
];

/** Of a frame's time: one that takes longer came late. */
const kLate = 1.4;
/** So many late ones of so many are too many. */
const kManyLate = 4;
const kFrames = 18;
/** Without a late frame for so long, more is tried; twice as long after each time that it was too much. */
const kCalmMs = 2000;
const kLongestCalmMs = 60_000;
/** A pause between frames that says nothing about them: the headset was put down, or a case was opened. */
const kPauseMs = 1000;

/** Holds the headset's frame rate: gives up what is seen least when frames come late, and takes it back. */
export class Governor {
  /** Whether it acts. */
  enabled = true;
  #level = 0;
  #time = NaN;
  #frames = 0;
  #late = 0;
  #calmMs = 0;
  #patienceMs = kCalmMs;
  #raised = false; // last, and not yet found to be too much

  get effort(): Effort {
    return kEfforts[this.enabled ? this.#level : 0]!;
  }

  /** Whether all is drawn. */
  get relaxed(): boolean {
    return this.effort === kAll;
  }

  /** A frame begins at `now` ms, of a headset that shows one every `targetMs`. */
  count(now: number, targetMs: number): void {
    const elapsed = now - this.#time;
    this.#time = now;
    if (!(elapsed < kPauseMs)) {
      this.#frames = this.#late = this.#calmMs = 0;
      return;
    }
    const late = elapsed > kLate * targetMs;
    this.#late += late ? 1 : 0;
    this.#calmMs = late ? 0 : this.#calmMs + elapsed;
    const tooMany = this.#late >= kManyLate;
    if (tooMany) {
      this.#lower();
    }
    if (tooMany || ++this.#frames >= kFrames) {
      this.#frames = this.#late = 0;
    }
    if (this.#calmMs > this.#patienceMs) {
      this.#raise();
    }
  }

  #lower(): void {
    if (this.#raised) {
      this.#patienceMs = Math.min(2 * this.#patienceMs, kLongestCalmMs);
    }
    this.#raised = false;
    this.#calmMs = 0;
    this.#level = Math.min(this.#level + 1, kEfforts.length - 1);
  }

  #raise(): void {
    if (this.#raised) {
      this.#patienceMs = kCalmMs; // it was not too much
    }
    this.#calmMs = 0;
    this.#raised = this.#level > 0;
    this.#level = Math.max(0, this.#level - 1);
  }
}
