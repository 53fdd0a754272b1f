import { readFileSync } from "node:fs";
import type { Page } from "playwright-core";

export interface Picture {
  width: number;
  height: number;
  data: Uint8Array; // RGBA
}

/** An RGBA PNG, decoded by the page itself without touching its colours. */
export async function readPng(page: Page, path: string): Promise<Picture> {
  const base64 = readFileSync(path).toString("base64");
  const { width, height, data } = await page.evaluate(async (text) => {
    const blob = new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], { type: "image/png" });
    const bitmap = await createImageBitmap(blob, { premultiplyAlpha: "none", colorSpaceConversion: "none" });
    const gl = new OffscreenCanvas(1, 1).getContext("webgl2")!;
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(
      gl.FRAMEBUFFER,
      gl.COLOR_ATTACHMENT0,
      gl.TEXTURE_2D,
      gl.getParameter(gl.TEXTURE_BINDING_2D) as WebGLTexture,
      0,
    );
    const pixels = new Uint8Array(bitmap.width * bitmap.height * 4);
    gl.readPixels(0, 0, bitmap.width, bitmap.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return { width: bitmap.width, height: bitmap.height, data: Array.from(pixels) };
  }, base64);
  return { width, height, data: Uint8Array.from(data) };
}

/** What `window.clipgs.renderToPixels` gives. */
export async function pagePicture(page: Page, width: number, height: number): Promise<Picture> {
  const data = await page.evaluate(
    async ([w, h]) => Array.from((await window.clipgs.renderToPixels(w!, h!)).data),
    [width, height],
  );
  return { width, height, data: Uint8Array.from(data) };
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
