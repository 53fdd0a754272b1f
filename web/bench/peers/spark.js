// Spark: a plane is an edit by a signed distance field, which acts on the centres of splats.
import { SparkRenderer, SplatEdit, SplatEditSdf, SplatEditSdfType, SplatMesh } from "@sparkjsdev/spark";
import { Quaternion, Scene, Vector3 } from "three";

import { threePage } from "./three_page.js";

export async function start(url, size, fov) {
  const { renderer, camera, setCamera } = threePage(size, fov);
  const scene = new Scene();
  scene.add(new SparkRenderer({ renderer }));
  const mesh = new SplatMesh({ url });
  await mesh.initialized;
  scene.add(mesh);
  const plane = new SplatEditSdf({ type: SplatEditSdfType.PLANE, opacity: 0 });
  const edit = new SplatEdit();
  edit.add(plane);
  const forward = new Vector3(0, 0, 1);
  return {
    setCamera,
    /** Keeps dot(normal, x) >= offset; null: all. */
    setPlane(cut) {
      if (!cut) {
        mesh.remove(edit);
        return;
      }
      const normal = new Vector3(...cut.normal);
      plane.position.copy(normal).multiplyScalar(cut.offset);
      plane.quaternion.copy(new Quaternion().setFromUnitVectors(forward, normal));
      mesh.add(edit);
    },
    draw: () => renderer.render(scene, camera),
  };
}
