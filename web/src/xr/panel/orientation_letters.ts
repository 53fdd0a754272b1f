import type { FontFamilies } from "@pmndrs/uikit";
import { Group, type Matrix4, Vector3 } from "three";

import type { Box } from "../../model/geometry";
import { directionLetters } from "../../model/values";
import { Tag } from "./tag";

/** Beside the box, in its largest extents. */
const kBeside = 0.08;

/** R, L, A, P, S and I where the patient's sides are, in the room. */
export class OrientationLetters {
  readonly object = new Group();
  readonly #tags: Tag[];
  readonly #sides: Vector3[]; // RAS
  readonly #place = new Vector3();

  constructor(fontFamilies: FontFamilies) {
    this.#sides = [0, 1, 2].flatMap((axis) => [1, -1].map((sign) => new Vector3().setComponent(axis, sign)));
    this.#tags = this.#sides.map((side) => {
      const tag = new Tag(fontFamilies, "at", undefined, false);
      tag.text.value = directionLetters(side);
      return tag;
    });
    this.object.add(...this.#tags.map((tag) => tag.object));
  }

  /** Before a frame, around a case's bounds (RAS mm). */
  update({ min, max }: Box, roomFromPatient: Matrix4, eye: Vector3, delta: number): void {
    const beside = kBeside * Math.max(max.x - min.x, max.y - min.y, max.z - min.z);
    this.#sides.forEach((side, i) => {
      const place = this.#place.addVectors(min, max).multiplyScalar(0.5);
      const axis = i >> 1;
      const end = side.getComponent(axis) > 0 ? max : min;
      place.setComponent(axis, end.getComponent(axis)).addScaledVector(side, beside);
      this.#tags[i]!.place(place.applyMatrix4(roomFromPatient), eye, delta);
    });
  }

  /** Where a letter stands, in the room; null: it does not. */
  find(text: string): Vector3 | null {
    const tag = this.object.visible && this.#tags.find((one) => one.text.value === text);
    return tag ? tag.object.position.clone() : null;
  }

  dispose(): void {
    this.#tags.forEach((tag) => tag.dispose());
  }
}
