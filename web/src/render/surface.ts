import {
  DepthTexture,
  HalfFloatType,
  LinearFilter,
  type PerspectiveCamera,
  type Texture,
  Vector2,
  Vector3,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";

import { gridMiddle } from "../model/faces";
import type { Section } from "../sog/section";
import { FullScreenPass } from "./full_screen";
import type { Outline } from "./outline";
import type { SectionFaces } from "./section_faces";
import { kColumns } from "./section_uniforms";

/** Rays a pixel, as `clipgs render` has them; while something moves, one. */
const kRays = 4;

/** Of the half diagonal of a section: the side of a block, and its most, pixels (src/section/tint.cpp). */
const kBlockShare = 1 / 110;
const kMostBlock = 16;

/** Of surface.frag.glsl. */
function surfaceUniforms(faces: SectionFaces, outline: Outline) {
  return {
    ...faces.surfaceUniforms,
    uOutline: outline.uniforms.uOutline,
    uDepth: { value: null as DepthTexture | null },
    uSize: { value: new Vector2() },
    uPixel: { value: 1 },
    uRays: { value: 1 },
    uDepthToClip: { value: new Vector2() },
  };
}

type SurfaceUniforms = ReturnType<typeof surfaceUniforms>;

/**
 * The surface of a section's volume, and the means by which splats tint it, as uniforms of composite.frag.glsl: the
 * twin of draw_surface() and tinted() in src/section/.
 */
export class Surface {
  readonly #renderer: WebGLRenderer;
  readonly #outline: Outline;
  readonly #surface: WebGLRenderTarget;
  readonly #means: WebGLRenderTarget;
  readonly #tint;
  readonly uniforms;
  #pass: { of: SectionFaces; draw: FullScreenPass<SurfaceUniforms> } | null = null;

  constructor(renderer: WebGLRenderer, outline: Outline) {
    this.#renderer = renderer;
    this.#outline = outline;
    const filter = { minFilter: LinearFilter, magFilter: LinearFilter } as const;
    this.#surface = new WebGLRenderTarget(1, 1, { ...filter, depthTexture: new DepthTexture(1, 1) });
    this.#means = new WebGLRenderTarget(1, 1, {
      ...filter,
      depthBuffer: false,
      type: HalfFloatType,
      count: 2,
    });
    this.#tint = new FullScreenPass("tint.frag.glsl", {
      uSplats: { value: null as Texture | null },
      uFaces: { value: null as Texture | null },
      uSurface: { value: this.#surface.texture },
      uBlock: { value: 1 },
      uStep: { value: 1 },
    });
    const [splats, surface] = this.#means.textures;
    this.uniforms = {
      uHasSurface: { value: false },
      uSurface: { value: this.#surface.texture },
      uSurfaceDepth: { value: this.#surface.depthTexture },
      uTintSplats: { value: splats },
      uTintSurface: { value: surface },
      uTintBlock: { value: 1 },
    };
  }

  /** Draws none. */
  hide(): void {
    this.uniforms.uHasSurface.value = false;
  }

  /**
   * Of what the outline's camera sees in a picture's pixels, in splats' colours: those of `splats`, which may be smaller,
   * behind faces, told by blocks of `block` px.
   */
  draw(
    faces: SectionFaces,
    camera: PerspectiveCamera,
    picture: WebGLRenderTarget,
    splats: WebGLRenderTarget,
    front: WebGLRenderTarget,
    block: number,
  ): void {
    const { width, height } = picture;
    const draw = this.#passOf(faces);
    const [columns, rows] = [width, height].map((side) => Math.ceil(side / faces.surfacePixel)) as [
      number,
      number,
    ];
    draw.uniforms.uSize.value.set(columns, rows);
    draw.uniforms.uPixel.value = faces.surfacePixel;
    draw.uniforms.uDepth.value = picture.depthTexture;
    draw.uniforms.uRays.value = faces.fine ? kRays : 1;
    const p = camera.projectionMatrix.elements;
    draw.uniforms.uDepthToClip.value.set(-p[10], 1000 * p[14]);
    this.#surface.setSize(columns, rows);
    draw.render(this.#renderer, this.#surface);
    this.#means.setSize(Math.ceil(width / block), Math.ceil(height / block));
    this.#tint.uniforms.uSplats.value = splats.texture;
    this.#tint.uniforms.uFaces.value = front.texture;
    this.#tint.uniforms.uBlock.value = block;
    this.#tint.uniforms.uStep.value = faces.surfacePixel;
    this.#tint.render(this.#renderer, this.#means);
    this.uniforms.uTintBlock.value = block;
    this.uniforms.uHasSurface.value = true;
  }

  /** The case is gone. */
  forget(): void {
    this.hide();
    this.#pass?.draw.dispose();
    this.#pass = null;
  }

  dispose(): void {
    this.forget();
    this.#tint.dispose();
    this.#surface.dispose();
    this.#means.dispose();
  }

  /** Kept: browsers take long to compile it. */
  #passOf(faces: SectionFaces): FullScreenPass<SurfaceUniforms> {
    if (this.#pass?.of !== faces) {
      this.forget();
      const uniforms = surfaceUniforms(faces, this.#outline);
      const { channels, tone } = faces.section;
      const defines = { kChannels: channels, kFilmic: tone === "filmic" ? 1 : 0, kColumns };
      this.#pass = { of: faces, draw: new FullScreenPass("surface.frag.glsl", uniforms, defines, true) };
    }
    return this.#pass.draw;
  }
}

/** Side of the blocks that tint is told by, pixels, seen from `eye` (RAS mm) at a focal length in pixels. */
export function tintBlock(section: Section, eye: Vector3, focal: number): number {
  const extent = new Vector3(...section.dims).subScalar(1).multiply(new Vector3(...section.spacing));
  const radius = 0.5 * extent.length();
  const distance = Math.max(eye.distanceTo(gridMiddle(section)), 0.01 * radius);
  return Math.round(Math.min(Math.max((kBlockShare * focal * radius) / distance, 1), kMostBlock));
}
