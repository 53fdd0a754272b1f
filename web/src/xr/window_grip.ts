import { Vector3 } from "three";

import { draggedWindow } from "../model/grey";
import type { Viewer } from "../viewer";
import type { Hand } from "./hand";

/** Of a drag on the page (px), what a hand's movement by a m is, and a second of a stick. */
const kPerMetre = 1500;
const kPerSecond = 220;

/** The window of grey values in a hand: to the right wider, upwards higher, as on the page. */
export class WindowGrip {
  /** Whether faces are pressed, and sticks pushed, for it. */
  wanted = false;
  readonly #viewer: Viewer;
  #hand: Hand | null = null;
  readonly #last = new Vector3();
  readonly #moved = new Vector3(); // scratch
  readonly #right = new Vector3();

  constructor(viewer: Viewer) {
    this.#viewer = viewer;
  }

  /** Whether there is a window to change. */
  get enabled(): boolean {
    const { state, window, section } = this.#viewer;
    return this.wanted && section !== null && window !== null && state.grey > 0 && state.section === "volume";
  }

  /** A hand takes hold of it. */
  begin(hand: Hand): void {
    this.#hand = hand;
    hand.toRoom(this.#last.set(0, 0, 0));
    hand.pulse(0.6, 30);
  }

  /** Once a frame; `forward` is where the eyes look. */
  update(forward: Vector3): void {
    const hand = this.#hand;
    if (!hand?.isPressing || !this.enabled) {
      this.#hand = null;
      return;
    }
    hand.toRoom(this.#moved.set(0, 0, 0)).sub(this.#last);
    this.#last.add(this.#moved);
    this.#right.set(-forward.z, 0, forward.x).normalize();
    this.#drag(kPerMetre * this.#moved.dot(this.#right), -kPerMetre * this.#moved.y);
  }

  /** A stick is pushed for so long. */
  push({ right, forward }: Hand["stick"], seconds: number): void {
    if (right !== 0 || forward !== 0) {
      this.#drag(kPerSecond * seconds * right, -kPerSecond * seconds * forward);
    }
  }

  #drag(dx: number, dy: number): void {
    const { window, section, store } = this.#viewer;
    if (window && section) {
      store.setWindow(draggedWindow(window, dx, dy, section.curve));
    }
  }
}
