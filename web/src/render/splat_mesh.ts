import {
  BufferAttribute,
  CustomBlending,
  type Data3DTexture,
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

import { areOpposite, kMaxPlanes } from "../model/cut";
import { type FaceGain, gainAt } from "../model/face_gain";
import type { Plane } from "../model/geometry";
import type { LayerSwitch } from "../model/states";
import type { Hull } from "../sog/hull";
import type { ToneCurve } from "../sog/section";
import { type ClipOperator, kClipOperators } from "../worker/protocol";
import type { DepthCue } from "./depth_cue";
import { FullScreenPass } from "./full_screen";
import { type GpuScene, kWidthBits } from "./gpu_scene";
import { makeSceneCamera, type SceneCamera, setSceneCamera } from "./scene_camera";
import { shader } from "./shaders";

/** Splats drawn as one instance: an instance costs as much as many vertices on some drivers. */
const kSplatsPerInstance = 128;

/** No splat is seen as far as this. */
const kAnyExtent = 10;

/**
 * Each splat is a triangle around its ellipse: it has two thirds more area than the ellipse, a rectangle a quarter, but
 * three corners instead of four and half the triangles, of which small splats cost more than of fragments.
 */
function triangles(): InstancedBufferGeometry {
  const reach = Math.sqrt(3);
  const corners = new Float32Array(kSplatsPerInstance * 9);
  for (let i = 0; i < kSplatsPerInstance; ++i) {
    corners.set([-reach, -1, i, 0, 2, i, reach, -1, i], 9 * i); // front faces where y points down
  }
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex(
    new BufferAttribute(
      Uint16Array.from({ length: 3 * kSplatsPerInstance }, (_, i) => i),
      1,
    ),
  );
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

/** Of splat.vert.glsl and splat.frag.glsl. */
function splatUniforms(scene: GpuScene, camera: SceneCamera, cue: DepthCue) {
  const packedScene = { meanMin: new Vector3(...scene.meanMin), meanSize: new Vector3(...scene.meanSize) };
  return {
    uScene: { value: scene.packed },
    uOrder: { value: scene.order },
    uColors: { value: scene.colors.texture },
    uScaleCodebook: { value: scene.scaleCodebook },
    uCount: { value: 0 },
    uPackedScene: { value: packedScene },
    uCamera: { value: camera },
    uCue: { value: cue.splats },
    uBackdrop: { value: cue.backdrop },
    uDepthToClip: { value: new Vector2() },
    uPlanes: { value: Array.from({ length: kMaxPlanes }, () => new Vector4()) },
    uPlaneCount: { value: 0 },
    uSlabs: { value: 0 },
    uClip: { value: 0 },
    uLayers: { value: scene.layers },
    uSlab: { value: 0 },
    uLayerSign: { value: 1 },
    uExtent: { value: kAnyExtent },
    uPixel: { value: 1 },
  };
}

type SplatUniforms = ReturnType<typeof splatUniforms>;

/** Of color.frag.glsl, which sees the same scene and planes. */
function colorUniforms(scene: GpuScene, splats: SplatUniforms) {
  const { uScene, uScaleCodebook, uPackedScene, uPlanes, uPlaneCount } = splats;
  return {
    uScene,
    uScaleCodebook,
    uPackedScene,
    uPlanes,
    uPlaneCount,
    uGains: { value: Array.from({ length: kMaxPlanes }, () => new Vector3(1, 1, 1)) },
    uSh0: { value: scene.sh0 },
    uCentroids: { value: scene.centroids },
    uSh0Codebook: { value: scene.sh0Codebook },
    uShNCodebook: { value: scene.shNCodebook },
    uShCoefficients: { value: scene.shCoefficients },
    uFaceLabels: { value: scene.faceLabels },
    uFacePalette: { value: scene.facePalette },
    uHasFaceColors: { value: scene.hasFaceColors },
    uEye: { value: new Vector3() },
    uSplatLight: {
      value: {
        changed: false,
        cellFromScene: new Matrix4(),
        cells: new Vector3(1, 1, 1),
        scale: 1,
        ownScale: 1,
        filmic: false,
      },
    },
    uLight: { value: null as Data3DTexture | null },
    uOwnLight: { value: null as Data3DTexture | null },
  };
}

/**
 * A scene's splats as an object of three.js: its matrix takes scene space to the world. The camera and the plane
 * of the frame being drawn are used as they are; only the order of the splats may be older.
 */
export class SplatMesh extends Mesh<InstancedBufferGeometry, RawShaderMaterial> {
  readonly #uniforms: SplatUniforms;
  readonly #scene: GpuScene;
  readonly #mmPerUnit: number;
  readonly #camera: SceneCamera; // of the frame that is drawn
  readonly #seen = makeSceneCamera(); // scratch
  readonly #sizeScratch = new Vector2();
  readonly #inverse = new Matrix4(); // scratch
  readonly #sceneToPatient: Matrix4;
  readonly #faceGain: FaceGain;
  readonly #colorPass: FullScreenPass<ReturnType<typeof colorUniforms>>;
  #colored = false; // as seen from uEye, with these planes
  /** Around the splats, in scene space. */
  readonly hull: Hull;
  /** The planes in scene space; each keeps xyz·x >= w. */
  planes: Vector4[] = [];
  clip: number = kClipOperators.none;
  /** CaseInfo's. */
  placed = false;
  /** How `planes` switch layers, where those are clipped by. */
  layerSwitch: LayerSwitch | null = null;
  /** Splats in the current order. */
  drawn = 0;

  constructor(
    scene: GpuScene,
    sceneToPatient: Matrix4,
    mmPerUnit: number,
    faceGain: FaceGain,
    hull: Hull,
    cue: DepthCue,
  ) {
    const camera = makeSceneCamera();
    const uniforms = splatUniforms(scene, camera, cue);
    super(
      triangles(),
      new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: shader("splat.vert.glsl"),
        fragmentShader: shader("splat.frag.glsl"),
        defines: { kSplatsPerInstance, kWidthBits, kPlanes: 1 },
        uniforms,
        transparent: true,
        depthWrite: false,
        blending: CustomBlending,
        blendSrc: OneFactor,
        blendDst: OneMinusSrcAlphaFactor,
      }),
    );
    this.#uniforms = uniforms;
    this.#scene = scene;
    this.#camera = camera;
    this.#mmPerUnit = mmPerUnit;
    this.#sceneToPatient = sceneToPatient;
    this.#faceGain = faceGain;
    this.hull = hull;
    this.#colorPass = new FullScreenPass("color.frag.glsl", colorUniforms(scene, uniforms), { kMaxPlanes });
    this.frustumCulled = false;
    this.matrixAutoUpdate = false;
    this.onBeforeRender = (renderer, _scene, viewer) => this.#update(renderer, viewer as PerspectiveCamera);
  }

  /**
   * Cuts with `planes` (RAS mm, as planesOf() gives them), of which all together keep what is kept. `layers`: how they
   * switch those; null: they are cut exactly if by layers.
   */
  setClip(planes: readonly Plane[], operator: ClipOperator, layers: LayerSwitch | null): void {
    const possible = operator === "layers" && !layers ? "exact" : operator;
    this.clip = planes.length > 0 ? kClipOperators[possible] : kClipOperators.none;
    this.layerSwitch = layers;
    const toScene = this.#sceneToPatient.clone().transpose();
    const { defines } = this.material;
    const uniforms = this.#uniforms;
    // n·(M x) − c = (Mᵀ(n, −c))·(x, 1), scaled so that the normal is a unit vector in scene space.
    const before = this.planes;
    this.planes = planes.map(({ normal, offset }) => {
      const p = new Vector4(normal.x, normal.y, normal.z, -offset).applyMatrix4(toScene);
      p.divideScalar(Math.hypot(p.x, p.y, p.z));
      return p.setW(-p.w);
    });
    if (before.length !== planes.length || !before.every((plane, i) => plane.equals(this.planes[i]!))) {
      this.#colored = false;
    }
    planes.forEach(({ normal }, i) => {
      uniforms.uPlanes.value[i]!.copy(this.planes[i]!);
      this.#colorPass.uniforms.uGains.value[i]!.copy(gainAt(this.#faceGain, normal));
    });
    uniforms.uPlaneCount.value = planes.length;
    uniforms.uSlab.value = layers?.slab ?? 0;
    uniforms.uLayerSign.value = layers?.sign ?? 1;
    uniforms.uSlabs.value = planes.reduce(
      (bits, plane, i) => (i > 0 && areOpposite(planes[i - 1]!, plane) ? bits | (1 << i) : bits),
      0,
    );
    // One plane costs no more than it did.
    const most = planes.length > 1 ? kMaxPlanes : 1;
    if (defines["kPlanes"] !== most) {
      defines["kPlanes"] = most;
      this.material.needsUpdate = true;
    }
  }

  /** The camera as the scene sees it, for a picture of width × height px: until this is asked again. */
  sceneCamera(camera: PerspectiveCamera, width: number, height: number): SceneCamera {
    setSceneCamera(this.#seen, camera, this.matrixWorld, width, height, this.#mmPerUnit);
    return this.#seen;
  }

  /** Standard deviations that splats are drawn to, at most. */
  set extent(extent: number) {
    this.#uniforms.uExtent.value = Math.min(extent, kAnyExtent);
    this.material.uniformsNeedUpdate = true;
  }

  /** Side of a pixel that is drawn, in those of the picture. */
  set pixel(pixel: number) {
    this.#uniforms.uPixel.value = pixel;
  }

  /** Takes a point of the world to scene space. */
  scenePoint(point: Vector3): Vector3 {
    return point.applyMatrix4(this.#inverse.copy(this.matrixWorld).invert());
  }

  /** Takes an order of `count` splats, far to near; returns the array that it replaces. */
  setOrder(order: Uint32Array, count: number): Uint32Array {
    const texture = this.#scene.order;
    const before = texture.image.data as unknown as Uint32Array;
    texture.image.data = order;
    texture.needsUpdate = true;
    this.drawn = count;
    this.#uniforms.uCount.value = count;
    this.geometry.instanceCount = Math.ceil(count / kSplatsPerInstance);
    return before;
  }

  /** Colours the splats as seen from `eye` (scene space), as they are cut now, unless they are already. */
  updateColors(renderer: WebGLRenderer, eye: Vector3): void {
    const current = this.#colorPass.uniforms.uEye.value;
    if (!this.#colored || !current.equals(eye)) {
      this.#colored = true;
      current.copy(eye);
      this.#colorPass.render(renderer, this.#scene.colors);
    }
  }

  /**
   * Takes the light of surfaces that the case was made in, of cells, in which 1 stands for `scale`, and the tone curve
   * of its pictures.
   */
  setOwnLight(
    own: Data3DTexture,
    scale: number,
    cells: readonly [number, number, number],
    cellFromPatient: Matrix4,
    tone: ToneCurve,
  ): void {
    const { uSplatLight, uOwnLight } = this.#colorPass.uniforms;
    uSplatLight.value.cellFromScene.multiplyMatrices(cellFromPatient, this.#sceneToPatient);
    uSplatLight.value.cells.set(...cells);
    uSplatLight.value.ownScale = scale;
    uSplatLight.value.filmic = tone === "filmic";
    uOwnLight.value = own;
  }

  /** What splats gain of this light, laid out as their own, is shown while `relit`. */
  setLight(light: Data3DTexture, scale: number): void {
    const { uSplatLight, uLight } = this.#colorPass.uniforms;
    uLight.value = light;
    uSplatLight.value.scale = scale;
    this.#colored = false;
  }

  set relit(relit: boolean) {
    const light = this.#colorPass.uniforms.uSplatLight.value;
    if (light.changed !== relit) {
      light.changed = relit;
      this.#colored = false;
    }
  }

  /** Colours again at the next chance: the GPU has lost what it held. */
  invalidateColors(): void {
    this.#colored = false;
  }

  /** Frees what the GPU holds. */
  free(): void {
    this.geometry.dispose();
    this.material.dispose();
    this.#colorPass.dispose();
    this.#scene.dispose();
  }

  #update(renderer: WebGLRenderer, camera: PerspectiveCamera): void {
    const uniforms = this.#uniforms;
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
    uniforms.uDepthToClip.value.set(-p[10], p[14] / scale);
    uniforms.uClip.value = this.clip;
    this.material.uniformsNeedUpdate = true;
  }
}
