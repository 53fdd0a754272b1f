import {
  AlwaysDepth,
  BufferAttribute,
  BufferGeometry,
  Camera,
  GLSL3,
  type IUniform,
  Mesh,
  NoBlending,
  RawShaderMaterial,
  Scene,
  Sphere,
  Vector3,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from "three";

import { shader } from "./shaders";

/** One triangle that covers everything: clip space from its corners. Among others it is sorted as a point of its object. */
export function fullScreenTriangle(): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute(
    "position",
    new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3),
  );
  geometry.boundingSphere = new Sphere(new Vector3(), 0);
  return geometry;
}

/** Of a shader, by their names there. */
export type Uniforms = Record<string, IUniform>;

/** Runs a fragment shader once for every pixel of a target; `depth`: which writes that, too. */
export class FullScreenPass<U extends Uniforms = Uniforms> {
  readonly uniforms: U;
  readonly #scene = new Scene();
  readonly #camera = new Camera();
  readonly #mesh: Mesh<BufferGeometry, RawShaderMaterial>;

  constructor(fragment: string, uniforms: U, defines: Record<string, number> = {}, depth = false) {
    this.uniforms = uniforms;
    const material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: shader("full_screen.vert.glsl"),
      fragmentShader: shader(fragment),
      uniforms,
      defines,
      depthTest: depth, // without a test none is written
      depthFunc: AlwaysDepth,
      depthWrite: depth,
      blending: NoBlending,
    });
    this.#mesh = new Mesh(fullScreenTriangle(), material);
    this.#mesh.frustumCulled = false;
    this.#scene.add(this.#mesh);
  }

  /** `target` null: the canvas. In a headset's frame too, where three.js would draw for its eyes. */
  render(renderer: WebGLRenderer, target: WebGLRenderTarget | null): void {
    const before = renderer.getRenderTarget();
    const { enabled } = renderer.xr;
    renderer.xr.enabled = false;
    renderer.setRenderTarget(target);
    renderer.render(this.#scene, this.#camera);
    renderer.setRenderTarget(before);
    renderer.xr.enabled = enabled;
  }

  dispose(): void {
    this.#mesh.geometry.dispose();
    this.#mesh.material.dispose();
  }
}
