import type { Page } from "playwright-core";

/** For a page, before its own scripts: what it asks of the GPU for volumes is counted. */
export const kCountVolumes = {
  content: `window.volumes = { bytes: [], pieces: [] };
    const { prototype } = WebGL2RenderingContext;
    const { texStorage3D, texSubImage3D } = prototype;
    const kSizes = { 0x8229: 1, 0x8051: 3, 0x8058: 4, 0x822d: 2, 0x881a: 8 }; // R8, RGB8, RGBA8, R16F, RGBA16F
    prototype.texStorage3D = function (target, levels, format, w, h, d) {
      window.volumes.bytes.push(levels * kSizes[format] * w * h * d);
      return texStorage3D.apply(this, arguments);
    };
    prototype.texSubImage3D = function (...args) {
      if (args[9] === 0x1401) window.volumes.pieces.push(args[10].byteLength); // bytes: not the light, half floats
      return texSubImage3D.apply(this, args);
    };`,
};

/** Bytes of each volume that the GPU holds, and of each piece that it was given of those of bytes. */
export function volumesOf(page: Page): Promise<{ bytes: number[]; pieces: number[] }> {
  return page.evaluate("window.volumes");
}
