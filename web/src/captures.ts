import type { Picture } from "./api";
import type { ViewerState } from "./model/viewer_state";
import type { Frame } from "./render/canvas_camera";
import { kAtRest, kMoving, type OpenCase } from "./render/open_case";
import { makeCanvas, type Painter } from "./render/painter";
import { tileCamera, tilesOf } from "./render/tiles";
import { CaseError } from "./sog/zip";

/** Why there is no picture, to whoever waited for it. */
export const kNotPictured =
  "the case was closed, or a headset put on, before its picture was drawn; try again";

/** Who takes pictures. */
export interface Studio {
  readonly painter: Painter;
  readonly state: ViewerState;
  readonly openCase: OpenCase | null;
  /** Whether a headset draws. */
  readonly isWorn: boolean;
  /**
   * Orders and lights a case for a frame, then calls `draw`: both in the state of now, whatever has changed meanwhile.
   * What `draw` looks at of the state, it looks at in the turn that it is called in. Rejects with CaseError.
   */
  capture<T>(current: OpenCase, frame: () => Frame, draw: () => T | Promise<T>): Promise<T>;
}

/** Pictures of what a viewer shows, of any size, drawn apart from those of the canvas. */
export class Captures {
  readonly #studio: Studio;

  constructor(studio: Studio) {
    this.#studio = studio;
  }

  /**
   * The picture of exactly width × height px without the handle: as `clipgs render` writes it, or as it is drawn while
   * something moves.
   */
  async pixels(width: number, height: number, moving = false): Promise<Picture> {
    const { openCase: current, painter, isWorn } = this.#studio;
    if (!current || isWorn) {
      throw new Error(current ? "the case is in the headset; take it off first" : "no case is open");
    }
    const effort = moving ? kMoving : kAtRest;
    return this.#studio.capture(
      current,
      () => frameOf(width, height),
      () => {
        const { camera } = painter.camera;
        return painter.layer.read(painter.subject(current, effort, height), {
          camera,
          width,
          height,
          moving,
        });
      },
    );
  }

  /**
   * A picture of width × height px, without the handle: transparent, or over what lies behind the case. `label` draws over
   * it while the viewer is in the state that was, as if the canvas were of that form and no smaller than it is.
   */
  async paint(
    width: number,
    height: number,
    transparent: boolean,
    label: (over: HTMLCanvasElement) => void,
  ): Promise<HTMLCanvasElement> {
    const { openCase: current, painter, isWorn } = this.#studio;
    if (!current || isWorn) {
      throw new CaseError(kNotPictured);
    }
    const [picture, over] = [makeCanvas(width, height), makeCanvas(width, height)];
    return this.#studio.capture(
      current,
      () => frameOf(width, height),
      async () => {
        const subject = painter.subject(current, kAtRest, height);
        const camera = painter.camera.camera.clone();
        const { backdrop } = this.#studio.state;
        this.#labelAs(frameOf(width, height), () => label(over));
        const context = picture.getContext("2d")!;
        for (const tile of tilesOf(width, height)) {
          const { drawn } = tile;
          const part = tileCamera(camera, width, height, tile);
          const { data } = await painter.layer.read(subject, { ...drawn, camera: part, moving: false });
          const pixels = new ImageData(new Uint8ClampedArray(data), drawn.width, drawn.height);
          const [left, top] = [tile.x - drawn.x, tile.y - drawn.y];
          context.putImageData(pixels, drawn.x, drawn.y, left, top, tile.width, tile.height);
        }
        if (!transparent) {
          painter.background.paint(context, width, height, backdrop);
        }
        context.drawImage(over, 0, 0);
        return picture;
      },
    );
  }

  /**
   * What the canvas shows, handle and all, as good as it gets, without what panels cover of it. `finish` is called when
   * that is drawn, while the viewer is in the state that was.
   */
  async snapshot(finish: (picture: HTMLCanvasElement) => void): Promise<HTMLCanvasElement> {
    const { openCase: current, painter, isWorn } = this.#studio;
    const copy = (): HTMLCanvasElement => {
      const picture = painter.copy();
      finish(picture);
      return picture;
    };
    if (!current || isWorn) {
      return copy();
    }
    return this.#studio.capture(
      current,
      () => painter.camera.frame,
      () => {
        painter.drawBody(current, kAtRest, 1, false);
        return copy();
      },
    );
  }

  /** Does `work` as if the canvas were of that form. */
  #labelAs(frame: Frame, work: () => void): void {
    const { camera } = this.#studio.painter;
    const before = camera.frame;
    const { width, height } = camera.freeSize;
    const scale = Math.min(frame.width, frame.height) / Math.min(width, height);
    camera.frame = { ...frame, width: frame.width / scale, height: frame.height / scale };
    try {
      work();
    } finally {
      camera.frame = before;
    }
  }
}

/** All of a picture, which no panels cover. */
function frameOf(width: number, height: number): Frame {
  return { width, height, inset: { right: 0, bottom: 0 } };
}
