import { CaseError } from "./zip";
import type { Texels } from "./sog";

interface Exports {
  memory: WebAssembly.Memory;
  malloc(bytes: number): number;
  free(at: number): void;
  WebPDecodeRGBA(data: number, size: number, width: number, height: number): number;
}

/** What libwebp's files would need, which decoding in memory does not touch. */
const kNoFiles = { fd_close: () => 0, fd_seek: () => 0, fd_write: () => 0 };

/**
 * libwebp, compiled to WebAssembly. Images whose texels are data do not go through a browser's own decoder: its bitmaps
 * can only be read through a canvas or a texture, where some browsers lose a crop's offset, colours under low alpha or,
 * against tracking, bits of every texel.
 */
export class WebpDecoder {
  readonly #wasm: Exports;

  constructor(module: WebAssembly.Module) {
    const instance = new WebAssembly.Instance(module, { wasi_snapshot_preview1: kNoFiles });
    this.#wasm = instance.exports as unknown as Exports;
  }

  /**
   * What `use` makes of an image's texels, which are gone afterwards. `name` is what errors call the image. Throws
   * CaseError.
   */
  decode<T>(webp: Uint8Array, name: string, use: (texels: Texels) => T): T {
    const { malloc, free, memory, WebPDecodeRGBA } = this.#wasm;
    const kSizeBytes = 8; // width and height
    const size = malloc(kSizeBytes + webp.length);
    const data = size + kSizeBytes;
    let texels = 0;
    if (size !== 0) {
      new Uint8Array(memory.buffer, data, webp.length).set(webp);
      texels = WebPDecodeRGBA(data, webp.length, size, size + 4);
    }
    if (texels === 0) {
      free(size);
      throw new CaseError(`${name} cannot be decoded, or there is not enough memory; copy the case again`);
    }
    const [width, height] = new Uint32Array(memory.buffer, size, 2) as unknown as [number, number];
    try {
      return use({ width, height, rgba: new Uint8Array(memory.buffer, texels, 4 * width * height) });
    } finally {
      free(texels);
      free(size);
    }
  }
}
