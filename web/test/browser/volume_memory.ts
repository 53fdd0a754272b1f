import type { Page } from "playwright-core";

/** For a page, before its own scripts: what it asks of the GPU for volumes is counted. */
export const kCountVolumes = {
  content: `window.volumes = { bytes: [], pieces: [] };
    const { prototype } = WebGL2RenderingContext;
    const { texStorage3D, texSubImage3D } = prototype;
    const kSizes = { 0x8229: 1, 0x8051: 3, 0x8c43: 4 }; // R8, RGB8, SRGB8_ALPHA8
    prototype.texStorage3D = function (target, levels, format, w, h, d) {
      window.volumes.bytes.push(levels * kSizes[format] * w * h * d);
      return texStorage3D.apply(this, arguments);
    };
    prototype.texSubImage3D = function (...args) {
      if (args[8] !== 0x1908) window.volumes.pieces.push(args[10].byteLength); // RGBA: the light
      return texSubImage3D.apply(this, args);
    };`,
};

/** Bytes of each volume that the GPU holds, and of each piece that it was given of those that are not light. */
export function volumesOf(page: Page): Promise<{ bytes: number[]; pieces: number[] }> {
  return page.evaluate("window.volumes");
}
