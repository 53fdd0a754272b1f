import { Matrix4, type PerspectiveCamera, Vector3, Vector4 } from "three";

import { kWorldFromPatient, type Plane } from "../model/geometry";
import type { SplatMesh } from "./splat_mesh";

/** Of the planes that cut and of those that end the volume, as many as can be turned to an eye. */
export const kMaxFaces = 9;

/**
 * How far away faces are: they are drawn before everything else, with no depth of their own, but among hands they have that
 * of their planes. A ray that meets a face enters the kept side there of the last of the planes that are turned to the eye.
 */
export class FaceDepths {
  /** Of composite.frag.glsl: of each plane the z of a place (x, y) of normalized device coordinates, xyz·(x, y, 1). */
  readonly uniforms = {
    uFaceDepths: { value: Array.from({ length: kMaxFaces }, () => new Vector3()) },
    uFaceCount: { value: 0 },
  };
  readonly #worldFromClip = new Matrix4();
  readonly #fromScene = new Matrix4(); // planes of the scene, as they stand in the world; and of the patient
  readonly #fromPatient = kWorldFromPatient.clone().invert().transpose();
  readonly #plane = new Vector4(); // scratch

  /** The planes of `mesh`, which cut it, and the `ends` of the volume (RAS mm), as `eye` sees them. */
  set(mesh: SplatMesh, ends: readonly Plane[], eye: PerspectiveCamera): void {
    this.uniforms.uFaceCount.value = 0;
    this.#worldFromClip.multiplyMatrices(eye.projectionMatrix, eye.matrixWorldInverse).invert().transpose();
    this.#fromScene.copy(mesh.matrixWorld).invert().transpose();
    for (const { x, y, z, w } of mesh.planes) {
      this.#add(this.#plane.set(x, y, z, -w).applyMatrix4(this.#fromScene), eye);
    }
    for (const { normal, offset } of ends) {
      const { x, y, z } = normal;
      this.#add(this.#plane.set(x, y, z, -offset).applyMatrix4(this.#fromPatient), eye);
    }
  }

  /** A plane of the world, unless the eye is on the side that it keeps. */
  #add(plane: Vector4, eye: PerspectiveCamera): void {
    const { uFaceDepths, uFaceCount } = this.uniforms;
    const at = eye.matrixWorld.elements;
    const kept = plane.x * at[12] + plane.y * at[13] + plane.z * at[14] + plane.w;
    if (kept < 0 && uFaceCount.value < kMaxFaces) {
      const { x, y, z, w } = plane.applyMatrix4(this.#worldFromClip);
      uFaceDepths.value[uFaceCount.value++]!.set(-x / z, -y / z, -w / z);
    }
  }
}
