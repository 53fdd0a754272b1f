import type { FontFamilies } from "@pmndrs/uikit";
import { Vector3 } from "three";

import type { Hand } from "../hand";
import { kBesideCase } from "../../render/draw_order";
import { Board } from "./board";
import { button, column, row } from "./widgets";

/** m a px. */
const kPixel = 0.0006;
const kWidth = 200; // px
/** It is shown while the palm is turned to the eyes: the cosine between them, to come and to go. */
const kCome = 0.75;
const kGo = 0.55;
/** Of its middle from the wrist: beside the little finger, and towards the fingers, m. */
const kBeside = 0.13;
const kAhead = 0.07;
const kOrder = 3;

/** What a button of it says, and does. */
export type PalmAction = readonly [text: string, press: () => void];

/** Whose palm it is. */
export type PalmHand = Pick<Hand, "source" | "wrist" | "isPressing" | "offering">;

/** Buttons beside a bare hand's palm, for the other hand's finger. */
export class PalmMenu {
  readonly board: Board;
  readonly #hand: PalmHand;
  readonly #palm = new Vector3(); // scratch
  readonly #toEye = new Vector3();

  constructor(hand: PalmHand, fontFamilies: FontFamilies, actions: readonly PalmAction[]) {
    this.#hand = hand;
    const buttons = actions.map(([text, press]) => button(text, press, { height: 56 }));
    const root = column(
      {
        pixelSize: kPixel,
        width: kWidth,
        padding: 8,
        gap: 6,
        borderRadius: 14,
        backgroundColor: "#14171c",
        fontFamilies,
        anchorX: "center",
        anchorY: "center",
        renderOrder: kBesideCase,
        "*": { pointerEventsOrder: kOrder, renderOrder: kBesideCase },
      },
      ...buttons.flatMap((one, i) => (i % 2 === 0 ? [row(one, ...buttons.slice(i + 1, i + 2))] : [])),
    );
    this.board = new Board(root, true);
  }

  /** Before a frame, seen from `eye` in the room. */
  update(eye: Vector3, delta: number): void {
    const { position, quaternion, visible } = this.#hand.wrist;
    const facing = this.#palm
      .set(0, -1, 0)
      .applyQuaternion(quaternion)
      .dot(this.#toEye.copy(eye).sub(position).normalize());
    const { board } = this;
    const isTurned = visible && facing > (board.isShown ? kGo : kCome);
    // What is held and turned is looked at, not the menu.
    board.show(isTurned && (this.#hand.offering || !this.#hand.isPressing));
    this.#hand.offering = board.isShown;
    if (board.isShown) {
      const beside = this.#hand.source?.handedness === "left" ? -kBeside : kBeside;
      board.object.position.set(beside, 0, -kAhead).applyQuaternion(quaternion).add(position);
      board.object.lookAt(eye);
    }
    board.update(delta);
  }
}
