import {
  CylinderGeometry,
  Float32BufferAttribute,
  Group,
  type Intersection,
  Matrix3,
  Mesh,
  MeshBasicMaterial,
  RingGeometry,
  Vector3,
} from "three";

import { kOverCase, kUponThings } from "../render/draw_order";

const kColor = 0x7fd8f2;
const kHeld = 0xffffff; // while something is
/** Where it meets nothing, m. */
const kLength = 0.8;
const kThickness = [0.0018, 0.0008] as const; // radius where it begins and ends, m
/** How much of it is seen at its beginning, a little after and at its end. */
const kOpacity = [0, 0.9, 0.35] as const;
const kAfter = 0.15;
/** Of the reticle, of what it is seen at: as large from near as from afar. */
const kReticle = 0.011;
/** Before what is met, m. */
const kBefore = 0.002;
const kForward = new Vector3(0, 0, 1);

/** What is met, as pointers tell of it. */
type Met = Pick<Intersection, "point" | "object" | "face"> & { normal?: Vector3 };

/** A rod of length 1 along −z, that is seen more or less along its way. */
function rod(): CylinderGeometry {
  const [begin, end] = kThickness;
  const geometry = new CylinderGeometry(begin, end, 1, 6, 8, true).rotateX(Math.PI / 2).translate(0, 0, -0.5);
  const positions = geometry.getAttribute("position");
  const colors = Array.from({ length: positions.count }, (_, i) => {
    const along = -positions.getZ(i);
    const [first, most, last] = kOpacity;
    const share = along < kAfter ? along / kAfter : (along - kAfter) / (1 - kAfter);
    return [1, 1, 1, along < kAfter ? first + share * (most - first) : most + share * (last - most)];
  });
  geometry.setAttribute("color", new Float32BufferAttribute(colors.flat(), 4));
  return geometry;
}

/** Where a hand points: a ray, and a ring that lies on what it meets. */
export class PointingRay {
  /** Along the hand's way of pointing. */
  readonly ray: Mesh<CylinderGeometry, MeshBasicMaterial>;
  /** In the room. */
  readonly reticle = new Group();
  readonly #ring: Mesh<RingGeometry, MeshBasicMaterial>;
  readonly #dot: Mesh<RingGeometry, MeshBasicMaterial>;
  readonly #normal = new Vector3(); // scratch
  readonly #turned = new Matrix3();

  constructor() {
    const material = { color: kColor, transparent: true, depthWrite: false };
    this.ray = new Mesh(rod(), new MeshBasicMaterial({ ...material, vertexColors: true }));
    const over = new MeshBasicMaterial({ ...material, depthTest: false });
    this.#ring = new Mesh(new RingGeometry(0.7, 1, 32), over);
    this.#dot = new Mesh(new RingGeometry(0, 0.28, 16), over);
    this.ray.renderOrder = kUponThings;
    this.#ring.renderOrder = this.#dot.renderOrder = kOverCase + 1;
    this.reticle.add(this.#ring, this.#dot);
    this.ray.intersectChildren = this.reticle.intersectChildren = false;
    this.ray.pointerEvents = "none";
    this.hide();
  }

  hide(): void {
    this.ray.visible = this.reticle.visible = false;
  }

  /** From where the hand is to what is met, or into nothing; `held`: it holds what it points at. */
  show(from: Vector3, direction: Vector3, met: Met | null, eye: Vector3, held: boolean): void {
    this.ray.visible = true;
    this.reticle.visible = met !== null;
    this.ray.scale.z = met ? met.point.distanceTo(from) : kLength;
    this.ray.material.color.set(held ? kHeld : kColor);
    this.#ring.material.color.copy(this.ray.material.color);
    this.#ring.scale.setScalar(held ? 0.7 : 1);
    if (met) {
      const normal = this.#normalOf(met, direction);
      this.reticle.quaternion.setFromUnitVectors(kForward, normal);
      this.reticle.position.copy(met.point).addScaledVector(normal, kBefore);
      this.reticle.scale.setScalar(kReticle * met.point.distanceTo(eye));
    }
  }

  dispose(): void {
    for (const { geometry, material } of [this.ray, this.#ring, this.#dot]) {
      geometry.dispose();
      material.dispose();
    }
  }

  /** Of what is met, towards the hand. */
  #normalOf({ normal, face, object }: Met, direction: Vector3): Vector3 {
    const out = this.#normal;
    if (normal) {
      out.copy(normal);
    } else if (face) {
      out.copy(face.normal).applyNormalMatrix(this.#turned.getNormalMatrix(object.matrixWorld));
    } else {
      out.copy(direction).negate();
    }
    return out.dot(direction) > 0 ? out.negate() : out;
  }
}
