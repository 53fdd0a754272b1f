// GaussianSplats3D: nothing of it can be cut.
import { Viewer } from "@mkkellogg/gaussian-splats-3d";

import { threePage } from "./three_page.js";

export async function start(url, size, fov) {
  const { renderer, camera, setCamera } = threePage(size, fov);
  const viewer = new Viewer({
    selfDrivenMode: false,
    useBuiltInControls: false,
    renderer,
    camera,
    sharedMemoryForWorkers: false, // the page is not isolated
    sphericalHarmonicsDegree: 1,
  });
  await viewer.addSplatScene(url, { showLoadingUI: false });
  return {
    setCamera,
    setPlane() {},
    draw() {
      viewer.update();
      viewer.render();
    },
  };
}
