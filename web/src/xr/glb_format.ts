// Binary glTF 2.0 (its sections 4 and 5), as far as the models of hands and controllers have it.

export interface GltfPrimitive {
  attributes: Record<string, number>;
  indices: number;
}

export interface GltfSkin {
  joints: number[];
  inverseBindMatrices: number;
}

export interface GltfAccessor {
  bufferView: number;
  byteOffset?: number;
  componentType: number;
  count: number;
  type: string;
}

export interface GltfBufferView {
  byteOffset?: number;
  byteStride?: number;
}

export const kMagic = 0x46546c67;
export const kJson = 0x4e4f534a;
export const kBinary = 0x004e4942;
/** Bytes before the first chunk, and of a chunk before its data. */
export const kHeader = 12;
export const kChunkHeader = 8;

/** By the component type of an accessor. */
export const kArrays = {
  5121: Uint8Array,
  5123: Uint16Array,
  5125: Uint32Array,
  5126: Float32Array,
} as const;
/** Numbers of an element, by the type of an accessor. */
export const kSizes: Readonly<Record<string, number>> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };

/** The description and the data of a file. Throws where it is none. */
export function chunksOf(file: Uint8Array): [Uint8Array, Uint8Array] {
  const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
  if (file.byteLength < kHeader || view.getUint32(0, true) !== kMagic) {
    throw new Error("no binary glTF");
  }
  const found = new Map<number, Uint8Array>();
  for (let at = kHeader; at + kChunkHeader <= file.byteLength; ) {
    const length = view.getUint32(at, true);
    const begin = file.byteOffset + at + kChunkHeader;
    found.set(view.getUint32(at + 4, true), new Uint8Array(file.buffer, begin, length)); // throws beyond its end
    at += kChunkHeader + length;
  }
  const [json, binary] = [found.get(kJson), found.get(kBinary)];
  if (!json || !binary) {
    throw new Error("a binary glTF without data");
  }
  return [json, binary];
}
