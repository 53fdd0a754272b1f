import { abortableEffect, Container, type FontFamilies, Image } from "@pmndrs/uikit";
import { computed, type ReadonlySignal, signal } from "@preact/signals-core";
import { SRGBColorSpace, type Texture, TextureLoader, type Vector3 } from "three";

import { inShort } from "../../model/case_title";
import { formatBytes, type LoadingCase } from "../../model/case_list";
import { texts } from "../../text/text";
import { kOverCase } from "../../render/draw_order";
import { Board } from "./board";
import { column, each, kSmallFont, label, progressBar, row } from "./widgets";

/** m a px. */
const kPixel = 0.00075;
const kWidth = 330; // px
const kPicture = 84;
/** What is there sooner needs no word, ms. */
const kPatienceMs = 350;
/** From the eyes, m, and how far towards the case. */
const kAway = 0.6;
const kAbove = 0.05;

/** The case that is on its way, where it will stand: what it is called, how it looks, and how much of it is there. */
export class LoadingBoard {
  readonly board: Board;
  readonly #loading: ReadonlySignal<LoadingCase | null>;
  readonly #picture = signal<Texture | null>(null);
  #waited = 0;

  /** `families` are those that a text is drawn with. */
  constructor(loading: ReadonlySignal<LoadingCase | null>, families: (text: string) => FontFamilies) {
    this.#loading = loading;
    const title = computed(() => inShort(loading.value?.title ?? ""));
    const said = computed(() => {
      const { share = 0, bytes = 0 } = loading.value ?? {};
      const percent = Math.round(100 * share);
      return bytes > 0 ? texts().headset.loading(percent, formatBytes(bytes)) : `${percent} %`;
    });
    const over = { depthTest: false, renderOrder: kOverCase + 2 };
    const root = column(
      {
        pixelSize: kPixel,
        width: kWidth,
        padding: 14,
        borderRadius: 16,
        backgroundColor: "#14171c",
        fontFamilies: computed(() => families(title.value)),
        anchorX: "center",
        anchorY: "center",
        ...over,
        "*": over,
      },
      row(
        each(column({ flexShrink: 0 }), this.#picture, (picture) =>
          picture
            ? [
                new Container().add(
                  new Image({ src: picture, width: kPicture, height: kPicture, borderRadius: 8 }),
                ),
              ]
            : [],
        ),
        column(
          { flexGrow: 1, flexShrink: 1, justifyContent: "center", gap: 6 },
          label(title, { size: 20 }),
          label(said, { quiet: true, size: kSmallFont }),
        ),
      ),
      progressBar(computed(() => loading.value?.share ?? 0)),
    );
    const url = computed(() => loading.value?.thumbnail ?? null);
    abortableEffect(() => void this.#show(url.value), root.abortSignal);
    this.board = new Board(root, false);
  }

  /** Before a frame, between the eyes and where the case stands, or will. */
  update(place: Vector3, eye: Vector3, delta: number): void {
    this.#waited = this.#loading.value ? this.#waited + delta : 0;
    this.board.show(this.#waited > kPatienceMs);
    if (this.board.isShown) {
      this.board.putBefore(eye, place, kAway, kAbove);
    }
    this.board.update(delta);
  }

  dispose(): void {
    this.board.dispose();
    this.#picture.peek()?.dispose();
  }

  async #show(url: string | null): Promise<void> {
    const before = this.#picture.peek();
    const picture = url ? await new TextureLoader().loadAsync(url).catch(() => null) : null;
    if (picture) {
      picture.colorSpace = SRGBColorSpace;
    }
    this.#picture.value = picture;
    before?.dispose();
  }
}
