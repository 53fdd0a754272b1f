import type { Container, FontFamilies } from "@pmndrs/uikit";
import { computed, signal } from "@preact/signals-core";
import { type Object3D, Vector3 } from "three";

import { button, column } from "./widgets";

/** Above the back of the hand, m. */
const kAbove = 0.05;
/** It is shown while the back of the hand is turned to the eyes: the cosine between them. */
const kFacing = 0.6;

/** A button on a bare hand's wrist, as a watch is worn: the other hand presses it. */
export class WristButton {
  readonly #wrist: Object3D;
  readonly #root: Container;
  readonly #shown = signal(false);
  readonly #back = new Vector3();
  readonly #eye = new Vector3();

  constructor(wrist: Object3D, text: string, fontFamilies: FontFamilies, press: () => void) {
    this.#wrist = wrist;
    this.#root = column(
      {
        pixelSize: 0.0006,
        width: 110,
        fontFamilies,
        anchorX: "center",
        anchorY: "center",
        display: computed(() => (this.#shown.value ? "flex" : "none")),
        "*": { pointerEventsOrder: 3 },
      },
      button(text, press),
    );
    this.#root.position.y = kAbove;
    this.#root.rotation.set(-Math.PI / 2, 0, 0); // faces along the wrist's y
    wrist.add(this.#root);
  }

  /** Before a frame, seen from `eye` in the room. */
  update(eye: Vector3, delta: number): void {
    this.#eye.copy(eye).sub(this.#wrist.position).normalize();
    this.#back.set(0, 1, 0).applyQuaternion(this.#wrist.quaternion);
    this.#shown.value = this.#wrist.visible && this.#back.dot(this.#eye) > kFacing;
    this.#wrist.intersectChildren = this.#shown.value;
    this.#root.update(delta);
  }

  dispose(): void {
    this.#root.dispose();
  }
}
