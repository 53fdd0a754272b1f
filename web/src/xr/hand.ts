import {
  CombinedPointer,
  createGrabPointer,
  createRayPointer,
  type Pointer,
  type PointerEvent,
} from "@pmndrs/pointer-events";
import {
  Group,
  type Intersection,
  type Object3D,
  type PerspectiveCamera,
  Ray,
  type Sphere,
  Vector3,
  type WebXRManager,
  type XRHandSpace,
  type XRTargetRaySpace,
} from "three";

import { isHandle } from "./bounds_control";
import { InputShape } from "./input_shape";
import { PointingRay } from "./pointing_ray";
import { Poke } from "./poke";

/** What a hand reaches for from near, m. */
const kReach = 0.07;
/** Of a controller's buttons, A or X. */
const kMenuButton = 4;
/** Of its axes, to the right and back; less than this share of the way is none. */
const kStickAxes = [2, 3] as const;
const kDeadZone = 0.15;

/** What is met first: what lies before others by its order, then what is nearest. */
function firstMet(a: Intersection, _orderA: unknown, b: Intersection): number {
  return orderOf(b.object) - orderOf(a.object) || a.distance - b.distance;
}

/** The same from near; but handles are small, and meant where they are what is nearest. */
function firstAtHand(a: Intersection, order: unknown, b: Intersection): number {
  const atHandle = isHandle(a.object) || isHandle(b.object);
  return atHandle ? a.distance - b.distance : firstMet(a, order, b);
}

function orderOf(object: Object3D): number {
  return object.pointerEventsOrder ?? 0;
}

/** Whether a pointer was at something in the last frame. */
function meets(pointer: Pointer): boolean {
  const at = pointer.getIntersection();
  return at !== undefined && !(at.object as { isVoidObject?: boolean }).isVoidObject;
}

/** Something that is about to be laid out has no height yet: where it is met from near would be no number. */
function hasExtent(object: Object3D): boolean {
  return object.matrixWorld.determinant() !== 0;
}

/**
 * A hand in the headset, with a controller or bare: what it is near to or, where that is nothing, points at. Its trigger
 * or pinch goes to everything that listens, its grip button to `held` alone, its fingertip to buttons, and A or X calls
 * `menu`.
 */
export class Hand {
  /** In the room. */
  readonly object = new Group();
  /** What it holds things with: null while neither a controller nor a hand is seen. */
  source: XRInputSource | null = null;
  /** The wrist of a bare hand, its y away from the back of the hand; not visible where none is seen. */
  readonly wrist = new Group();
  /** Its palm offers a menu: it points at nothing meanwhile. */
  offering = false;
  readonly #bare: XRHandSpace;
  readonly #near = new Group(); // where it takes hold
  readonly #far: XRTargetRaySpace;
  readonly #grip: Object3D;
  readonly #any: [Pointer, Pointer]; // from near, from afar
  readonly #hold: [Pointer, Pointer];
  readonly #pointers = new CombinedPointer(false);
  readonly #holders = new CombinedPointer(false);
  readonly #poke: Poke;
  readonly #ray = new PointingRay();
  readonly #shape: InputShape;
  readonly #held: Object3D;
  readonly #menu: () => void;
  #menuPressed = false;
  #pressed = 0; // buttons
  readonly #sight = new Ray(); // scratch

  constructor(xr: WebXRManager, index: number, camera: PerspectiveCamera, held: Object3D, menu: () => void) {
    this.#held = held;
    this.#menu = menu;
    this.#far = xr.getController(index);
    this.#grip = xr.getControllerGrip(index);
    this.#bare = xr.getHand(index);
    const pointers = (): [Pointer, Pointer] => {
      // However long it is pressed: hands are slower than mice.
      const options = { filter: hasExtent, clickThresholdMs: Infinity };
      const near = createGrabPointer(() => camera, { current: this.#near }, this, {
        ...options,
        customSort: firstAtHand,
        radius: kReach,
      });
      const far = createRayPointer(() => camera, { current: this.#far }, this, {
        ...options,
        customSort: firstMet,
        // What a hand is at it takes, not what lies closely behind that; parts of panels are told apart by the ray.
        filter: (object) => hasExtent(object) && (orderOf(object) > 0 || !meets(near)),
      });
      return [near, far];
    };
    this.#any = pointers();
    this.#hold = pointers();
    this.#any.forEach((pointer, i) => this.#pointers.register(pointer, i === 1));
    this.#hold.forEach((pointer, i) => this.#holders.register(pointer, i === 1));
    this.#poke = new Poke(this, camera);
    this.#shape = new InputShape(this.#bare, this.#grip);
    this.#far.add(this.#ray.ray);
    this.wrist.visible = false;
    this.object.add(this.#far, this.#grip, this.#bare, this.#near, this.#poke.tip, this.wrist);
    this.object.add(this.#shape.object, this.#ray.reticle);
    this.#listen(this.#far);
  }

  /**
   * Moves the pointers to where the hand is now; what they meet in `scene`, seen from `eye`, hears of it. Of `crowd`, many
   * parts in a sphere, each is asked only where the hand may meet them.
   */
  update(scene: Object3D, timeStamp: number, crowd: { parts: Object3D; sphere: Sphere }, eye: Vector3): void {
    this.#shape.update();
    if (!this.source) {
      this.#ray.hide();
      return;
    }
    const pressed = this.source.gamepad?.buttons[kMenuButton]?.pressed ?? false;
    if (pressed && !this.#menuPressed) {
      this.#menu();
    }
    this.#menuPressed = pressed;
    const bare = this.source.hand ? this.#followJoints() : false;
    this.wrist.visible = bare;
    if (!bare) {
      this.#near.position.copy(this.#grip.position);
      this.#near.quaternion.copy(this.#grip.quaternion);
      this.#poke.tip.position.copy(this.#far.position);
    }
    this.object.updateMatrixWorld();
    crowd.parts.intersectChildren = this.#mayMeet(crowd.sphere);
    this.#poke.update(scene, timeStamp, bare || !this.source.hand);
    if (this.offering) {
      this.#endPointing(timeStamp);
      this.#ray.hide();
      return;
    }
    this.#pointers.move(scene, { timeStamp });
    this.#holders.move(this.#held, { timeStamp });
    this.#showRay(eye);
  }

  /** Whether its trigger, pinch or grip is pressed. */
  get isPressing(): boolean {
    return this.#pressed > 0;
  }

  /** How far the controller's stick is pushed to the right and forward: −1 … 1. */
  get stick(): { right: number; forward: number } {
    const [right, back] = kStickAxes.map((axis) => {
      const value = this.source?.gamepad?.axes[axis] ?? 0;
      return Math.abs(value) > kDeadZone ? value : 0;
    });
    return { right: right!, forward: -back! };
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
    this.#shape.dispose();
    this.#ray.dispose();
  }

  #showRay(eye: Vector3): void {
    const [, ray] = this.#any;
    const at = ray.getEnabled() && !this.#poke.isPressing ? ray.getIntersection() : undefined;
    if (!at) {
      this.#ray.hide();
      return;
    }
    const { origin, direction } = this.#aim();
    const isMet = !(at.object as { isVoidObject?: boolean }).isVoidObject;
    this.#ray.show(origin, direction, isMet ? at : null, eye, this.isPressing);
  }

  /** Where it points. */
  #aim(): Ray {
    this.#sight.origin.setFromMatrixPosition(this.#far.matrixWorld);
    this.#sight.direction.set(0, 0, -1).transformDirection(this.#far.matrixWorld);
    return this.#sight;
  }

  /** Whether it is near to a sphere, or points at it. */
  #mayMeet(sphere: Sphere): boolean {
    const place = this.#sight.origin.setFromMatrixPosition(this.#near.matrixWorld);
    return sphere.distanceToPoint(place) < kReach || this.#aim().intersectsSphere(sphere);
  }

  #listen(events: XRTargetRaySpace): void {
    events.addEventListener("connected", ({ data }) => this.#use(data));
    events.addEventListener("disconnected", () => {
      this.#endPointing(performance.now());
      this.#poke.cancel(performance.now());
      this.#pressed = 0;
      this.wrist.visible = false;
      this.#use(null);
    });
    for (const [name, pointers] of [
      ["select", this.#any],
      ["squeeze", this.#hold],
    ] as const) {
      const event = () => ({ timeStamp: performance.now(), button: 0 });
      events.addEventListener(`${name}start`, () => {
        ++this.#pressed;
        pointers.forEach((pointer) => pointer.down(event()));
      });
      events.addEventListener(`${name}end`, () => {
        this.#pressed = Math.max(0, this.#pressed - 1);
        pointers.forEach((pointer) => pointer.up(event()));
      });
    }
  }

  #endPointing(timeStamp: number): void {
    [...this.#any, ...this.#hold].forEach((pointer) => pointer.exit({ timeStamp }));
  }

  #use(source: XRInputSource | null): void {
    this.source = source;
    this.#shape.show(source);
  }

  /** Where a bare hand takes hold, and its fingertip; false: it is not seen. */
  #followJoints(): boolean {
    const { joints } = this.#bare;
    const thumb = joints["thumb-tip"];
    const finger = joints["index-finger-tip"];
    if (!thumb?.visible || !finger?.visible) {
      return false;
    }
    this.#near.position.lerpVectors(thumb.position, finger.position, 0.5);
    this.#poke.tip.position.copy(finger.position);
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
