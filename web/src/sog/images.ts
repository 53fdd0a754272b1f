import { copySlices, makeVoxels, type SectionInfo } from "./section";
import type { Texels } from "./sog";
import { CaseError } from "./zip";

const kAsTheyAre = { premultiplyAlpha: "none", colorSpaceConversion: "none" } as const;

/** `name` is what errors call the image. Throws CaseError. */
export async function decodeBitmap(webp: Uint8Array, name: string): Promise<ImageBitmap> {
  try {
    return await createImageBitmap(new Blob([webp as BlobPart], { type: "image/webp" }), kAsTheyAre);
  } catch {
    throw new CaseError(`${name} cannot be decoded; copy the case again, whole`);
  }
}

/**
 * Decodes WebP images whose texels are data, byte for byte: no premultiplication, no colour management, and
 * read back through a WebGL framebuffer, because a 2D canvas loses colours under low alpha.
 */
export class ImageDecoder {
  readonly #gl: WebGL2RenderingContext;
  readonly #texture: WebGLTexture;
  readonly #maxSize: number;

  constructor() {
    const gl = new OffscreenCanvas(1, 1).getContext("webgl2", { antialias: false, depth: false });
    if (!gl) {
      throw new CaseError(
        "this browser has no WebGL 2, which the viewer needs; update it or turn acceleration on",
      );
    }
    this.#gl = gl;
    this.#texture = gl.createTexture();
    this.#maxSize = gl.getParameter(gl.MAX_TEXTURE_SIZE) as number;
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  }

  /** `name` is what errors call the image. Throws CaseError. */
  async decode(webp: Uint8Array, name: string): Promise<Texels> {
    const bitmap = await decodeBitmap(webp, name);
    const { width, height } = bitmap;
    if (width > this.#maxSize || height > this.#maxSize) {
      throw new CaseError(`${name} is ${width}×${height}, more than this device can hold`);
    }
    const rgba = new Uint8Array(width * height * 4);
    this.#read(bitmap, rgba);
    bitmap.close();
    return { width, height, rgba };
  }

  /**
   * Reads a section's image row by row of tiles, so that neither its size on this device nor a second copy
   * of it matters, and closes it. Throws CaseError.
   */
  async readSection(bitmap: ImageBitmap, info: SectionInfo): Promise<Uint8Array> {
    const { tileWidth, tileHeight, columns, rows } = info.mosaic;
    if (bitmap.width !== columns * tileWidth || bitmap.height !== rows * tileHeight) {
      throw new CaseError(
        `${info.file} is ${bitmap.width}×${bitmap.height}, which does not fit the section; build the case again`,
      );
    }
    const voxels = makeVoxels(info);
    const most = Math.min(columns, Math.floor(this.#maxSize / tileWidth));
    const tiles = new Uint8Array(most * tileWidth * tileHeight * 4);
    for (let z = 0, count = 0; z < info.dims[2]; z += count) {
      const column = z % columns;
      count = Math.min(most, columns - column, info.dims[2] - z);
      const piece = await createImageBitmap(
        bitmap,
        column * tileWidth,
        Math.floor(z / columns) * tileHeight,
        count * tileWidth,
        tileHeight,
        kAsTheyAre,
      );
      this.#read(piece, tiles);
      piece.close();
      copySlices(info, tiles, z, count, voxels);
    }
    bitmap.close();
    return voxels;
  }

  /** The texels of a bitmap, to the beginning of `rgba`. */
  #read(bitmap: ImageBitmap, rgba: Uint8Array): void {
    const gl = this.#gl;
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.#texture, 0);
    gl.readPixels(0, 0, bitmap.width, bitmap.height, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
  }

  /** Frees the GPU's memory; the decoder is of no use afterwards. */
  dispose(): void {
    this.#gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
