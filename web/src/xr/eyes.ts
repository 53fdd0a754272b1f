import { PerspectiveCamera, Vector3, type Vector4 } from "three";

/** An eye's camera, as three.js gives it. */
export type Eye = PerspectiveCamera & { viewport: Vector4 };

/** What one camera must see to see all that two eyes do, and the size of its picture in px of theirs. */
export interface BothEyes {
  camera: PerspectiveCamera;
  width: number;
  height: number;
  /** Between the eyes, in the world. */
  middle: Vector3;
}

export function makeBothEyes(): BothEyes {
  const camera = new PerspectiveCamera();
  camera.matrixAutoUpdate = false;
  return { camera, width: 1, height: 1, middle: new Vector3() };
}

const offset = new Vector3();

/**
 * Sets `out` so that it sees what `eyes` see, which look in one direction: it stands behind them, where the outermost
 * sides of their frustums meet.
 */
export function setBothEyes(out: BothEyes, eyes: readonly Eye[]): void {
  const [first] = eyes;
  if (!first) {
    return;
  }
  let left = Infinity; // tangents
  let right = -Infinity;
  let bottom = Infinity;
  let top = -Infinity;
  let leftmost = Infinity; // eyes, along the first one's x
  let rightmost = -Infinity;
  out.middle.set(0, 0, 0);
  for (const eye of eyes) {
    const p = eye.projectionMatrix.elements;
    left = Math.min(left, (p[8] - 1) / p[0]);
    right = Math.max(right, (p[8] + 1) / p[0]);
    bottom = Math.min(bottom, (p[9] - 1) / p[5]);
    top = Math.max(top, (p[9] + 1) / p[5]);
    offset.setFromMatrixPosition(eye.matrixWorld);
    out.middle.addScaledVector(offset, 1 / eyes.length);
    const x = offset.applyMatrix4(first.matrixWorldInverse).x;
    leftmost = Math.min(leftmost, x);
    rightmost = Math.max(rightmost, x);
  }
  const back = (rightmost - leftmost) / (right - left);
  const { camera } = out;
  camera.matrixWorld.copy(first.matrixWorld);
  camera.matrixWorld.setPosition(offset.set(leftmost - back * left, 0, back).applyMatrix4(first.matrixWorld));
  camera.position.setFromMatrixPosition(camera.matrixWorld);
  camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
  const { near, far } = first;
  camera.projectionMatrix.makePerspective(left * near, right * near, top * near, bottom * near, near, far);
  // As many px to a tangent as the first eye has.
  const p = first.projectionMatrix.elements;
  out.width = 0.5 * first.viewport.z * p[0] * (right - left);
  out.height = 0.5 * first.viewport.w * p[5] * (top - bottom);
}
