import { type Matrix4, type PerspectiveCamera, Vector3 } from "three";

import { kWorldFromPatient } from "../model/geometry";

const scratch = new Vector3();

/**
 * Sets `out` so that it sees of the viewer's world what a camera does of a room in which the patient stands as
 * `patientFromRoom`, a similarity, says; as near to its near plane.
 */
export function setWorldCamera(
  out: PerspectiveCamera,
  camera: PerspectiveCamera,
  patientFromRoom: Matrix4,
): void {
  out.matrixWorld.multiplyMatrices(kWorldFromPatient, patientFromRoom).multiply(camera.matrixWorld);
  const scale = out.position.setFromMatrixScale(out.matrixWorld).x;
  out.position.setFromMatrixPosition(out.matrixWorld);
  out.matrixWorld.scale(scratch.setScalar(1 / scale));
  out.matrixWorldInverse.copy(out.matrixWorld).invert();
  out.projectionMatrix.copy(camera.projectionMatrix);
  out.projectionMatrix.elements[14] *= scale; // that of the near plane
  out.projectionMatrixInverse.copy(out.projectionMatrix).invert();
}
