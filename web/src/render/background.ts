import { MathUtils, Vector3, type WebGLRenderer } from "three";

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

/** Where the glow ends, in sizes of the canvas, and how finely it is painted. */
const kGlowReach = 0.78;
const kGlowStops = 32;

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

  /** Behind what is drawn of a picture: what the canvas has behind the case. */
  paint(context: CanvasRenderingContext2D, width: number, height: number, chosen: string | null): void {
    const css = (color: Vector3) => `rgb(${color.toArray().map((part) => 255 * part)})`;
    const backdrop = kBackdrops.get(chosen ?? (this.glow === null ? "black" : ""));
    context.save();
    context.globalCompositeOperation = "destination-over";
    if (backdrop) {
      const gradient = context.createLinearGradient(0, 0, 0, height);
      gradient.addColorStop(0, css(new Vector3(...backdrop.top)));
      gradient.addColorStop(1, css(new Vector3(...backdrop.bottom)));
      context.fillStyle = gradient;
      context.fillRect(0, 0, width, height);
    } else {
      // As backdropAt() of shaders/depth_cue.glsl has it.
      const { inner, middle, outer } = kGlows[this.glow!];
      const gradient = context.createRadialGradient(0, 0, 0, 0, 0, 1);
      for (let r = 0; r <= 1; r += 1 / kGlowStops) {
        const color = inner.clone().lerp(middle, MathUtils.smoothstep(r, 0, 0.5));
        gradient.addColorStop(r, css(color.lerp(outer, MathUtils.smoothstep(r, 0.4, 1))));
      }
      context.translate(0.5 * width, 0.5 * height);
      context.scale(kGlowReach * width, kGlowReach * height);
      context.fillStyle = gradient;
      context.fillRect(-1, -1, 2, 2);
    }
    context.restore();
  }

  dispose(): void {
    this.#gradient.dispose();
  }
}
