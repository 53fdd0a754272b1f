import { Bone, BufferAttribute, BufferGeometry, Matrix4 } from "three";

import {
  chunksOf,
  type GltfAccessor,
  type GltfBufferView,
  type GltfPrimitive,
  type GltfSkin,
  kArrays,
  kSizes,
} from "./glb_format";

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
  meshes: { primitives: GltfPrimitive[] }[];
  skins?: GltfSkin[];
  accessors: GltfAccessor[];
  bufferViews: GltfBufferView[];
}

const kAttributes = {
  position: "POSITION",
  normal: "NORMAL",
  skinIndex: "JOINTS_0",
  skinWeight: "WEIGHTS_0",
} as const;

/** Reads a binary glTF file. Throws where it is none, or has more than these models do. */
export function readGlb(bytes: ArrayBuffer): GlbModel {
  const [json, binary] = chunksOf(new Uint8Array(bytes));
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

function geometryOf(gltf: Gltf, binary: Uint8Array, { attributes, indices }: GltfPrimitive): BufferGeometry {
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
