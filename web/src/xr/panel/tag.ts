import { type Container, type FontFamilies, Text } from "@pmndrs/uikit";
import { signal } from "@preact/signals-core";
import { Group, type Vector3 } from "three";

import { kBesideCase, kOverCase } from "../../render/draw_order";
import { column } from "./widgets";

/** Of what it is seen at: as large from near as from afar. */
const kPixel = 0.0011;
const kGap = 0.012;
const kAnchors = { above: "bottom", below: "top", at: "center" } as const;

/** A text in the room that faces the eyes, above, below or at its point; over everything, or not. */
export class Tag {
  readonly object = new Group();
  readonly text = signal("");
  readonly #root: Container;

  constructor(fontFamilies: FontFamilies, where: "above" | "below" | "at", fontSize = 16, isOver = true) {
    const drawn = { depthTest: !isOver, renderOrder: isOver ? kOverCase : kBesideCase };
    this.#root = column(
      {
        pixelSize: kPixel,
        paddingX: 8,
        paddingY: 4,
        borderRadius: 7,
        backgroundColor: "#14171c",
        fontFamilies,
        anchorX: "center",
        anchorY: kAnchors[where],
        ...drawn,
        "*": drawn,
      },
      new Text({ text: this.text, color: "#e4e7ec", fontSize }),
    );
    this.#root.position.y = { above: kGap, below: -kGap, at: 0 }[where];
    this.object.add(this.#root);
  }

  /** Stands at a point of the room, seen from `eye`. */
  place(point: Vector3, eye: Vector3, delta: number): void {
    this.object.position.copy(point);
    this.object.lookAt(eye);
    this.object.scale.setScalar(point.distanceTo(eye));
    this.#root.update(delta);
  }

  dispose(): void {
    this.object.removeFromParent();
    this.#root.dispose();
  }
}
