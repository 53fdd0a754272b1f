import {
  CustomBlending,
  DepthTexture,
  GLSL3,
  HalfFloatType,
  LinearFilter,
  Mesh,
  OneFactor,
  OneMinusSrcAlphaFactor,
  type PerspectiveCamera,
  RawShaderMaterial,
  Scene,
  type Texture,
  UnsignedByteType,
  Vector2,
  Vector3,
  type Vector4,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";

import type { Picture } from "../api";
import { kClipOperators } from "../worker/protocol";
import { type DepthCue, makeBackdrop } from "./depth_cue";
import { FaceDepths, kMaxFaces } from "./face_depths";
import { FullScreenPass, fullScreenTriangle } from "./full_screen";
import { kHullDirections } from "../sog/hull";
import { KeptShare } from "./kept_share";
import { Outline } from "./outline";
import type { SectionFaces } from "./section_faces";
import { kColumns } from "./section_uniforms";
import { shader } from "./shaders";
import { Surface, tintBlock } from "./surface";
import type { SplatMesh } from "./splat_mesh";

/** The picture of what WebGL reads: rows from the bottom. */
export function pictureOf(rows: Uint8Array, width: number, height: number): Picture {
  const data = new Uint8ClampedArray(rows.length);
  for (let y = 0; y < height; ++y) {
    data.set(rows.subarray((height - 1 - y) * width * 4, (height - y) * width * 4), y * width * 4);
  }
  return { width, height, data };
}

/** A picture over black of what a depth cue leaves, by how much of it that is: as much less of its alpha. */
function faded(picture: Picture, left: Picture): Picture {
  const { data } = picture;
  for (let i = 0; i < data.length; i += 4) {
    const kept = left.data[i]! / 255;
    for (let c = i; c < i + 3; ++c) {
      data[c] = kept > 0 ? data[c]! / kept : 0; // clamped by the array
    }
    data[i + 3] = data[i + 3]! * kept;
  }
  return picture;
}

/** A picture that is read back: as the camera sees it in so many pixels, as for speed if `moving`. */
export interface Reading {
  camera: PerspectiveCamera;
  width: number;
  height: number;
  moving: boolean;
}

/** Side of a pixel of splats that need not be fine, in pixels, at most. */
const kMostCoarse = 4;

/** What a picture shows: the splats and, where they are not left to the splats, the exposed faces. */
export interface Subject {
  mesh: SplatMesh;
  faces: SectionFaces | null;
  cue: DepthCue;
}

/** Of composite.frag.glsl. */
function compositeUniforms(
  coarse: WebGLRenderTarget,
  faces: WebGLRenderTarget,
  keptShare: KeptShare,
  outline: Outline,
  surface: Surface | null,
) {
  return {
    uPicture: { value: null as Texture | null },
    uSplats: { value: coarse.texture },
    uIsCoarse: { value: false },
    uSize: { value: new Vector2() },
    uFaces: { value: faces.texture },
    uTexelsPerPixel: { value: new Vector2() },
    uCorner: { value: new Vector2() },
    ...keptShare.uniforms,
    ...outline.uniforms,
    ...(surface?.uniforms ?? {
      uHasSurface: { value: false },
      uSurfaceDepth: { value: null as Texture | null },
    }),
  };
}

type CompositeUniforms = ReturnType<typeof compositeUniforms>;

/**
 * The picture of splats and faces: drawn into a texture, and shown as an object that covers the canvas. It is drawn
 * again only when something changes. In half floats faint layers add up exactly; while something moves, bytes do, as in
 * a headset, which blend faster.
 */
export class SplatLayer {
  /** Put this into the scene of the canvas, … */
  readonly object: Mesh;
  /** … or this, where the body is among other things, into that of a headset, in the body's middle. */
  readonly solid: Mesh;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #still: WebGLRenderTarget; // splats and opaque faces
  readonly #moving: WebGLRenderTarget; // the same; of splats with an outline, opaque faces alone, and
  readonly #coarse: WebGLRenderTarget; // those splats
  readonly #faces: WebGLRenderTarget; // what is seen of splats behind these depends on what both cover
  readonly #keptShare = new KeptShare();
  readonly #outline = new Outline();
  readonly #surface: Surface | null;
  readonly #cover;
  readonly #uniforms: CompositeUniforms;
  readonly #faceDepths = new FaceDepths();
  readonly #solidUniforms = {
    uDepth: { value: null as DepthTexture | null },
    uMiddleDepth: { value: 1 },
    ...this.#faceDepths.uniforms,
    uToLinear: { value: false },
  };
  #outlined: SectionFaces | null = null; // that the object's material is made for, and
  #straight: FullScreenPass<CompositeUniforms> | null = null;

  constructor(renderer: WebGLRenderer) {
    this.#renderer = renderer;
    // Without the extension 8 bits must do.
    const hasHalfFloats = renderer.extensions.has("EXT_color_buffer_float");
    const type = hasHalfFloats ? HalfFloatType : UnsignedByteType;
    this.#surface = hasHalfFloats ? new Surface(renderer, this.#outline) : null;
    const filter = { minFilter: LinearFilter, magFilter: LinearFilter } as const;
    this.#still = new WebGLRenderTarget(1, 1, { type, ...filter, depthTexture: new DepthTexture(1, 1) });
    this.#moving = new WebGLRenderTarget(1, 1, { ...filter, depthTexture: new DepthTexture(1, 1) });
    this.#coarse = new WebGLRenderTarget(1, 1, { ...filter, depthTexture: new DepthTexture(1, 1) });
    this.#faces = new WebGLRenderTarget(1, 1, { type, ...filter, depthBuffer: false });
    this.#cover = new FullScreenPass(
      "cover.frag.glsl",
      { uDepth: { value: this.#moving.depthTexture }, uPixel: { value: new Vector2() } },
      {},
      true,
    );
    this.#uniforms = compositeUniforms(
      this.#coarse,
      this.#faces,
      this.#keptShare,
      this.#outline,
      this.#surface,
    );
    this.object = this.#mesh(false);
    this.solid = this.#mesh(true);
    (this.solid as Mesh & { pointerEvents?: string }).pointerEvents = "none";
    const middle = new Vector3();
    this.solid.onBeforeRender = (_renderer, _scene, camera) => {
      this.#solidUniforms.uMiddleDepth.value =
        0.5 + 0.5 * middle.setFromMatrixPosition(this.solid.matrixWorld).project(camera).z;
    };
  }

  #mesh(solid: boolean): Mesh {
    const mesh = new Mesh(fullScreenTriangle(), this.#material(solid));
    mesh.frustumCulled = false;
    return mesh;
  }

  /** Kept: browsers take long to compile it. */
  #straightPass(): FullScreenPass<CompositeUniforms> {
    const uniforms = {
      ...this.#uniforms,
      ...this.#outlined?.outlineUniforms,
      uTexelsPerPixel: { value: new Vector2() },
      uCorner: { value: new Vector2() },
    };
    return new FullScreenPass("composite.frag.glsl", uniforms, this.#defines({ kStraight: 1, kSolid: 0 }));
  }

  #material(solid: boolean): RawShaderMaterial {
    const uniforms = { ...this.#uniforms, ...this.#solidUniforms, ...this.#outlined?.outlineUniforms };
    return new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: shader("full_screen.vert.glsl"),
      fragmentShader: shader("composite.frag.glsl"),
      uniforms,
      defines: this.#defines({ kStraight: 0, kSolid: solid ? 1 : 0, kMaxFaces }),
      transparent: true,
      depthTest: solid,
      depthWrite: solid,
      blending: CustomBlending,
      blendSrc: OneFactor,
      blendDst: OneMinusSrcAlphaFactor,
    });
  }

  #defines(how: { kStraight: number; kSolid: number; kMaxFaces?: number }): Record<string, number> {
    const { section } = this.#outlined ?? {};
    return {
      ...how,
      kHullDirections,
      kOutlined: section ? 1 : 0,
      ...(section && { kChannels: section.channels, kColumns }),
    };
  }

  /** Draws at `scale` times the canvas's resolution; `moving`: for speed. */
  draw(subject: Subject, camera: PerspectiveCamera, scale: number, moving: boolean): void {
    const canvas = this.#renderer.getDrawingBufferSize(new Vector2());
    const width = Math.max(1, Math.round(canvas.x * scale));
    const height = Math.max(1, Math.round(canvas.y * scale));
    this.#color(subject, camera);
    this.#draw(subject, camera, moving ? this.#moving : this.#still, width, height);
    this.#show(0, 0, canvas.x, canvas.y);
  }

  /**
   * What an eye sees in a viewport of a picture, for speed unless it is `still`: `solid` shows it until another eye's is
   * drawn. The splats keep their colours.
   */
  drawEye(
    subject: Subject,
    eye: PerspectiveCamera,
    { x, y, z: width, w: height }: Vector4,
    still = false,
  ): void {
    const target = still ? this.#still : this.#moving;
    this.#draw(subject, eye, target, width, height);
    this.#solidUniforms.uDepth.value = target.depthTexture;
    this.#faceDepths.set(subject.mesh, subject.faces?.ends ?? [], eye);
    this.#show(x, y, width, height);
  }

  /** Whether `solid` is drawn into a picture of linear light; else its colours are display sRGB, as screens have them. */
  set toLinear(toLinear: boolean) {
    this.#solidUniforms.uToLinear.value = toLinear;
  }

  /** Shows what was drawn in so many pixels. */
  #show(x: number, y: number, width: number, height: number): void {
    this.#uniforms.uTexelsPerPixel.value.set(1 / width, 1 / height);
    this.#uniforms.uCorner.value.set(x, y);
  }

  /** Colours splats as `camera` sees them. */
  #color({ mesh }: Subject, camera: PerspectiveCamera): void {
    const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
    mesh.updateColors(this.#renderer, mesh.scenePoint(eye));
  }

  /**
   * The picture as `clipgs render` writes it. What a depth cue takes off is taken off its alpha: a picture of its own says
   * how much is left, for how splats hide those behind them must not change.
   */
  async read(subject: Subject, how: Reading): Promise<Picture> {
    const { cue } = subject;
    cue.setBackdrop(makeBackdrop(), 1);
    const drawn = this.#read(subject, how);
    if (cue.strength === 0) {
      return drawn;
    }
    cue.covering = true;
    const left = this.#read(subject, how);
    cue.covering = false;
    return faded(await drawn, await left);
  }

  /** Draws at once; what was drawn comes later. */
  async #read(subject: Subject, { camera, width, height, moving }: Reading): Promise<Picture> {
    this.#color(subject, camera);
    this.#draw(subject, camera, moving ? this.#moving : this.#still, width, height);
    const bytes = new WebGLRenderTarget(width, height, { depthBuffer: false });
    const straight = (this.#straight ??= this.#straightPass());
    straight.uniforms.uTexelsPerPixel.value.set(1 / width, 1 / height);
    straight.render(this.#renderer, bytes);
    const rows = new Uint8Array(width * height * 4);
    await this.#renderer.readRenderTargetPixelsAsync(bytes, 0, 0, width, height, rows);
    bytes.dispose();
    return pictureOf(rows, width, height);
  }

  /** The case is gone whose picture is still shown. */
  forget(): void {
    this.outlineBy(null);
    this.#surface?.forget();
  }

  dispose(): void {
    this.#still.dispose();
    this.#moving.dispose();
    this.#coarse.dispose();
    this.#cover.dispose();
    this.#faces.dispose();
    this.#surface?.dispose();
    for (const mesh of [this.object, this.solid]) {
      mesh.geometry.dispose();
      (mesh.material as RawShaderMaterial).dispose();
    }
    this.#straight?.dispose();
  }

  #draw(
    { mesh, faces, cue }: Subject,
    camera: PerspectiveCamera,
    target: WebGLRenderTarget,
    width: number,
    height: number,
  ): void {
    const seen = mesh.sceneCamera(camera, width, height);
    this.#keptShare.set(seen, mesh.clip === kClipOperators.exact ? mesh.planes : [], mesh.hull);
    const outlined = this.#setOutline(mesh, faces, camera);
    const block = faces ? this.#tintBlock(faces, camera, height) : 1;
    target.setSize(width, height);
    this.#uniforms.uPicture.value = target.texture;
    this.#uniforms.uSize.value.set(width, height);
    const isFine = target === this.#still || (!outlined && faces?.detail !== "splats");
    const coarse = isFine ? 1 : Math.min(block, kMostCoarse);
    const surfaced =
      outlined?.hasSurface && outlined.detail === "surface" && mesh.visible && !cue.covering
        ? outlined
        : null;
    const surfaceAlone = mesh.placed && surfaced !== null && this.#surface !== null;
    const isCoarse = faces !== null && coarse > 1 && !surfaceAlone;
    this.#uniforms.uIsCoarse.value = isCoarse;
    if (surfaceAlone) {
      this.#render(target, camera, [surfaced.opaque]);
    } else if (isCoarse) {
      this.#render(target, camera, [faces.opaque]);
      this.#drawCoarse(mesh, camera, width, height, coarse);
    } else {
      this.#render(target, camera, faces ? [mesh, faces.opaque] : [mesh]);
    }
    this.#faces.setSize(faces ? width : 1, faces ? height : 1);
    this.#render(this.#faces, camera, faces ? [faces.partial] : []);
    if (surfaced) {
      this.#surface?.draw(surfaced, camera, target, isCoarse ? this.#coarse : target, this.#faces, block);
    } else {
      this.#surface?.hide();
    }
  }

  /**
   * The splats behind opaque faces that #moving holds, in pixels of `coarse` times the side: what is fine is the
   * outline's and the surface's, and splats have learnt from pictures that were no finer.
   */
  #drawCoarse(
    mesh: SplatMesh,
    camera: PerspectiveCamera,
    width: number,
    height: number,
    coarse: number,
  ): void {
    const [columns, rows] = [Math.ceil(width / coarse), Math.ceil(height / coarse)];
    this.#coarse.setSize(columns, rows);
    this.#cover.uniforms.uPixel.value.set(width / columns, height / rows);
    this.#cover.render(this.#renderer, this.#coarse);
    mesh.pixel = coarse;
    this.#render(this.#coarse, camera, [mesh], false);
    mesh.pixel = 1;
  }

  /** Side of what splats tell colours by, pixels. */
  #tintBlock({ section }: SectionFaces, camera: PerspectiveCamera, height: number): number {
    return tintBlock(section, this.#outline.eye, (camera.projectionMatrix.elements[5] * height) / 2);
  }

  /** The outline is that of the volume where what is cut ends by the plane itself, as it does in the volume. Returns whose it is. */
  #setOutline(mesh: SplatMesh, faces: SectionFaces | null, camera: PerspectiveCamera): SectionFaces | null {
    this.outlineBy(faces);
    const byPlane = mesh.clip === kClipOperators.exact || mesh.planes.length === 0;
    const outlined = faces?.hasOutline && byPlane && faces.detail !== "splats" ? faces : null;
    this.#outline.uniforms.uHasOutline.value = outlined !== null;
    if (faces) {
      this.#outline.set(faces, camera);
    }
    return outlined;
  }

  /** Makes the material by which these faces are shown, if it is not that already; drawing does, too. */
  outlineBy(faces: SectionFaces | null): void {
    if (this.#outlined !== faces) {
      this.#outlined = faces;
      for (const mesh of [this.object, this.solid]) {
        (mesh.material as RawShaderMaterial).dispose();
        mesh.material = this.#material(mesh === this.solid);
      }
      this.#straight?.dispose();
      this.#straight = null;
    }
  }

  #render(
    target: WebGLRenderTarget,
    camera: PerspectiveCamera,
    objects: readonly Mesh[],
    depth = true,
  ): void {
    const renderer = this.#renderer;
    const before = renderer.getRenderTarget();
    objects.forEach((object) => this.#scene.add(object));
    renderer.setRenderTarget(target);
    renderer.clear(true, depth);
    renderer.render(this.#scene, camera);
    renderer.setRenderTarget(before);
    this.#scene.clear();
  }
}
