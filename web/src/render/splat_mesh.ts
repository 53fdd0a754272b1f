import {
  BufferAttribute,
  CustomBlending,
  GLSL3,
  InstancedBufferGeometry,
  Matrix4,
  Mesh,
  OneFactor,
  OneMinusSrcAlphaFactor,
  type PerspectiveCamera,
  RawShaderMaterial,
  Vector2,
  Vector3,
  Vector4,
  type WebGLRenderer,
} from "three";

import type { Plane } from "../model/geometry";
import { type ClipOperator, kClipOperators } from "../worker/protocol";
import { FullScreenPass } from "./full_screen";
import type { GpuScene } from "./gpu_scene";
import { makeSceneCamera, type SceneCamera, setSceneCamera } from "./scene_camera";
import { shader } from "./shaders";

/** Quads drawn as one instance: an instance costs as much as many vertices on some drivers. */
const kQuadsPerInstance = 128;

function quads(): InstancedBufferGeometry {
  const corners = new Float32Array(kQuadsPerInstance * 12);
  const indices = new Uint16Array(kQuadsPerInstance * 6);
  for (let i = 0; i < kQuadsPerInstance; ++i) {
    corners.set([-1, -1, i, 1, -1, i, 1, 1, i, -1, 1, i], 12 * i);
    indices.set(
      [0, 2, 1, 0, 3, 2].map((k) => 4 * i + k),
      6 * i,
    ); // front faces where y points down
  }
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.instanceCount = 0;
  return geometry;
}

/** The picture's size in px that is being drawn: of the eye, the render target or the canvas. */
export function viewportSize(
  renderer: WebGLRenderer,
  camera: PerspectiveCamera & { viewport?: Vector4 },
  out: Vector2,
): void {
  const target = renderer.getRenderTarget();
  if (camera.viewport) {
    out.set(camera.viewport.z, camera.viewport.w);
  } else if (target) {
    out.set(target.width, target.height);
  } else {
    renderer.getDrawingBufferSize(out);
  }
}

/**
 * A scene's splats as an object of three.js: its matrix takes scene space to the world. The camera and the plane
 * of the frame being drawn are used as they are; only the order of the splats may be older.
 */
export class SplatMesh extends Mesh<InstancedBufferGeometry, RawShaderMaterial> {
  readonly #scene: GpuScene;
  readonly #mmPerUnit: number;
  readonly #camera: SceneCamera = makeSceneCamera();
  readonly #sizeScratch = new Vector2();
  readonly #sceneToPatient: Matrix4;
  readonly #colorPass: FullScreenPass;
  /** The plane in scene space; keeps xyz·x >= w. */
  readonly plane = new Vector4(0, 0, 1, 0);
  clip: number = kClipOperators.none;
  /** Splats in the current order. */
  drawn = 0;

  constructor(scene: GpuScene, sceneToPatient: Matrix4, mmPerUnit: number) {
    const camera = makeSceneCamera();
    const packedScene = { meanMin: new Vector3(...scene.meanMin), meanSize: new Vector3(...scene.meanSize) };
    super(
      quads(),
      new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: shader("splat.vert.glsl"),
        fragmentShader: shader("splat.frag.glsl"),
        defines: { kQuadsPerInstance },
        uniforms: {
          uScene: { value: scene.packed },
          uOrder: { value: scene.order },
          uColors: { value: scene.colors.texture },
          uScaleCodebook: { value: scene.scaleCodebook },
          uCount: { value: 0 },
          uPackedScene: { value: packedScene },
          uCamera: { value: camera },
          uDepthToClip: { value: new Vector2() },
          uPlane: { value: new Vector4() },
          uClip: { value: 0 },
        },
        transparent: true,
        depthWrite: false,
        blending: CustomBlending,
        blendSrc: OneFactor,
        blendDst: OneMinusSrcAlphaFactor,
      }),
    );
    this.#scene = scene;
    this.#camera = camera;
    this.#mmPerUnit = mmPerUnit;
    this.#sceneToPatient = sceneToPatient;
    this.#colorPass = new FullScreenPass("color.frag.glsl", {
      uScene: { value: scene.packed },
      uSh0: { value: scene.sh0 },
      uCentroids: { value: scene.centroids },
      uSh0Codebook: { value: scene.sh0Codebook },
      uShNCodebook: { value: scene.shNCodebook },
      uShCoefficients: { value: scene.shCoefficients },
      uPackedScene: { value: packedScene },
      uEye: { value: new Vector3(NaN, NaN, NaN) },
    });
    this.frustumCulled = false;
    this.matrixAutoUpdate = false;
    this.onBeforeRender = (renderer, _scene, viewer) => this.#update(renderer, viewer as PerspectiveCamera);
  }

  /** Cuts with `plane` (RAS mm), or not at all. */
  setClip(plane: Plane | null, operator: ClipOperator): void {
    if (!plane) {
      this.clip = kClipOperators.none;
      return;
    }
    this.clip = kClipOperators[operator];
    // n·(M x) − c = (Mᵀ(n, −c))·(x, 1), scaled so that the normal is a unit vector in scene space.
    const p = new Vector4(plane.normal.x, plane.normal.y, plane.normal.z, -plane.offset);
    p.applyMatrix4(this.#sceneToPatient.clone().transpose());
    p.divideScalar(Math.hypot(p.x, p.y, p.z));
    this.plane.set(p.x, p.y, p.z, -p.w);
  }

  /** The camera as the scene sees it, for a picture of width × height px. */
  sceneCamera(camera: PerspectiveCamera, width: number, height: number): SceneCamera {
    const result = makeSceneCamera();
    setSceneCamera(result, camera, this.matrixWorld, width, height, this.#mmPerUnit);
    return result;
  }

  /** Takes an order of `count` splats, far to near; returns the array that it replaces. */
  setOrder(order: Uint32Array, count: number): Uint32Array {
    const texture = this.#scene.order;
    const before = texture.image.data as unknown as Uint32Array;
    texture.image.data = order as unknown as typeof texture.image.data;
    texture.needsUpdate = true;
    this.drawn = count;
    this.material.uniforms["uCount"]!.value = count;
    this.geometry.instanceCount = Math.ceil(count / kQuadsPerInstance);
    return before;
  }

  /** Colours the splats as seen from `eye` (scene space), unless they are already. */
  updateColors(renderer: WebGLRenderer, eye: Vector3): void {
    const current = this.#colorPass.uniforms["uEye"]!.value as Vector3;
    if (!current.equals(eye)) {
      current.copy(eye);
      this.#colorPass.render(renderer, this.#scene.colors);
    }
  }

  /** Colours again at the next chance: the GPU has lost what it held. */
  invalidateColors(): void {
    (this.#colorPass.uniforms["uEye"]!.value as Vector3).set(NaN, NaN, NaN);
  }

  /** Frees what the GPU holds. */
  free(): void {
    this.geometry.dispose();
    this.material.dispose();
    this.#colorPass.dispose();
    this.#scene.dispose();
  }

  #update(renderer: WebGLRenderer, camera: PerspectiveCamera): void {
    const { uniforms } = this.material;
    viewportSize(renderer, camera, this.#sizeScratch);
    const scale = setSceneCamera(
      this.#camera,
      camera,
      this.matrixWorld,
      this.#sizeScratch.x,
      this.#sizeScratch.y,
      this.#mmPerUnit,
    );
    const p = camera.projectionMatrix.elements;
    (uniforms["uDepthToClip"]!.value as Vector2).set(-p[10]!, p[14]! / scale);
    (uniforms["uPlane"]!.value as Vector4).copy(this.plane);
    uniforms["uClip"]!.value = this.clip;
    this.material.uniformsNeedUpdate = true;
  }
}
