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

const kFolder = "/node_modules/@webxr-input-profiles/assets/dist/profiles";
/** Their addresses; vite/lean_models.ts makes them small. */
const kFiles = import.meta.glob<string>(
  "/node_modules/@webxr-input-profiles/assets/dist/profiles/{generic-hand,generic-trigger-squeeze-thumbstick,htc-vive-focus-3,meta-quest-touch-plus,meta-quest-touch-pro,oculus-touch-v3,pico-4,pico-4u,samsung-galaxyxr}/{left,right}.glb",
  { query: "?url", import: "default", eager: true },
);
/** Controllers that differ from others in nothing that is drawn. */
const kAlike: Readonly<Record<string, string>> = {
  "meta-quest-touch-plus-v2": "meta-quest-touch-plus",
  "oculus-touch-v2": "oculus-touch-v3",
  "generic-trigger-squeeze-touchpad-thumbstick": "generic-trigger-squeeze-thumbstick",
};

/** Where the first model is that fits what is held or bare in a hand, as the headset puts them; null: none does. */
export function modelUrl({ handedness, hand, profiles, targetRayMode }: XRInputSource): string | null {
  if (targetRayMode !== "tracked-pointer") {
    return null; // a look, or a touch of a screen
  }
  const urls = (hand ? ["generic-hand"] : profiles).map(
    (profile) => kFiles[`${kFolder}/${kAlike[profile] ?? profile}/${handedness}.glb`],
  );
  return urls.find((url) => url !== undefined) ?? null;
}

/** A hand or a controller as it is drawn: in one call. */
export interface InputModel {
  object: SkinnedMesh;
  /** What moves it, by its names. */
  nodes: ReadonlyMap<string, Bone>;
}

/** The model of what is held or bare in a hand; null: there is none, or it cannot be had. */
export async function loadInputModel(source: XRInputSource, material: Material): Promise<InputModel | null> {
  const url = modelUrl(source);
  if (url === null) {
    return null;
  }
  try {
    const response = await fetch(url);
    if (!response.ok) {
      throw new Error(String(response.status));
    }
    return modelOf(readGlb(await response.arrayBuffer()), material);
  } catch (error) {
    const { handedness, hand } = source;
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
