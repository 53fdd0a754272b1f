import { PerspectiveCamera, WebGLRenderer } from "three";

/** A renderer on a canvas of size × size px and a camera of that field of view, degrees, placed by matrices. */
export function threePage(size, fov) {
  const renderer = new WebGLRenderer({ antialias: false, powerPreference: "high-performance" });
  renderer.setPixelRatio(1);
  renderer.setSize(size, size);
  document.body.append(renderer.domElement);
  const camera = new PerspectiveCamera(fov, 1, 0.01, 100);
  const setCamera = (matrix) => {
    camera.matrix.fromArray(matrix);
    camera.matrix.decompose(camera.position, camera.quaternion, camera.scale);
    camera.updateMatrixWorld(true);
  };
  return { renderer, camera, setCamera };
}
