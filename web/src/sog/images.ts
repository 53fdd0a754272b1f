import type { Texels } from "./sog";
import { CaseError } from "./zip";

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
    let bitmap: ImageBitmap;
    try {
      bitmap = await createImageBitmap(new Blob([webp as BlobPart], { type: "image/webp" }), {
        premultiplyAlpha: "none",
        colorSpaceConversion: "none",
      });
    } catch {
      throw new CaseError(`${name} cannot be decoded; copy the case again, whole`);
    }
    const { width, height } = bitmap;
    if (width > this.#maxSize || height > this.#maxSize) {
      throw new CaseError(`${name} is ${width}×${height}, more than this device can hold`);
    }
    const gl = this.#gl;
    gl.bindTexture(gl.TEXTURE_2D, this.#texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.#texture, 0);
    bitmap.close();
    const rgba = new Uint8Array(width * height * 4);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
    return { width, height, rgba };
  }

  /** Frees the GPU's memory; the decoder is of no use afterwards. */
  dispose(): void {
    this.#gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
