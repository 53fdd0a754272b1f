import { Bone, BufferAttribute, BufferGeometry, Matrix4 } from "three";

/** A model of a hand or a controller, as glTF has it: what is shown, moved by its nodes. */
export interface GlbModel {
  /** All nodes by their names; those without parents are below `root`. */
  nodes: ReadonlyMap<string, Bone>;
  root: Bone;
  meshes: readonly GlbMesh[];
}

interface GlbMesh {
  /** position, normal, and of a skinned one skinIndex and skinWeight. */
  geometry: BufferGeometry;
  node: Bone;
  skin: { joints: Bone[]; inverses: Matrix4[] } | null;
}

/** The parts of glTF 2.0 that these models have; textures and materials are not taken over. */
interface Gltf {
  nodes: {
    name?: string;
    children?: number[];
    mesh?: number;
    skin?: number;
    matrix?: number[];
    translation?: number[];
    rotation?: number[];
    scale?: number[];
  }[];
  meshes: { primitives: { attributes: Record<string, number>; indices: number }[] }[];
  skins?: { joints: number[]; inverseBindMatrices: number }[];
  accessors: {
    bufferView: number;
    byteOffset?: number;
    componentType: number;
    count: number;
    type: string;
  }[];
  bufferViews: { byteOffset?: number; byteLength: number; byteStride?: number }[];
}

const kMagic = 0x46546c67;
const kJson = 0x4e4f534a;
const kBinary = 0x004e4942;
const kHeader = 12;
const kChunkHeader = 8;

const kArrays = { 5121: Uint8Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array } as const;
const kSizes: Readonly<Record<string, number>> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };
const kAttributes = {
  position: "POSITION",
  normal: "NORMAL",
  skinIndex: "JOINTS_0",
  skinWeight: "WEIGHTS_0",
} as const;

/** Reads a binary glTF file. Throws where it is none, or has more than these models do. */
export function readGlb(bytes: ArrayBuffer): GlbModel {
  const [json, binary] = chunks(bytes);
  const gltf = JSON.parse(new TextDecoder().decode(json)) as Gltf;
  const bones = gltf.nodes.map((node) => {
    const bone = new Bone();
    bone.name = node.name ?? "";
    if (node.matrix) {
      new Matrix4().fromArray(node.matrix).decompose(bone.position, bone.quaternion, bone.scale);
    }
    bone.position.fromArray(node.translation ?? bone.position.toArray());
    bone.quaternion.fromArray(node.rotation ?? bone.quaternion.toArray());
    bone.scale.fromArray(node.scale ?? bone.scale.toArray());
    return bone;
  });
  gltf.nodes.forEach(({ children = [] }, i) => children.forEach((child) => bones[i]!.add(bones[child]!)));
  const root = new Bone();
  root.add(...bones.filter(({ parent }) => parent === null));
  const meshes = gltf.nodes.flatMap((node, i) =>
    node.mesh === undefined
      ? []
      : gltf.meshes[node.mesh]!.primitives.map((primitive) => ({
          geometry: geometryOf(gltf, binary, primitive),
          node: bones[i]!,
          skin: node.skin === undefined ? null : skinOf(gltf, binary, node.skin, bones),
        })),
  );
  return { nodes: new Map(bones.map((bone) => [bone.name, bone])), root, meshes };
}

/** The description and the data. */
function chunks(bytes: ArrayBuffer): [Uint8Array, Uint8Array] {
  const view = new DataView(bytes);
  if (bytes.byteLength < kHeader || view.getUint32(0, true) !== kMagic) {
    throw new Error("no binary glTF");
  }
  const found = new Map<number, Uint8Array>();
  for (let at = kHeader; at + kChunkHeader <= bytes.byteLength; ) {
    const length = view.getUint32(at, true);
    found.set(view.getUint32(at + 4, true), new Uint8Array(bytes, at + kChunkHeader, length)); // throws beyond its end
    at += kChunkHeader + length;
  }
  const [json, binary] = [found.get(kJson), found.get(kBinary)];
  if (!json || !binary) {
    throw new Error("a binary glTF without data");
  }
  return [json, binary];
}

/** The numbers of an accessor, close together. */
function read(
  gltf: Gltf,
  binary: Uint8Array,
  index: number,
): { values: InstanceType<ArrayKind>; size: number } {
  const { bufferView, byteOffset = 0, componentType, count, type } = gltf.accessors[index]!;
  const view = gltf.bufferViews[bufferView]!;
  const Kind = kArrays[componentType as keyof typeof kArrays];
  const size = kSizes[type]!;
  if (!Kind || view.byteStride) {
    throw new Error(`numbers of kind ${componentType} that are not read`);
  }
  const begin = (view.byteOffset ?? 0) + byteOffset;
  const end = begin + count * size * Kind.BYTES_PER_ELEMENT;
  if (end > binary.byteLength) {
    throw new Error("numbers beyond the end of the file");
  }
  return { values: new Kind(binary.slice(begin, end).buffer), size };
}

type ArrayKind = (typeof kArrays)[keyof typeof kArrays];

function geometryOf(
  gltf: Gltf,
  binary: Uint8Array,
  { attributes, indices }: { attributes: Record<string, number>; indices: number },
): BufferGeometry {
  const geometry = new BufferGeometry();
  for (const [name, theirs] of Object.entries(kAttributes)) {
    const index = attributes[theirs];
    if (index !== undefined) {
      const { values, size } = read(gltf, binary, index);
      const isShare = name === "skinWeight" && !(values instanceof Float32Array);
      geometry.setAttribute(name, new BufferAttribute(values, size, isShare));
    }
  }
  geometry.setIndex(new BufferAttribute(read(gltf, binary, indices).values, 1));
  return geometry;
}

function skinOf(gltf: Gltf, binary: Uint8Array, index: number, bones: readonly Bone[]): GlbMesh["skin"] {
  const { joints, inverseBindMatrices } = gltf.skins![index]!;
  const { values } = read(gltf, binary, inverseBindMatrices);
  return {
    joints: joints.map((joint) => bones[joint]!),
    inverses: joints.map((_, i) => new Matrix4().fromArray(values, 16 * i)),
  };
}
