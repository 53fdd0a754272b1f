import { Matrix4, PerspectiveCamera, Quaternion, Vector3, Vector4 } from "three";
import { expect, it } from "vitest";

import { type Eye, makeBothEyes, setBothEyes } from "../../src/xr/eyes";

const kHead = new Matrix4().compose(
  new Vector3(0.2, 1.6, -0.3),
  new Quaternion().setFromAxisAngle(new Vector3(0.2, 0.9, -0.1).normalize(), 0.8),
  new Vector3(1, 1, 1),
);

function eye(x: number, left: number, right: number): Eye {
  const camera = new PerspectiveCamera() as unknown as Eye;
  camera.near = 0.1;
  camera.far = 20;
  camera.projectionMatrix.makePerspective(0.1 * left, 0.1 * right, 0.08, -0.1, 0.1, 20);
  camera.matrixWorld.multiplyMatrices(kHead, new Matrix4().makeTranslation(x, 0, 0));
  camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
  camera.viewport = new Vector4(0, 0, 1680, 1760);
  return camera;
}

/** Tangents of a point of the world as a camera sees it, over those of the frustum's sides: −1 … 1 inside. */
function seen(camera: PerspectiveCamera, point: Vector3): Vector3 {
  return point.clone().applyMatrix4(camera.matrixWorldInverse).applyMatrix4(camera.projectionMatrix);
}

it("sees all that either eye sees, and no more than it must", () => {
  const eyes = [eye(-0.032, -1.2, 0.9), eye(0.032, -0.9, 1.2)];
  const both = makeBothEyes();
  setBothEyes(both, eyes);
  expect(both.middle.distanceTo(new Vector3(0.2, 1.6, -0.3))).toBeLessThan(1e-9);
  let outermost = 0;
  for (const one of eyes) {
    for (const depth of [0.1, 0.7, 15]) {
      for (const x of [-1, 0.3, 1]) {
        for (const y of [-1, 1]) {
          const clip = new Vector3(x, y, 0).applyMatrix4(one.projectionMatrix.clone().invert());
          const corner = clip.multiplyScalar(-depth / clip.z).applyMatrix4(one.matrixWorld);
          const at = seen(both.camera, corner);
          expect(Math.abs(at.x)).toBeLessThan(1 + 1e-6);
          expect(Math.abs(at.y)).toBeLessThan(1 + 1e-6);
          outermost = Math.max(outermost, Math.abs(at.x));
        }
      }
    }
  }
  expect(outermost).toBeGreaterThan(1 - 1e-6);
});

it("has the eyes' pixels", () => {
  const one = eye(0, -1, 1);
  const both = makeBothEyes();
  setBothEyes(both, [one]);
  expect(both.width).toBeCloseTo(1680, 6);
  expect(both.height).toBeCloseTo(1760, 6);
  expect(both.camera.position.distanceTo(new Vector3().setFromMatrixPosition(one.matrixWorld))).toBeLessThan(
    1e-9,
  );
});
