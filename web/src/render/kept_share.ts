import { type IUniform, Vector2, Vector3, Vector4 } from "three";

import { kMaxPlanes } from "../model/cut";
import { type Hull, kHullDirections } from "../sog/hull";
import type { SceneCamera } from "./scene_camera";

/** Px that splats may reach out of the hull of their means: KeptShare::kMargin. */
const kMargin = 3;
/** Per pixel: a plane that is seen from before is not turned into one that is seen along itself. */
const kLeastSlope = 1e-9;

/** Sine of the angle with a ray at which splats show well where a plane ends them (src/splat/kept_share.cpp). */
const kSteep = 0.25;

/** Of pixel (x, y) from the top left, (x, y, 1)·result is how far its ray goes along a direction to depth 1. */
function rayAlong(camera: SceneCamera, direction: Vector3, out: Vector3): Vector3 {
  const { focal, principal } = camera;
  const { x, y, z } = out.copy(direction).applyMatrix3(camera.rotation);
  const [across, down] = [x / focal.x, y / focal.y];
  return out.set(across, down, z - across * (principal.x - 0.5) - down * (principal.y - 0.5));
}

/** Whether a plane is steep everywhere in the picture: `along`, rayAlong() of its normal. */
function isSteep({ focal, principal, size }: SceneCamera, along: Vector3): boolean {
  const [right, bottom] = [size.x - 1, size.y - 1];
  const side = Math.sign(along.z + 0.5 * (along.x * right + along.y * bottom));
  const corners = [
    [0, 0],
    [right, 0],
    [0, bottom],
    [right, bottom],
  ] as const;
  return corners.every(([x, y]) => {
    const ray = Math.hypot((x + 0.5 - principal.x) / focal.x, (y + 0.5 - principal.y) / focal.y, 1);
    return (side * (along.x * x + along.y * y + along.z)) / ray >= kSteep;
  });
}

/**
 * Planes that are seen along themselves end what is seen of a body: the twin of KeptShare in src/splat/kept_share.h, as
 * uniforms of composite.frag.glsl.
 */
export class KeptShare {
  readonly uniforms = {
    uEdges: { value: Array.from({ length: kMaxPlanes }, () => new Vector4()) },
    uEdgeCount: { value: 0 },
    uHull: { value: Array.from({ length: kHullDirections }, () => new Vector3()) },
    uHullEnds: { value: Array.from({ length: kHullDirections }, () => new Vector2()) },
    uNear: { value: 1 },
    uMargin: { value: 0 },
  } satisfies Record<string, IUniform>;
  readonly #scratch = new Vector3();

  /** `planes`: in scene space, as SplatMesh.planes; each keeps xyz·x >= w. */
  set(camera: SceneCamera, planes: readonly Vector4[], hull: Hull): void {
    const { uEdges, uEdgeCount, uHull, uHullEnds, uNear } = this.uniforms;
    uEdgeCount.value = 0;
    if (planes.length === 0) {
      return;
    }
    uNear.value = camera.near;
    this.uniforms.uMargin.value = kMargin / camera.focal.x;
    let [nearest, farthest] = [0, 0]; // depths of the hull's box
    for (let k = 0; k < kHullDirections; ++k) {
      const direction = uHull.value[k]!.fromArray(hull.directions, 3 * k);
      const eye = direction.dot(camera.position);
      const ends = uHullEnds.value[k]!.set(hull.low[k]! - eye, hull.high[k]! - eye);
      if (k < 3) {
        const depth = this.#scratch.copy(direction).applyMatrix3(camera.rotation).z;
        nearest += Math.min(depth * ends.x, depth * ends.y);
        farthest += Math.max(depth * ends.x, depth * ends.y);
      }
      rayAlong(camera, direction, direction);
    }
    nearest = Math.max(nearest, camera.near);
    farthest = Math.max(farthest, camera.near);
    for (const plane of planes) {
      const normal = this.#scratch.set(plane.x, plane.y, plane.z);
      const kept = normal.dot(camera.position) - plane.w;
      const { x, y, z } = rayAlong(camera, normal, normal);
      if (isSteep(camera, normal)) {
        continue;
      }
      const edge = uEdges.value[uEdgeCount.value]!.set(x, y, z, kept);
      edge.divideScalar(Math.max(Math.abs(x) + Math.abs(y), kLeastSlope));
      const least =
        edge.z + Math.min(0, edge.x * (camera.size.x - 1)) + Math.min(0, edge.y * (camera.size.y - 1));
      if (least + Math.max(edge.w / nearest, edge.w / farthest) < 0.5) {
        ++uEdgeCount.value; // it does not leave all of the picture whole
      }
    }
  }
}
