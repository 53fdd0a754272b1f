import { Vector3, type WebGLRenderer } from "three";

import { kBackdrops } from "../model/backdrop";
import type { Inset } from "../model/view";
import { makeBackdrop } from "./depth_cue";
import { FullScreenPass } from "./full_screen";

/** Where none is chosen, display sRGB: a quiet glow, from its middle outwards. */
const kGlows = {
  dark: {
    inner: new Vector3(0.14, 0.175, 0.222),
    middle: new Vector3(0.078, 0.1, 0.131),
    outer: new Vector3(0.043, 0.055, 0.075),
  },
  light: {
    inner: new Vector3(0.965, 0.975, 0.985),
    middle: new Vector3(0.9, 0.918, 0.937),
    outer: new Vector3(0.82, 0.843, 0.87),
  },
};

/** What lies behind a case on the canvas. */
export class Background {
  /** Where none of kBackdrops is chosen; null: black. */
  glow: keyof typeof kGlows | null = "dark";
  /** As it was placed last. */
  readonly shown = makeBackdrop();
  readonly #gradient = new FullScreenPass("background.frag.glsl", { uBackdrop: { value: this.shown } });

  /** One of kBackdrops, or the glow: where that is follows the canvas and its panels. */
  place(renderer: WebGLRenderer, chosen: string | null, { right, bottom }: Inset): void {
    const { size, center, inner, middle, outer } = this.shown;
    const backdrop = kBackdrops.get(chosen ?? (this.glow === null ? "black" : ""));
    this.shown.isGlow = !backdrop;
    if (backdrop) {
      inner.set(...backdrop.top);
      outer.set(...backdrop.bottom);
    } else {
      const glow = kGlows[this.glow!];
      inner.copy(glow.inner);
      middle.copy(glow.middle);
      outer.copy(glow.outer);
    }
    renderer.getDrawingBufferSize(size);
    const ratio = renderer.getPixelRatio();
    center.set(size.x - ratio * right, size.y + ratio * bottom).multiplyScalar(0.5);
  }

  /** Onto the canvas. */
  draw(renderer: WebGLRenderer): void {
    this.#gradient.render(renderer, null);
  }

  dispose(): void {
    this.#gradient.dispose();
  }
}
