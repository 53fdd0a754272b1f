import { readFileSync } from "node:fs";
import { PNG } from "pngjs";

import type { Evaluates } from "./tab";

export interface Picture {
  width: number;
  height: number;
  data: Uint8Array; // RGBA
}

export function readPng(path: string): Picture {
  return decodePng(readFileSync(path));
}

export function decodePng(bytes: Buffer): Picture {
  const { width, height, data } = PNG.sync.read(bytes);
  return { width, height, data };
}

/** What `window.clipgs.renderToPixels` gives. */
export async function pagePicture(
  page: Evaluates,
  width: number,
  height: number,
  moving = false,
): Promise<Picture> {
  const bytes = await page.evaluate(
    async ([w, h, m]: readonly [number, number, boolean]) => {
      const { data } = await window.clipgs.renderToPixels(w, h, m);
      return btoa(Array.from(data, (byte) => String.fromCharCode(byte)).join(""));
    },
    [width, height, moving] as const,
  );
  return { width, height, data: ofPage(bytes) };
}

/** Bytes that a page gave in base 64: arrays of numbers are slow to get out of it. */
export function ofPage(bytes: string): Uint8Array {
  return Uint8Array.from(Buffer.from(bytes, "base64"));
}

/** dB over RGB on black, and over alpha. */
export function psnr(a: Picture, b: Picture): { color: number; alpha: number } {
  let color = 0;
  let alpha = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    for (let c = 0; c < 3; ++c) {
      color += ((a.data[i + c]! * a.data[i + 3]! - b.data[i + c]! * b.data[i + 3]!) / 65025) ** 2;
    }
    alpha += ((a.data[i + 3]! - b.data[i + 3]!) / 255) ** 2;
  }
  const pixels = a.data.length / 4;
  return { color: -10 * Math.log10(color / (3 * pixels)), alpha: -10 * Math.log10(alpha / pixels) };
}

/** Share of pixels that show anything. */
export function coverage(picture: Picture): number {
  let covered = 0;
  for (let i = 3; i < picture.data.length; i += 4) {
    covered += picture.data[i]! > 25 ? 1 : 0;
  }
  return covered / (picture.width * picture.height);
}
