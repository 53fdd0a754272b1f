import type { FontFamilies } from "@pmndrs/uikit";
import { computed, type ReadonlySignal } from "@preact/signals-core";
import type { Vector3 } from "three";

import { kOverCase } from "../../render/draw_order";
import { texts } from "../../text/text";
import type { Message, Trouble } from "../../ui/message";
import { Board } from "./board";
import { button, column, label, row, when } from "./widgets";

/** m a px. */
const kPixel = 0.00075;
const kWidth = 400; // px
/** Where a finger reaches it: from the eyes towards the case, m. */
const kAway = 0.55;
/** What is met first, where a hand points at several things. */
const kOrder = 4;

/** What went wrong, before the eyes until it is tried again or dismissed, wherever the panel is. */
export class TroubleBoard {
  readonly board: Board;
  readonly #trouble: ReadonlySignal<Trouble | null>;

  /** `families` are those that a text is drawn with. */
  constructor(message: Message, families: (text: string) => FontFamilies) {
    this.#trouble = message.trouble;
    const text = computed(() => message.trouble.value?.text ?? "");
    const over = { depthTest: false, renderOrder: kOverCase + 2 };
    const t = texts().page;
    const again = button(t.again, () => {
      const act = message.trouble.peek()?.again;
      message.dismiss();
      act?.();
    });
    const root = column(
      {
        pixelSize: kPixel,
        width: kWidth,
        padding: 16,
        gap: 14,
        borderRadius: 16,
        backgroundColor: "#14171c",
        borderWidth: 2,
        borderColor: "#ffb3a6",
        fontFamilies: computed(() => families(text.value)),
        anchorX: "center",
        anchorY: "center",
        ...over,
        "*": { pointerEventsOrder: kOrder, ...over },
      },
      label(text, { size: 19, color: "#ffb3a6" }),
      row(
        when(
          computed(() => (message.trouble.value?.again ?? null) !== null),
          again,
        ),
        button(t.dismiss, () => message.dismiss()),
      ),
    );
    this.board = new Board(root, true);
  }

  /** Before a frame. It stays where it was put: between the eyes and where the case stood. */
  update(place: Vector3, eye: Vector3, delta: number): void {
    const isShown = this.#trouble.peek() !== null;
    if (isShown && !this.board.isShown) {
      this.board.putBefore(eye, place, kAway);
    }
    this.board.show(isShown);
    this.board.update(delta);
  }
}
