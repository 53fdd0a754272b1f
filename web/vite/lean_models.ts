import { readFileSync } from "node:fs";
import type { Plugin } from "vite";

import {
  chunksOf,
  type GltfAccessor,
  type GltfBufferView,
  type GltfPrimitive,
  type GltfSkin,
  kArrays,
  kBinary,
  kChunkHeader,
  kHeader,
  kJson,
  kMagic,
  kSizes,
} from "../src/xr/glb_format";

// Models of hands and controllers (the WebXR Input Profiles') as the headset draws them: without their pictures, which
// are nine tenths of most of them, and without what only pictures need.

interface Gltf {
  nodes: object[];
  scenes: object[];
  meshes: { primitives: GltfPrimitive[] }[];
  skins?: GltfSkin[];
  accessors: GltfAccessor[];
  bufferViews: GltfBufferView[];
}

/** Numbers, close together: `size` of them to an element. */
interface Values {
  array: Uint8Array | Uint16Array | Uint32Array | Float32Array;
  size: number;
  type: string;
}

/** What is kept, and as parts of what: nothing finer is seen, and what is rounded compresses. Others are whole. */
const kKept: Readonly<Record<string, number>> = {
  POSITION: 2 ** 16, // of a metre
  NORMAL: 2 ** 7,
  JOINTS_0: 1,
  WEIGHTS_0: 2 ** 12,
};

/** The same model, a fraction as large. */
export function leanModel(file: Uint8Array): Uint8Array {
  const [json, binary] = chunksOf(file);
  const gltf = JSON.parse(new TextDecoder().decode(json)) as Gltf;
  const parts: Uint8Array[] = [];
  const accessors: GltfAccessor[] = [];
  const bufferViews: { buffer: 0; byteOffset: number; byteLength: number }[] = [];
  let length = 0;
  const put = ({ array, size, type }: Values): number => {
    const bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
    bufferViews.push({ buffer: 0, byteOffset: length, byteLength: bytes.length });
    const padding = new Uint8Array(-bytes.length & 3);
    parts.push(bytes, padding);
    length += bytes.length + padding.length;
    const componentType = Number(Object.entries(kArrays).find(([, kind]) => array instanceof kind)![0]);
    return (
      accessors.push({
        bufferView: bufferViews.length - 1,
        componentType,
        count: array.length / size,
        type,
      }) - 1
    );
  };
  const meshes = gltf.meshes.map(({ primitives }) => ({
    primitives: primitives.map(({ attributes, indices }) => {
      const kept = Object.keys(kKept).filter((name) => attributes[name] !== undefined);
      const all = kept.map((name) => rounded(read(gltf, binary, attributes[name]!), kKept[name]!));
      const welded = weld(all, read(gltf, binary, indices));
      return {
        attributes: Object.fromEntries(kept.map((name, i) => [name, put(welded.attributes[i]!)])),
        indices: put(welded.indices),
      };
    }),
  }));
  const skins = gltf.skins?.map(({ joints, inverseBindMatrices }) => ({
    joints,
    inverseBindMatrices: put(read(gltf, binary, inverseBindMatrices)),
  }));
  const dropped = { camera: undefined, extras: undefined, extensions: undefined }; // JSON leaves these out
  const nodes = gltf.nodes.map((node) => ({ ...node, ...dropped }));
  const buffers = [{ byteLength: length }];
  const asset = { version: "2.0" };
  const lean = {
    asset,
    scene: 0,
    scenes: gltf.scenes,
    nodes,
    meshes,
    ...(skins && { skins }),
    accessors,
    bufferViews,
    buffers,
  };
  return packed(JSON.stringify(lean), parts, length);
}

function read({ accessors, bufferViews }: Gltf, binary: Uint8Array, index: number): Values {
  const { bufferView, byteOffset = 0, componentType, count, type } = accessors[index]!;
  const { byteOffset: begin = 0, byteStride } = bufferViews[bufferView]!;
  const Kind = kArrays[componentType as keyof typeof kArrays];
  const size = kSizes[type]!;
  const bytes = size * Kind.BYTES_PER_ELEMENT;
  const close = new Uint8Array(count * bytes);
  for (let i = 0; i < count; ++i) {
    const at = begin + byteOffset + i * (byteStride ?? bytes);
    close.set(binary.subarray(at, at + bytes), i * bytes);
  }
  return { array: new Kind(close.buffer), size, type };
}

function rounded(values: Values, steps: number): Values {
  const { array } = values;
  return array instanceof Float32Array
    ? { ...values, array: array.map((value) => Math.round(value * steps) / steps) }
    : values;
}

/** Points that differed by where they were in pictures alone are one. */
function weld(attributes: Values[], indices: Values): { attributes: Values[]; indices: Values } {
  const places = new Map<string, number>();
  const firsts: number[] = [];
  const element = ({ array, size }: Values, i: number) => array.subarray(i * size, (i + 1) * size);
  const welded = Array.from(indices.array, (i) => {
    const key = attributes.map((one) => element(one, i).join()).join(";");
    const place = places.get(key) ?? firsts.push(i) - 1;
    places.set(key, place);
    return place;
  });
  return {
    attributes: attributes.map((one) => {
      const array = one.array.slice(0, firsts.length * one.size);
      firsts.forEach((i, place) => array.set(element(one, i), place * one.size));
      return { ...one, array };
    }),
    indices: {
      ...indices,
      array: firsts.length > 0xffff ? Uint32Array.from(welded) : Uint16Array.from(welded),
    },
  };
}

function packed(description: string, parts: readonly Uint8Array[], length: number): Uint8Array {
  const json = new TextEncoder().encode(description.padEnd((description.length + 3) & ~3));
  const file = new Uint8Array(kHeader + 2 * kChunkHeader + json.length + length);
  const view = new DataView(file.buffer);
  const put = (at: number, ...words: number[]) =>
    words.forEach((word, i) => view.setUint32(at + 4 * i, word, true));
  put(0, kMagic, 2, file.length, json.length, kJson);
  file.set(json, kHeader + kChunkHeader);
  let at = kHeader + kChunkHeader + json.length;
  put(at, length, kBinary);
  at += kChunkHeader;
  for (const part of parts) {
    file.set(part, at);
    at += part.length;
  }
  return file;
}

/** Has the bundle's models made so. */
export const leanModels: Plugin = {
  name: "lean-models",
  apply: "build",
  enforce: "pre",
  load(id) {
    const [file, query] = id.split("?");
    if (!file!.endsWith(".glb") || query !== "url") {
      return null;
    }
    const [, profile, side] = /([^/]+)\/([^/]+)\.glb$/.exec(file!)!;
    const reference = this.emitFile({
      type: "asset",
      name: `${profile}-${side}.glb`,
      source: leanModel(readFileSync(file!)),
    });
    return `export default import.meta.ROLLUP_FILE_URL_${reference};`;
  },
};
