import { Matrix3, type Matrix4, type PerspectiveCamera, Vector2, Vector3, type Vector4 } from "three";

import type { LayerSwitch } from "../model/states";

/** A camera as a scene's own space sees it: `Camera` of shaders/gaussian.glsl. */
export interface SceneCamera {
  rotation: Matrix3; // scene → camera; x right, y down, z forward
  position: Vector3;
  focal: Vector2; // px
  principal: Vector2; // px
  size: Vector2; // px
  near: number; // scene units
}

export function makeSceneCamera(): SceneCamera {
  return {
    rotation: new Matrix3(),
    position: new Vector3(),
    focal: new Vector2(),
    principal: new Vector2(),
    size: new Vector2(),
    near: 0,
  };
}

/** Gaussians nearer to the camera than this are not drawn, mm (kNearPlane of src/splat/projection.h). */
const kNearPlane = 1;

const modelView: { matrix: Matrix4 | null; axes: [Vector3, Vector3, Vector3] } = {
  matrix: null,
  axes: [new Vector3(), new Vector3(), new Vector3()],
};

/**
 * Sets `out` for a scene that `matrixWorld` (a similarity) puts into the world, and a picture of width × height
 * px. Returns the length of a scene unit in the world. Any perspective does, also an eye's.
 */
export function setSceneCamera(
  out: SceneCamera,
  camera: PerspectiveCamera,
  matrixWorld: Matrix4,
  width: number,
  height: number,
  mmPerUnit: number,
): number {
  modelView.matrix ??= matrixWorld.clone();
  const m = modelView.matrix.multiplyMatrices(camera.matrixWorldInverse, matrixWorld);
  const [x, y, z] = modelView.axes;
  m.extractBasis(x, y, z);
  const scale = x.length();
  x.divideScalar(scale);
  y.divideScalar(scale);
  z.divideScalar(scale);
  out.rotation.set(x.x, y.x, z.x, -x.y, -y.y, -z.y, -x.z, -y.z, -z.z);
  out.position.setFromMatrixPosition(m);
  out.position.set(-x.dot(out.position), -y.dot(out.position), -z.dot(out.position)).divideScalar(scale);
  const p = camera.projectionMatrix.elements;
  out.focal.set(0.5 * width * p[0], 0.5 * height * p[5]);
  out.principal.set(0.5 * width * (1 - p[8]), 0.5 * height * (1 + p[9]));
  out.size.set(width, height);
  out.near = kNearPlane / mmPerUnit;
  return scale;
}

/**
 * Writes `camera`, `planes` and what `layers` are on (scene space) as the worker's sorting wants them; splats that reach no farther than
 * `leastPixels` are left out.
 */
export function writeSortView(
  out: Float32Array,
  camera: SceneCamera,
  planes: readonly Vector4[],
  leastPixels = 0,
  layers: LayerSwitch | null = null,
): void {
  const r = camera.rotation.elements; // column by column
  out.set([r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]], 0);
  camera.position.toArray(out, 9);
  out[12] = -camera.principal.x / camera.focal.x;
  out[13] = -camera.principal.y / camera.focal.y;
  out[14] = (camera.size.x - camera.principal.x) / camera.focal.x;
  out[15] = (camera.size.y - camera.principal.y) / camera.focal.y;
  out[16] = 1 / Math.min(camera.focal.x, camera.focal.y);
  out[17] = camera.near;
  out[18] = leastPixels;
  out[19] = planes.length;
  out[20] = layers?.slab ?? 0;
  out[21] = layers?.sign ?? 1;
  planes.forEach((plane, i) => plane.toArray(out, 22 + 4 * i));
}
