import { createGrabPointer, type Pointer } from "@pmndrs/pointer-events";
import { Group, type Object3D, type PerspectiveCamera } from "three";

import type { Hand } from "./hand";

/** What a fingertip is over, m, and where it presses and lets go of that: nearer than a fingertip is thick. */
const kOver = 0.05;
const kPress = 0.008;
const kRelease = 0.014;
/** What is to be pressed has at least this order (panel/): neither planes nor cases are poked. */
const kLeastOrder = 2;

/** The tip of a finger, or of a controller, that presses buttons as one does on a wall. */
export class Poke {
  /** In the room, where the tip is. */
  readonly tip = new Group();
  readonly #pointer: Pointer;
  #pressing = false;
  #armed = false; // it was over something without touching it

  constructor(hand: Hand, camera: PerspectiveCamera) {
    this.#pointer = createGrabPointer(
      () => camera,
      { current: this.tip },
      hand,
      {
        radius: kOver,
        clickThresholdMs: Infinity,
        filter: (object, _events, _type, order) =>
          order >= kLeastOrder && object.matrixWorld.determinant() !== 0,
      },
      "touch",
    );
  }

  /** Whether it presses something now. */
  get isPressing(): boolean {
    return this.#pressing;
  }

  /** After the tip has moved, or is there no more. */
  update(scene: Object3D, timeStamp: number, isThere: boolean): void {
    if (!isThere) {
      this.cancel(timeStamp);
      return;
    }
    this.#pointer.move(scene, { timeStamp });
    const met = this.#pointer.getIntersection();
    const isMet = met !== undefined && !(met.object as { isVoidObject?: boolean }).isVoidObject;
    const distance = isMet ? met.distance : Infinity;
    if (!this.#pressing && this.#armed && distance < kPress) {
      this.#pressing = true;
      this.#pointer.down({ timeStamp, button: 0 });
    } else if (this.#pressing && distance > kRelease) {
      this.#pressing = false;
      this.#pointer.up({ timeStamp, button: 0 });
    }
    // One that comes from behind, or through something else, presses nothing.
    this.#armed = this.#pressing || (isMet && distance >= kPress);
  }

  /** Nothing is pressed, nor will it be. */
  cancel(timeStamp: number): void {
    if (this.#pressing) {
      this.#pointer.cancel({ timeStamp });
    }
    this.#pressing = this.#armed = false;
    this.#pointer.exit({ timeStamp });
  }
}
