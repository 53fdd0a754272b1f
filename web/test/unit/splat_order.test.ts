import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { Matrix4, PerspectiveCamera, Vector3, Vector4 } from "three";
import { beforeAll, describe, expect, it } from "vitest";

import type { LayerSwitch } from "../../src/model/states";
import {
  makeSceneCamera,
  type SceneCamera,
  setSceneCamera,
  writeSortView,
} from "../../src/render/scene_camera";
import { packScene, type PackedScene, parseSogMeta } from "../../src/sog/sog";
import { kClipOperators, kViewFloats } from "../../src/worker/protocol";
import { SplatOrder } from "../../src/worker/splat_order";
import { makeArchive, makeImages, makeMeta } from "./sog_fixture";

interface Splat {
  mean: Vector3;
  axes: [Vector3, Vector3, Vector3]; // R·S
  opacity: number;
}

/** Decodes a packed splat by the letter of docs/format.md. */
function decode(scene: PackedScene, i: number): Splat {
  const [x, y, z, w] = [...scene.packed.subarray(4 * i, 4 * i + 4)] as [number, number, number, number];
  const mean = [x & 0xffff, x >>> 16, y & 0xffff].map((q, k) => {
    const v = scene.meanMin[k]! + (q / 65535) * (scene.meanMax[k]! - scene.meanMin[k]!);
    return Math.sign(v) * (Math.exp(Math.abs(v)) - 1);
  });
  const small = [z & 255, (z >> 8) & 255, (z >> 16) & 255].map((b) => (b / 255 - 0.5) * Math.SQRT2);
  small.splice(z >>> 24, 0, Math.sqrt(Math.max(0, 1 - small.reduce((sum, c) => sum + c * c, 0))));
  const [qw, qx, qy, qz] = small as [number, number, number, number];
  const scales = [w & 255, (w >> 8) & 255, (w >> 16) & 255].map((index) => scene.scaleCodebook[index]!);
  const columns = [
    [1 - 2 * (qy * qy + qz * qz), 2 * (qx * qy + qw * qz), 2 * (qx * qz - qw * qy)],
    [2 * (qx * qy - qw * qz), 1 - 2 * (qx * qx + qz * qz), 2 * (qy * qz + qw * qx)],
    [2 * (qx * qz + qw * qy), 2 * (qy * qz - qw * qx), 1 - 2 * (qx * qx + qy * qy)],
  ];
  return {
    mean: new Vector3(...mean),
    axes: columns.map((c, k) => new Vector3(...c).multiplyScalar(scales[k]!)) as Splat["axes"],
    opacity: (w >>> 24) / 255,
  };
}

/** Whether the renderer's definition (method.md §2 and §3) leaves anything of a splat to be seen. */
function isVisible(splat: Splat, camera: SceneCamera, planes: Vector4[], clip: number): boolean {
  const t = splat.mean.clone().sub(camera.position).applyMatrix3(camera.rotation);
  let opacity = splat.opacity;
  for (const { x, y, z, w } of planes) {
    const normal = new Vector3(x, y, z);
    const d = normal.dot(splat.mean) - w;
    const deviation = Math.hypot(...splat.axes.map((a) => a.dot(normal)));
    if (clip === kClipOperators.soft) {
      opacity *= Math.min(1, Math.max(0, 0.5 + d / (2 * deviation)));
    }
    if ((clip === kClipOperators.hard && d < 0) || (clip === kClipOperators.exact && d < -3 * deviation)) {
      return false;
    }
  }
  if (opacity < 1 / 255 || t.z <= camera.near) {
    return false;
  }
  const reach = Math.sqrt(2 * Math.log(255 * opacity));
  return (["x", "y"] as const).every((axis) => {
    const limit = (1.3 * 0.5 * camera.size[axis]) / camera.focal[axis];
    const l = Math.min(limit, Math.max(-limit, t[axis] / t.z));
    const row = splat.axes.map((a) => {
      const v = a.clone().applyMatrix3(camera.rotation);
      return (camera.focal[axis] / t.z) * (v[axis] - l * v.z);
    });
    const extent = reach * Math.sqrt(row.reduce((sum, v) => sum + v * v, 0.1));
    const center = (camera.focal[axis] * t[axis]) / t.z + camera.principal[axis];
    return center + extent >= 0 && center - extent <= camera.size[axis];
  });
}

const kCount = 5000;
const meta = parseSogMeta(makeArchive(makeMeta(kCount)));
const scene = packScene(meta, makeImages(meta, 7));
const splats = Array.from({ length: kCount }, (_, i) => decode(scene, i));

function cameraAt(position: Vector3, target: Vector3, fov: number): SceneCamera {
  const camera = new PerspectiveCamera(fov, 1.5, 0.01, 10);
  camera.position.copy(position);
  camera.lookAt(target);
  camera.updateMatrixWorld();
  const result = makeSceneCamera();
  setSceneCamera(result, camera, new Matrix4(), 600, 400, 1000);
  return result;
}

describe("the WASM module", () => {
  let order: SplatOrder;
  beforeAll(async () => {
    const file = resolve(process.env["CLIPGS_WEB_OUT"] ?? "build", "splat_order.wasm");
    order = new SplatOrder(await WebAssembly.compile(readFileSync(file)));
    order.load(scene);
  });

  function sorted(
    camera: SceneCamera,
    planes: Vector4[],
    clip: number,
    leastPixels = 0,
    layers: LayerSwitch | null = null,
  ): number[] {
    const view = new Float32Array(kViewFloats);
    writeSortView(view, camera, planes, leastPixels, layers);
    const indices = new Uint32Array(kCount);
    return [...indices.subarray(0, order.sort(view, clip, indices))];
  }

  const cameras = {
    whole: cameraAt(new Vector3(0.1, 0.2, 0.9), new Vector3(), 40),
    near: cameraAt(new Vector3(0.1, 0.05, 0.28), new Vector3(0.1, 0, 0), 25),
    inside: cameraAt(new Vector3(0, 0, 0.05), new Vector3(0.1, 0.1, -0.1), 60),
  };
  const normal = new Vector3(0.3, -0.8, 0.5).normalize();
  const plane = new Vector4(...normal.toArray(), 0.02);
  const across = new Vector4(0.5, 0.5, Math.SQRT1_2, -0.05);
  const cuts = [[plane], [plane, across]];
  const shots = Object.entries(cameras).flatMap(([name, camera]) =>
    [0, 1, 2, 3].flatMap((clip) => cuts.map((planes) => ({ name, camera, clip, planes }))),
  );

  for (const { name, camera, clip, planes } of shots) {
    it(`keeps all that is visible, far to near (${name} camera, operator ${clip}, ${planes.length} planes)`, () => {
      const got = sorted(camera, planes, clip);
      expect(new Set(got).size).toBe(got.length);

      // Depths fall, but for what a step of the counting sort cannot tell apart.
      const depths = got.map(
        (i) => splats[i]!.mean.clone().sub(camera.position).applyMatrix3(camera.rotation).z,
      );
      const step = (Math.max(...depths) - Math.min(...depths)) / 65535;
      for (let k = 1; k < depths.length; ++k) {
        expect(depths[k - 1]! - depths[k]!).toBeGreaterThan(-1.01 * step - 1e-6);
      }

      // Nothing visible is lost, and culling is worth its while.
      const cut = clip === kClipOperators.none ? [] : planes;
      const visible = splats.flatMap((splat, i) => (isVisible(splat, camera, cut, clip) ? [i] : []));
      const kept = new Set(got);
      expect(visible.length).toBeGreaterThan(50);
      expect(visible.filter((i) => !kept.has(i))).toEqual([]);
      expect(got.length).toBeLessThan(1.5 * visible.length + 20);
    });
  }

  it("leaves out the splats whose layers are off, and no others", () => {
    const all = sorted(cameras.whole, [plane], kClipOperators.none);
    for (const sign of [1, -1] as const) {
      for (const slab of [-3, 0, 77, 199, 240]) {
        const got = sorted(cameras.whole, [plane], kClipOperators.layers, 0, { slab, sign });
        const on = all.filter((i) => sign * (scene.layers![i]! - slab) <= 0);
        expect(new Set(got)).toEqual(new Set(on));
        expect(got.length).toBe(on.length);
      }
    }
    expect(sorted(cameras.whole, [plane], kClipOperators.exact).length).toBeLessThan(all.length);
  });

  it("gives nothing when everything is cut away or behind", () => {
    expect(sorted(cameras.whole, [new Vector4(0, 0, 1, 5)], kClipOperators.exact)).toEqual([]);
    expect(sorted(cameraAt(new Vector3(0, 0, 2), new Vector3(0, 0, 4), 40), [plane], 0)).toEqual([]);
  });

  it("leaves out what reaches no farther than it is told", () => {
    const camera = cameras.whole;
    const all = sorted(camera, [plane], 0);
    const pixels = (i: number) => {
      const { mean, opacity } = splats[i]!;
      const w = scene.packed[4 * i + 3]!;
      const scales = [0, 8, 16].map((shift) => scene.scaleCodebook[(w >> shift) & 255]!);
      const depth = mean.clone().sub(camera.position).applyMatrix3(camera.rotation).z;
      const reach = Math.sqrt(2 * Math.log(255 * opacity));
      return (reach * Math.max(...scales) * camera.focal.x) / depth;
    };
    const sizes = all.map(pixels).sort((a, b) => a - b);
    const least = 0.5 * (sizes[sizes.length >> 1]! + sizes[(sizes.length >> 1) + 1]!);
    const got = sorted(camera, [plane], 0, least);
    expect(new Set(got)).toEqual(new Set(all.filter((i) => pixels(i) > least)));
    expect(got.length).toBeLessThan(0.6 * all.length);
  });

  it("takes another scene", () => {
    const few = parseSogMeta(makeArchive(makeMeta(3)));
    order.load(packScene(few, makeImages(few)));
    const got = sorted(cameras.whole, [plane], 0);
    expect(got.every((i) => i < 3)).toBe(true);
    order.load(scene);
  });
});
