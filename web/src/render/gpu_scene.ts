import {
  DataTexture,
  DataUtils,
  FloatType,
  HalfFloatType,
  NearestFilter,
  type PixelFormat,
  RedFormat,
  RedIntegerFormat,
  RGBAFormat,
  RGBAIntegerFormat,
  type TextureDataType,
  UnsignedByteType,
  UnsignedIntType,
  UnsignedShortType,
  WebGLRenderTarget,
} from "three";

import type { PackedScene } from "../sog/sog";

/** Splats lie in rows of textures of this width: 2 to the power of kWidthBits. */
export const kWidthBits = 11;
const kWidth = 1 << kWidthBits;

function dataTexture(
  data: Uint8Array | Uint16Array | Uint32Array | Float32Array,
  width: number,
  height: number,
  format: PixelFormat,
  type: TextureDataType,
  internalFormat: "RGBA32UI" | "R32UI" | "R16UI" | "RGBA8UI" | "R32F" | "RGBA16F",
): DataTexture {
  const texture = new DataTexture(
    data as BufferSource as Uint8Array<ArrayBuffer>,
    width,
    height,
    format,
    type,
  );
  texture.internalFormat = internalFormat;
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

function codebook(values: Float32Array): DataTexture {
  return dataTexture(values, values.length, 1, RedFormat, FloatType, "R32F");
}

/** `data` with zeros to a length of `length`. */
function padded<T extends Uint8Array | Uint16Array | Uint32Array>(data: T, length: number): T {
  const result = new (data.constructor as new (length: number) => T)(length);
  result.set(data);
  return result;
}

/**
 * The textures of a scene. A splat has 24 bytes: 20 of its own and its colour as seen now; 2 more with face colours, 2
 * with layers, and 4 in the order of drawing.
 */
export class GpuScene {
  readonly count: number;
  /** Splats that the textures have room for. */
  readonly capacity: number;
  readonly shCoefficients: number;
  readonly meanMin: number[];
  readonly meanSize: number[];
  readonly packed: DataTexture;
  readonly sh0: DataTexture;
  readonly centroids: DataTexture;
  readonly hasFaceColors: boolean;
  readonly faceLabels: DataTexture;
  readonly facePalette: DataTexture;
  readonly hasLayers: boolean;
  readonly layers: DataTexture;
  readonly scaleCodebook: Float32Array;
  readonly sh0Codebook: DataTexture;
  readonly shNCodebook: DataTexture;
  readonly order: DataTexture;
  readonly colors: WebGLRenderTarget;

  constructor(scene: PackedScene) {
    const height = Math.ceil(scene.count / kWidth);
    this.count = scene.count;
    this.capacity = kWidth * height;
    this.meanMin = scene.meanMin;
    this.meanSize = scene.meanMax.map((max, i) => max - scene.meanMin[i]!);
    const rgba = 4 * this.capacity;
    this.packed = dataTexture(
      padded(scene.packed, rgba),
      kWidth,
      height,
      RGBAIntegerFormat,
      UnsignedIntType,
      "RGBA32UI",
    );
    this.sh0 = dataTexture(
      padded(scene.sh0, rgba),
      kWidth,
      height,
      RGBAIntegerFormat,
      UnsignedByteType,
      "RGBA8UI",
    );
    const palette = scene.shN?.centroids ?? { width: 1, height: 1, rgba: new Uint8Array(4) };
    this.centroids = dataTexture(
      palette.rgba,
      palette.width,
      palette.height,
      RGBAIntegerFormat,
      UnsignedByteType,
      "RGBA8UI",
    );
    this.shCoefficients = scene.shN?.coefficients ?? 0;
    this.hasFaceColors = scene.faces !== null;
    this.faceLabels = dataTexture(
      scene.faces ? padded(scene.faces.labels, this.capacity) : new Uint16Array(1),
      scene.faces ? kWidth : 1,
      scene.faces ? height : 1,
      RedIntegerFormat,
      UnsignedShortType,
      "R16UI",
    );
    const faces = scene.faces?.palette ?? { width: 1, height: 1, rgba: new Float32Array(4) };
    this.facePalette = dataTexture(
      Uint16Array.from(faces.rgba, (value) => DataUtils.toHalfFloat(value)),
      faces.width,
      faces.height,
      RGBAFormat,
      HalfFloatType,
      "RGBA16F",
    );
    this.hasLayers = scene.layers !== null;
    this.layers = dataTexture(
      scene.layers ? padded(scene.layers, this.capacity) : new Uint16Array(1),
      scene.layers ? kWidth : 1,
      scene.layers ? height : 1,
      RedIntegerFormat,
      UnsignedShortType,
      "R16UI",
    );
    this.scaleCodebook = scene.scaleCodebook;
    this.sh0Codebook = codebook(scene.sh0Codebook);
    this.shNCodebook = codebook(scene.shN?.codebook ?? new Float32Array(1));
    this.order = dataTexture(
      new Uint32Array(this.capacity),
      kWidth,
      height,
      RedIntegerFormat,
      UnsignedIntType,
      "R32UI",
    );
    this.colors = new WebGLRenderTarget(kWidth, height, {
      format: RedIntegerFormat,
      type: UnsignedIntType,
      internalFormat: "R32UI",
      minFilter: NearestFilter,
      magFilter: NearestFilter,
      depthBuffer: false,
    });
  }

  dispose(): void {
    for (const resource of [
      this.packed,
      this.sh0,
      this.centroids,
      this.faceLabels,
      this.facePalette,
      this.layers,
      this.sh0Codebook,
      this.shNCodebook,
      this.order,
      this.colors,
    ]) {
      resource.dispose();
    }
  }
}
