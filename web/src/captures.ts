import type { Picture } from "./api";
import type { ViewerState } from "./model/viewer_state";
import type { Frame } from "./render/canvas_camera";
import { kAtRest, kMoving, type OpenCase, type SortFrame } from "./render/open_case";
import { makeCanvas, type Painter } from "./render/painter";
import { tileCamera, tilesOf } from "./render/tiles";
import { CaseError } from "./sog/zip";
import type { CaseClient } from "./worker/case_client";

/** Why there is no picture, to whoever waited for it. */
const kNotPictured = "the case was closed, or a headset put on, before its picture was drawn; try again";

/** What pictures are taken of. */
export interface Studio {
  readonly painter: Painter;
  readonly state: ViewerState;
  readonly openCase: OpenCase | null;
  /** Whether a headset draws. */
  readonly isWorn: boolean;
  /** Has the splats of a case ordered. */
  order(current: OpenCase, frame: SortFrame): Promise<void>;
}

/** Pictures of what a viewer shows, of any size, drawn apart from those of the canvas. */
export class Captures {
  readonly #studio: Studio;
  readonly #client: CaseClient;
  readonly #ended: () => void;
  #taking: Promise<void> | null = null;
  #asOf: ViewerState | null = null;

  /** `ended` is called when the canvas is to be drawn again. */
  constructor(studio: Studio, client: CaseClient, ended: () => void) {
    this.#studio = studio;
    this.#client = client;
    this.#ended = ended;
  }

  /** What was, while a picture is drawn of that. */
  get asOf(): ViewerState | null {
    return this.#asOf;
  }

  /** Whether one is taken, and nothing else is drawn. */
  get isTaking(): boolean {
    return this.#taking !== null;
  }

  /**
   * Does `work` while nobody else sorts or takes pictures. It begins in the same turn as the last look at whether
   * somebody does: some browsers draw frames, which sort, between a promise's end and those who wait for it.
   */
  async alone<T>(work: () => Promise<T>): Promise<T> {
    while (this.#client.sorting || this.#taking) {
      await (this.#client.sorting ?? this.#taking);
    }
    const done = work();
    this.#taking = done.then(
      () => {},
      () => {},
    );
    try {
      return await done;
    } finally {
      this.#taking = null;
      this.#ended();
    }
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
    return this.#capture(
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
    return this.#capture(
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
    return this.#capture(
      current,
      () => painter.camera.frame,
      () => {
        painter.drawBody(current, kAtRest, 1, false);
        return copy();
      },
    );
  }

  /**
   * Sorts for a frame of a case, then calls `draw`: both in the state of now, whatever has changed meanwhile. What `draw`
   * looks at of the state, it looks at in the turn that it is called in. Rejects with CaseError.
   */
  async #capture<T>(current: OpenCase, frame: () => Frame, draw: () => T | Promise<T>): Promise<T> {
    const { painter, state } = this.#studio;
    return this.alone(async () => {
      await this.#inState(state, current, frame, ({ width, height }) =>
        this.#studio.order(current, { camera: painter.camera.camera, width, height, leastPixels: 0 }),
      );
      await current.light(state);
      return this.#inState(state, current, frame, draw);
    });
  }

  /** Does `work` as if the viewer were in that state, with the camera for a frame of `current`. Throws CaseError. */
  #inState<T>(state: ViewerState, current: OpenCase, frame: () => Frame, work: (frame: Frame) => T): T {
    const { openCase, painter, isWorn } = this.#studio;
    if (openCase !== current || isWorn) {
      throw new CaseError(kNotPictured);
    }
    this.#asOf = state;
    try {
      const wanted = frame();
      painter.camera.place(wanted);
      return work(wanted);
    } finally {
      this.#asOf = null;
    }
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
