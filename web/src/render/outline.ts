import { Matrix3, Matrix4, type PerspectiveCamera, Vector3, Vector4 } from "three";

import { kWorldFromPatient } from "../model/geometry";
import type { SectionFaces } from "./section_faces";

/** How closely outlines are looked for. */
interface Effort {
  /** A pixel: with one, edges have steps. */
  rays: number;
  /** Of the section: where there may be matter. */
  stepVoxels: number;
  /** Of alpha: between the first and the last two, the section has more and less to say than splats. */
  ramps: Vector4;
}

/** As `clipgs render` does (src/section/outline.h), … */
const kAtRest: Effort = { rays: 8, stepVoxels: 0.4, ramps: new Vector4(0.002, 0.01, 0.97, 0.999) };
/** … and in a tenth of the time. */
const kMoving: Effort = { rays: 2, stepVoxels: 0.8, ramps: new Vector4(0.02, 0.1, 0.8, 0.95) };

const kPatientFromWorld = kWorldFromPatient.clone().invert();

/**
 * Where matter of a section ends, as uniforms of composite.frag.glsl: splats are round and soft there, a section knows
 * it to a fraction of its voxels. The twin of Outline in src/section/outline.h.
 */
export class Outline {
  readonly #view = {
    eye: new Vector3(),
    origin: new Vector3(),
    corner: new Vector3(),
    right: new Vector3(),
    down: new Vector3(),
    forward: new Vector3(),
    indexFromDirection: new Matrix3(),
    spacing: new Vector3(),
    step: 1,
    firstStep: 1,
  };
  readonly #scratch = new Matrix4();
  readonly uniforms = {
    uHasOutline: { value: false },
    uOutline: { value: this.#view },
    uOutlineRays: { value: 1 },
    uOutlineRamps: { value: kAtRest.ramps },
  };

  /** The camera, RAS mm. */
  get eye(): Vector3 {
    return this.#view.eye;
  }

  /** Of what `camera`, which is in the world, sees from now on. */
  set(faces: SectionFaces, camera: PerspectiveCamera): void {
    const view = this.#view;
    const { rays, stepVoxels, ramps } = faces.fine ? kAtRest : kMoving;
    this.uniforms.uOutlineRays.value = rays;
    this.uniforms.uOutlineRamps.value = ramps;
    const { spacing } = faces.section;
    const patientFromCamera = this.#scratch.multiplyMatrices(kPatientFromWorld, camera.matrixWorld);
    const p = camera.projectionMatrix.elements;
    const [x, y, z] = [new Vector3(), new Vector3(), new Vector3()];
    patientFromCamera.extractBasis(x, y, z);
    view.eye.setFromMatrixPosition(patientFromCamera);
    view.right.copy(x).multiplyScalar(2 / p[0]);
    view.down.copy(y).multiplyScalar(-2 / p[5]);
    view.corner
      .copy(x)
      .multiplyScalar((p[8] - 1) / p[0])
      .addScaledVector(y, (p[9] + 1) / p[5])
      .sub(z);
    view.forward.copy(z).normalize().negate();
    view.origin.copy(view.eye).applyMatrix4(faces.indexFromPatient);
    view.indexFromDirection.setFromMatrix4(faces.indexFromPatient);
    view.spacing.set(...spacing);
    view.step = stepVoxels * Math.cbrt(spacing[0] * spacing[1] * spacing[2]);
    view.firstStep = faces.firstStep;
  }
}
