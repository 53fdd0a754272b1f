import leftControllerUrl from "@webxr-input-profiles/assets/dist/profiles/meta-quest-touch-plus/left.glb?url";
import rightControllerUrl from "@webxr-input-profiles/assets/dist/profiles/meta-quest-touch-plus/right.glb?url";
import leftHandUrl from "@webxr-input-profiles/assets/dist/profiles/generic-hand/left.glb?url";
import rightHandUrl from "@webxr-input-profiles/assets/dist/profiles/generic-hand/right.glb?url";
import {
  type Bone,
  BufferAttribute,
  type BufferGeometry,
  type Material,
  Matrix4,
  Skeleton,
  SkinnedMesh,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

import { type GlbModel, readGlb } from "./glb";

// The models of the WebXR Input Profiles, fetched by headsets alone.

const kHands = { left: leftHandUrl, right: rightHandUrl } as const;
const kControllers = { left: leftControllerUrl, right: rightControllerUrl } as const;
/** Profiles whose controllers have the form of the model: of others, where their buttons are is not known. */
const kTouch = /^(meta-quest|oculus)-touch/;

/** A hand or a controller as it is drawn: in one call. */
export interface InputModel {
  object: SkinnedMesh;
  /** What moves it, by its names. */
  nodes: ReadonlyMap<string, Bone>;
}

/** The model of what is held or bare in a hand; null: there is none, or it cannot be had. */
export async function loadInputModel(source: XRInputSource, material: Material): Promise<InputModel | null> {
  const { handedness, hand, profiles } = source;
  if (handedness === "none" || !(hand || profiles.some((profile) => kTouch.test(profile)))) {
    return null;
  }
  try {
    const response = await fetch((hand ? kHands : kControllers)[handedness]);
    if (!response.ok) {
      throw new Error(String(response.status));
    }
    return modelOf(readGlb(await response.arrayBuffer()), material);
  } catch (error) {
    console.warn(`the model of the ${handedness} ${hand ? "hand" : "controller"}:`, error);
    return null;
  }
}

/** As one mesh, whose bones are a hand's joints, or what holds a controller's parts. */
export function modelOf({ nodes, root, meshes }: GlbModel, material: Material): InputModel {
  const skinned = meshes.find(({ skin }) => skin !== null);
  const geometry = skinned?.geometry ?? rigid(meshes.map((mesh) => mesh.geometry));
  const skeleton = skinned
    ? new Skeleton(skinned.skin!.joints, skinned.skin!.inverses)
    : new Skeleton(
        meshes.map(({ node }) => node),
        meshes.map(() => new Matrix4()),
      );
  const object = new SkinnedMesh(geometry, material);
  object.frustumCulled = false; // its bones move
  object.add(root);
  object.bind(skeleton, new Matrix4());
  return { object, nodes };
}

/** Parts that move as wholes, each by the bone of its number. */
function rigid(parts: readonly BufferGeometry[]): BufferGeometry {
  parts.forEach((part, i) => {
    const { count } = part.getAttribute("position");
    const bones = new Uint8Array(4 * count);
    const weights = new Float32Array(4 * count);
    for (let k = 0; k < count; ++k) {
      bones[4 * k] = i;
      weights[4 * k] = 1;
    }
    part.setAttribute("skinIndex", new BufferAttribute(bones, 4));
    part.setAttribute("skinWeight", new BufferAttribute(weights, 4));
  });
  return mergeGeometries([...parts]);
}
