import {
  BufferGeometry,
  Color,
  ConeGeometry,
  CustomBlending,
  CylinderGeometry,
  DoubleSide,
  GLSL3,
  Group,
  Matrix4,
  Mesh,
  OneFactor,
  OneMinusSrcAlphaFactor,
  PlaneGeometry,
  RawShaderMaterial,
  SphereGeometry,
  Vector3,
} from "three";

import { kWorldFromPatient, type Plane, projectOnto, type Sphere } from "../model/geometry";
import type { Grip } from "../model/plane_drag";
import { kBeforeSplats, kBehindSplats, kOnTop } from "./draw_order";
import type { Uniforms } from "./full_screen";
import { shader } from "./shaders";

const kColor = new Color(0.36, 0.84, 0.95); // display values, shown as they are
/** Sizes in radii of the bounding sphere. */
export const kRim = 0.98;
const kDisc = 1.1;
const kArrow = 0.3;
const kRimSamples = 256;

/** Two unit vectors in a plane, right-handed with its normal, with the second as upright as can be. */
export function tangents(normal: Vector3): [Vector3, Vector3] {
  const up = Math.abs(normal.z) < 0.999 ? new Vector3(0, 0, 1) : new Vector3(0, 1, 0);
  const x = new Vector3().crossVectors(up, normal).normalize();
  return [x, new Vector3().crossVectors(normal, x)];
}

function arrowMaterial(uniforms: Uniforms): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: shader("arrow.vert.glsl"),
    fragmentShader: shader("arrow.frag.glsl"),
    uniforms,
    transparent: true,
    blending: CustomBlending,
    blendSrc: OneFactor,
    blendDst: OneMinusSrcAlphaFactor,
  });
}

/**
 * The plane as a thing to take hold of: a glass disc with a rim (tilts) and an arrow towards the removed side (slides).
 * Everything kept lies on one side of the plane, so from the removed side the disc is in front of all splats and
 * from the kept side behind them all: no depth of splats is needed.
 */
export class PlaneWidget {
  /** In the viewer's world. */
  readonly object = new Group();
  readonly #disc: Mesh<BufferGeometry, RawShaderMaterial>;
  readonly #arrow = new Group();
  readonly #discUniforms = {
    uColor: { value: kColor },
    uRim: { value: kRim },
    uPixel: { value: 0.004 },
    uHover: { value: 0 },
  };
  readonly #arrowUniforms = { uColor: { value: kColor }, uHover: { value: 0 } };
  readonly #arrowMaterial = arrowMaterial(this.#arrowUniforms);
  #sphere: Sphere = { center: new Vector3(), radius: 1 };
  #plane: Plane | null = null;

  /** `amongThings`: whether there are others beside the case, before and behind it, as hands in a headset. */
  constructor(amongThings = false) {
    this.#disc = new Mesh(
      new PlaneGeometry(2 * kDisc, 2 * kDisc),
      new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: shader("plane.vert.glsl"),
        fragmentShader: shader("plane.frag.glsl"),
        uniforms: this.#discUniforms,
        side: DoubleSide,
        transparent: true,
        depthTest: amongThings,
        depthWrite: false,
        polygonOffset: amongThings, // before the face that lies in it
        polygonOffsetFactor: -1,
        polygonOffsetUnits: -2000,
        blending: CustomBlending,
        blendSrc: OneFactor,
        blendDst: OneMinusSrcAlphaFactor,
      }),
    );
    const stem = new Mesh(new CylinderGeometry(0.006, 0.006, kArrow, 16), this.#arrowMaterial);
    stem.rotation.x = -Math.PI / 2;
    stem.position.z = -0.5 * kArrow;
    const tip = new Mesh(new ConeGeometry(0.03, 0.085, 32), this.#arrowMaterial);
    tip.rotation.x = -Math.PI / 2;
    tip.position.z = -kArrow;
    const ball = new Mesh(new SphereGeometry(0.02, 24, 16), this.#arrowMaterial);
    this.#arrow.add(stem, tip, ball);
    for (const part of this.#arrow.children) {
      part.renderOrder = kOnTop;
    }
    this.object.add(this.#disc, this.#arrow);
    this.object.matrixAutoUpdate = false;
    this.object.visible = false;
  }

  /** The disc's centre: the plane's point nearest to the middle of the case, RAS mm. */
  get center(): Vector3 {
    return this.#plane ? projectOnto(this.#plane, this.#sphere.center) : this.#sphere.center.clone();
  }

  get radius(): number {
    return kRim * this.#sphere.radius;
  }

  /** Whether there is a plane. */
  get shown(): boolean {
    return this.#plane !== null;
  }

  setSphere(sphere: Sphere): void {
    this.#sphere = sphere;
  }

  /** Shows the plane (RAS mm), or nothing. */
  setPlane(plane: Plane | null): void {
    this.#plane = plane;
    this.object.visible = plane !== null;
    if (plane) {
      const [x, y] = tangents(plane.normal);
      const frame = new Matrix4()
        .makeBasis(x, y, plane.normal)
        .scale(new Vector3().setScalar(this.#sphere.radius));
      frame.setPosition(this.center);
      this.object.matrix.multiplyMatrices(kWorldFromPatient, frame);
      this.object.matrixWorldNeedsUpdate = true;
    }
  }

  setHover(grip: Grip | null): void {
    this.#discUniforms.uHover.value = grip === "rim" ? 1 : 0;
    this.#arrowUniforms.uHover.value = grip === "arrow" ? 1 : 0;
  }

  /** Before drawing: from where it is looked at (RAS mm), and the tangent of a pixel's angle. */
  update(eye: Vector3, pixelAngle: number): void {
    if (!this.#plane) {
      return;
    }
    const removedSide = this.#plane.normal.dot(eye) < this.#plane.offset;
    this.#disc.renderOrder = removedSide ? kBeforeSplats : kBehindSplats;
    const pixel = eye.distanceTo(this.#sphere.center) * pixelAngle;
    this.#discUniforms.uPixel.value = pixel / this.#sphere.radius;
  }

  /**
   * What lies within `reach` of (x, y), given how RAS points appear in CSS px (null: behind the camera): the arrow, before
   * the rim that may pass behind it.
   */
  gripAt(
    x: number,
    y: number,
    reach: number,
    project: (point: Vector3) => { x: number; y: number } | null,
  ): Grip | null {
    if (!this.#plane) {
      return null;
    }
    const { center } = this;
    const distance = (point: Vector3): number => {
      const at = project(point);
      return at ? Math.hypot(at.x - x, at.y - y) : Infinity;
    };
    const kArrowSamples = 8;
    for (let i = 0; i <= kArrowSamples; ++i) {
      const along = (-1.1 * kArrow * this.#sphere.radius * i) / kArrowSamples;
      if (distance(center.clone().addScaledVector(this.#plane.normal, along)) < reach) {
        return "arrow";
      }
    }
    const [u, v] = tangents(this.#plane.normal);
    let nearest = Infinity;
    for (let i = 0; i < kRimSamples; ++i) {
      const angle = (2 * Math.PI * i) / kRimSamples;
      const point = center.clone().addScaledVector(u, this.radius * Math.cos(angle));
      nearest = Math.min(nearest, distance(point.addScaledVector(v, this.radius * Math.sin(angle))));
    }
    return nearest < reach ? "rim" : null;
  }

  dispose(): void {
    this.object.traverse((part) => {
      if (part instanceof Mesh) {
        (part.geometry as BufferGeometry).dispose();
      }
    });
    this.#disc.material.dispose();
    this.#arrowMaterial.dispose();
  }
}
