import type { Fail } from "../host";
import { CaseError } from "../sog/zip";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { drawCaption } from "./caption";
import { download } from "./download";
import type { MarkTexts } from "./marks_overlay";

/** A picture that somebody wants otherwise than it is seen. */
export interface WantedPicture {
  width: number; // px
  height: number;
  transparent: boolean;
  labels: boolean; // what stands over it: marks, directions, the title, what it is not for
}

/** What browsers make canvases of. */
const kLargestSide = 16384;
const kMostPixels = 1e8;

/** Pictures of what is shown, in the colours of the page. */
export class Pictures {
  readonly #viewer: Viewer;
  readonly #root: HTMLElement;
  readonly #said: MarkTexts;
  readonly #fail: Fail;

  constructor(viewer: Viewer, root: HTMLElement, said: MarkTexts, fail: Fail) {
    this.#viewer = viewer;
    this.#root = root;
    this.#said = said;
    this.#fail = fail;
  }

  /** Saves it as it is seen. */
  async save(): Promise<void> {
    const name = this.#fileName; // of the case that is pictured
    try {
      const picture = await pngOf(await this.#viewer.captures.snapshot((drawn) => this.#caption(drawn)));
      if (picture) {
        download(picture, name);
      }
    } catch (error) {
      this.#fail((error as CaseError).message, () => void this.save());
    }
  }

  /** Saves it otherwise than it is seen. Rejects with CaseError. */
  async saveAs(wanted: WantedPicture): Promise<void> {
    download(await this.take(wanted), this.#fileName);
  }

  /** As a PNG of another size, transparent, or without labels. Rejects with CaseError. */
  async take({ width, height, transparent, labels }: WantedPicture): Promise<Blob> {
    const isSide = (side: number) => Number.isInteger(side) && side >= 16 && side <= kLargestSide;
    if (!isSide(width) || !isSide(height) || width * height > kMostPixels) {
      throw new CaseError(texts().picture.tooLarge(kLargestSide, kMostPixels / 1e6));
    }
    const label = labels ? (over: HTMLCanvasElement) => this.#caption(over) : () => {};
    const picture = await pngOf(await this.#viewer.captures.paint(width, height, transparent, label));
    if (!picture) {
      throw new CaseError(texts().picture.tooLargeHere);
    }
    return picture;
  }

  #caption(picture: HTMLCanvasElement): void {
    drawCaption(picture, this.#viewer, this.#root, this.#said);
  }

  get #fileName(): string {
    return `${this.#viewer.caseName ?? "clipgs"}.png`;
  }
}

/** Null where the browser cannot. */
function pngOf(picture: HTMLCanvasElement): Promise<Blob | null> {
  return new Promise((resolve) => picture.toBlob(resolve, "image/png"));
}
