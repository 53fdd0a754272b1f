import {
  CombinedPointer,
  createGrabPointer,
  createRayPointer,
  type Pointer,
  type PointerEvent,
} from "@pmndrs/pointer-events";
import {
  CylinderGeometry,
  Group,
  InstancedMesh,
  type Intersection,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  type Object3D,
  type PerspectiveCamera,
  Ray,
  type Sphere,
  SphereGeometry,
  Vector3,
  type WebXRManager,
  type XRHandSpace,
  type XRTargetRaySpace,
} from "three";

/** What a hand reaches for from near, m. */
const kReach = 0.07;
/** Of the ray where it meets nothing, m. */
const kRayLength = 1.5;
/** Of a controller's buttons, A or X. */
const kMenuButton = 4;
/** Of its axes, forward and back; less than this share of the way is none. */
const kStickAxis = 3;
const kDeadZone = 0.15;
const kColor = 0x7fd8f2;
const kJoints = 25;
const kJointRadius = 0.008; // m, where it is not told

/** What is met first: what lies before others by its order, then what is nearest. */
function firstMet(a: Intersection, _orderA: unknown, b: Intersection): number {
  const order = ({ object }: Intersection) => object.pointerEventsOrder ?? 0;
  return order(b) - order(a) || a.distance - b.distance;
}

/** Something that is about to be laid out has no height yet: where it is met from near would be no number. */
function hasExtent(object: Object3D): boolean {
  return object.matrixWorld.determinant() !== 0;
}

/**
 * A hand in the headset, with a controller or bare: what it is near to or, where that is nothing, points at. Its trigger
 * or pinch goes to everything that listens, its grip button to `held` alone, and A or X calls `menu`.
 */
export class Hand {
  /** In the room. */
  readonly object = new Group();
  /** What it holds things with: null while neither a controller nor a hand is seen. */
  source: XRInputSource | null = null;
  /** The wrist of a bare hand, its y away from the back of the hand; not visible where none is seen. */
  readonly wrist = new Group();
  readonly #bare: XRHandSpace;
  readonly #near = new Group(); // where it takes hold
  readonly #far: XRTargetRaySpace;
  readonly #grip: Object3D;
  readonly #any: [Pointer, Pointer]; // from near, from afar
  readonly #hold: [Pointer, Pointer];
  readonly #pointers = new CombinedPointer(false);
  readonly #holders = new CombinedPointer(false);
  readonly #ray: Mesh;
  readonly #joints: InstancedMesh;
  readonly #held: Object3D;
  readonly #menu: () => void;
  #menuPressed = false;
  readonly #matrix = new Matrix4(); // scratch
  readonly #sight = new Ray();
  readonly #size = new Vector3();

  constructor(xr: WebXRManager, index: number, camera: PerspectiveCamera, held: Object3D, menu: () => void) {
    this.#held = held;
    this.#menu = menu;
    this.#far = xr.getController(index);
    this.#grip = xr.getControllerGrip(index);
    this.#bare = xr.getHand(index);
    const pointers = (): [Pointer, Pointer] => {
      // However long it is pressed: hands are slower than mice.
      const options = { customSort: firstMet, filter: hasExtent, clickThresholdMs: Infinity };
      return [
        createGrabPointer(() => camera, { current: this.#near }, this, { ...options, radius: kReach }),
        createRayPointer(() => camera, { current: this.#far }, this, options),
      ];
    };
    this.#any = pointers();
    this.#hold = pointers();
    this.#any.forEach((pointer, i) => this.#pointers.register(pointer, i === 1));
    this.#hold.forEach((pointer, i) => this.#holders.register(pointer, i === 1));
    const material = new MeshBasicMaterial({ color: kColor, transparent: true, opacity: 0.6 });
    this.#ray = new Mesh(
      new CylinderGeometry(0.0012, 0.0012, 1, 8).rotateX(Math.PI / 2).translate(0, 0, -0.5),
      material,
    );
    this.#joints = new InstancedMesh(new SphereGeometry(1, 12, 8), material, kJoints);
    this.#joints.frustumCulled = false;
    for (const part of [this.#ray, this.#joints]) {
      (part as Object3D & { pointerEvents?: string }).pointerEvents = "none";
      part.visible = false;
    }
    this.#far.add(this.#ray);
    this.wrist.visible = false;
    this.object.add(this.#far, this.#grip, this.#bare, this.#near, this.#joints, this.wrist);
    this.#listen(this.#far);
  }

  /**
   * Moves the pointers to where the hand is now; what they meet in `scene` hears of it. Of `crowd`, many parts in a
   * sphere, each is asked only where the hand may meet them.
   */
  update(scene: Object3D, timeStamp: number, crowd: { parts: Object3D; sphere: Sphere }): void {
    if (!this.source) {
      return;
    }
    const pressed = this.source.gamepad?.buttons[kMenuButton]?.pressed ?? false;
    if (pressed && !this.#menuPressed) {
      this.#menu();
    }
    this.#menuPressed = pressed;
    const bare = this.source.hand ? this.#showJoints() : false;
    this.wrist.visible = bare;
    if (!bare) {
      this.#near.position.copy(this.#grip.position);
      this.#near.quaternion.copy(this.#grip.quaternion);
    }
    this.object.updateMatrixWorld();
    crowd.parts.intersectChildren = this.#mayMeet(crowd.sphere);
    this.#pointers.move(scene, { timeStamp });
    this.#holders.move(this.#held, { timeStamp });
    const [, ray] = this.#any;
    const at = ray.getEnabled() ? ray.getIntersection() : undefined;
    this.#ray.visible = at !== undefined;
    this.#ray.scale.z =
      at && !(at.object as { isVoidObject?: boolean }).isVoidObject ? at.distance : kRayLength;
  }

  /** How far the controller's stick is pushed forward: −1 … 1. */
  get stick(): number {
    const back = this.source?.gamepad?.axes[kStickAxis] ?? 0;
    return Math.abs(back) > kDeadZone ? -back : 0;
  }

  /** Of a point before where it takes hold, m, its place in the room. */
  toRoom(point: Vector3): Vector3 {
    return point.applyMatrix4(this.#near.matrixWorld);
  }

  /** A tick that is felt, where the controller can: strength 0 … 1. */
  pulse(strength: number, milliseconds: number): void {
    void this.source?.gamepad?.hapticActuators?.[0]?.pulse(strength, milliseconds);
  }

  dispose(): void {
    for (const part of [this.#ray, this.#joints]) {
      part.geometry.dispose();
    }
    (this.#ray.material as MeshBasicMaterial).dispose();
    this.#joints.dispose();
  }

  /** Whether it is near to a sphere, or points at it. */
  #mayMeet(sphere: Sphere): boolean {
    const { origin, direction } = this.#sight;
    const near = sphere.distanceToPoint(origin.setFromMatrixPosition(this.#near.matrixWorld)) < kReach;
    origin.setFromMatrixPosition(this.#far.matrixWorld);
    direction.set(0, 0, -1).transformDirection(this.#far.matrixWorld);
    return near || this.#sight.intersectsSphere(sphere);
  }

  #listen(events: XRTargetRaySpace): void {
    events.addEventListener("connected", ({ data }) => (this.source = data));
    events.addEventListener("disconnected", () => {
      [...this.#any, ...this.#hold].forEach((pointer) => pointer.exit({ timeStamp: performance.now() }));
      this.source = null;
      this.#ray.visible = this.#joints.visible = this.wrist.visible = false;
    });
    for (const [name, pointers] of [
      ["select", this.#any],
      ["squeeze", this.#hold],
    ] as const) {
      const event = () => ({ timeStamp: performance.now(), button: 0 });
      events.addEventListener(`${name}start`, () => pointers.forEach((pointer) => pointer.down(event())));
      events.addEventListener(`${name}end`, () => pointers.forEach((pointer) => pointer.up(event())));
    }
  }

  /** Of a bare hand; it takes hold between thumb and forefinger. Returns whether they are seen. */
  #showJoints(): boolean {
    const { joints } = this.#bare;
    const thumb = joints["thumb-tip"];
    const finger = joints["index-finger-tip"];
    let count = 0;
    for (const joint of Object.values(joints)) {
      if (joint?.visible && count < kJoints) {
        this.#matrix.copy(joint.matrix).scale(this.#size.setScalar(joint.jointRadius ?? kJointRadius));
        this.#joints.setMatrixAt(count++, this.#matrix);
      }
    }
    this.#joints.count = count;
    this.#joints.visible = count > 0;
    this.#joints.instanceMatrix.needsUpdate = true;
    if (!thumb?.visible || !finger?.visible) {
      return false;
    }
    this.#near.position.lerpVectors(thumb.position, finger.position, 0.5);
    const wrist = joints.wrist ?? finger;
    this.#near.quaternion.copy(wrist.quaternion);
    this.wrist.position.copy(wrist.position);
    this.wrist.quaternion.copy(wrist.quaternion);
    return true;
  }
}

/** Whose an event is. */
export function handOf(event: PointerEvent | undefined): Hand | undefined {
  return event?.pointerState as Hand | undefined;
}
