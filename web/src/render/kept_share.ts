import { type Sphere, Vector3, type Vector4 } from "three";

import type { SceneCamera } from "./scene_camera";

/** Linear functions of (x, y, 1), px from the top left: of what a plane keeps at a body's near end and at its far end. */
export type KeptEdge = [near: Vector3, far: Vector3];

/** Per pixel, scene units: a plane that is seen from before is not turned into one that is seen along itself. */
const kLeastSlope = 1e-9;

/** Share of a pixel on the kept side of a plane at depth z, before clamping. */
function shareAtDepth(camera: SceneCamera, plane: Vector4, z: number): Vector3 {
  const normal = new Vector3(plane.x, plane.y, plane.z);
  const n = normal.clone().applyMatrix3(camera.rotation);
  const x = (z * n.x) / camera.focal.x;
  const y = (z * n.y) / camera.focal.y;
  const { x: cx, y: cy } = camera.principal;
  const distance = normal.dot(camera.position) - plane.w + z * n.z - x * (cx - 0.5) - y * (cy - 0.5);
  const slope = Math.max(Math.abs(x) + Math.abs(y), kLeastSlope);
  return new Vector3(x / slope, y / slope, distance / slope + 0.5);
}

/**
 * The planes (scene space, as SplatMesh.planes) that end what is seen of a body within a picture: where they are seen
 * along themselves. The twin of KeptShare in src/splat/kept_share.h.
 */
export function keptEdges(camera: SceneCamera, planes: readonly Vector4[], body: Sphere): KeptEdge[] {
  const middle = body.center.clone().sub(camera.position).applyMatrix3(camera.rotation).z;
  const [right, bottom] = [camera.size.x - 1, camera.size.y - 1];
  const isWhole = ({ x, y, z }: Vector3) => z + Math.min(0, x * right) + Math.min(0, y * bottom) >= 1;
  return planes
    .map(
      (plane): KeptEdge => [
        shareAtDepth(camera, plane, Math.max(camera.near, middle - body.radius)),
        shareAtDepth(camera, plane, Math.max(camera.near, middle + body.radius)),
      ],
    )
    .filter((edge) => !edge.some(isWhole));
}
