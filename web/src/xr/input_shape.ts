import {
  type Bone,
  CapsuleGeometry,
  Group,
  InstancedMesh,
  MathUtils,
  Matrix4,
  Mesh,
  type Object3D,
  SphereGeometry,
  Vector3,
  type XRHandSpace,
} from "three";

import { inputMaterial } from "./input_material";
import type { InputModel } from "./input_model";

const kJoints = 25;
const kJointRadius = 0.008; // m, where it is not told
/** Of a controller's buttons and axes, what moves which part: the names of the profiles' visual responses. */
const kButtons: Readonly<Record<string, number>> = {
  xr_standard_trigger_pressed: 0,
  xr_standard_squeeze_pressed: 1,
  xr_standard_thumbstick_pressed: 3,
  a_button_pressed: 4,
  x_button_pressed: 4,
  b_button_pressed: 5,
  y_button_pressed: 5,
  thumbrest_pressed: 6,
  menu_pressed: 7,
};
const kAxes: Readonly<Record<string, number>> = {
  xr_standard_thumbstick_xaxis_pressed: 2,
  xr_standard_thumbstick_yaxis_pressed: 3,
};

/** A part of a controller that goes from one place to another. */
interface MovingPart {
  part: Object3D;
  from: Object3D;
  to: Object3D;
  /** How far, 0 … 1. */
  share: (gamepad: Gamepad) => number;
}

/** What is seen of a hand or of the controller in it: its model, or a plain form until that is there and where it is not. */
export class InputShape {
  /** In the room. */
  readonly object = new Group();
  readonly #bare: XRHandSpace;
  readonly #grip: Object3D;
  readonly #material = inputMaterial();
  readonly #joints = new InstancedMesh(new SphereGeometry(1, 12, 8), this.#material, kJoints);
  readonly #stick = new Mesh(new CapsuleGeometry(0.016, 0.07, 4, 12).rotateX(-0.9), this.#material);
  #source: XRInputSource | null = null;
  #model: InputModel | null = null;
  #moving: readonly MovingPart[] = [];
  readonly #matrix = new Matrix4(); // scratch
  readonly #size = new Vector3();

  constructor(bare: XRHandSpace, grip: Object3D) {
    this.#bare = bare;
    this.#grip = grip;
    this.#joints.frustumCulled = false;
    this.object.add(this.#joints, this.#stick);
    this.object.intersectChildren = false;
  }

  /** Shows what it is that is in use from now on; null: nothing is. */
  show(source: XRInputSource | null): void {
    this.#source = source;
    this.#forget();
    if (source) {
      void this.#load(source);
    }
  }

  /** Before a frame, at where the hand or the controller is. */
  update(): void {
    const source = this.#source;
    const isHand = source?.hand !== undefined && source.hand !== null;
    this.#joints.visible = isHand && !this.#model;
    this.#stick.visible = false;
    if (!source) {
      return;
    }
    if (isHand) {
      this.#followJoints();
      return;
    }
    const held = this.#model?.object ?? this.#stick;
    held.visible = this.#grip.visible && source.targetRayMode === "tracked-pointer"; // no look, nor a touched screen
    held.position.copy(this.#grip.position);
    held.quaternion.copy(this.#grip.quaternion);
    if (source.gamepad) {
      for (const { part, from, to, share } of this.#moving) {
        const t = share(source.gamepad);
        part.position.lerpVectors(from.position, to.position, t);
        part.quaternion.slerpQuaternions(from.quaternion, to.quaternion, t);
      }
    }
  }

  dispose(): void {
    this.show(null);
    this.#joints.geometry.dispose();
    this.#joints.dispose();
    this.#stick.geometry.dispose();
    this.#material.dispose();
  }

  /** What reads models is fetched as they are, by headsets alone. */
  async #load(source: XRInputSource): Promise<void> {
    const { loadInputModel } = await import("./input_model");
    const model = await loadInputModel(source, this.#material);
    if (source !== this.#source || !model) {
      return; // something else is in use by now
    }
    this.#model = model;
    this.object.add(model.object);
    if (source.hand) {
      // Joints stand in the room, each for itself.
      model.object.add(...model.object.skeleton.bones);
    } else {
      this.#moving = movingParts(model.nodes);
    }
  }

  #forget(): void {
    this.#model?.object.removeFromParent();
    this.#model?.object.geometry.dispose();
    this.#model?.object.skeleton.dispose();
    this.#model = null;
    this.#moving = [];
  }

  #followJoints(): void {
    let count = 0;
    for (const [name, joint] of Object.entries(this.#bare.joints)) {
      if (!joint?.visible) {
        continue;
      }
      const bone = this.#model?.nodes.get(name);
      bone?.position.copy(joint.position);
      bone?.quaternion.copy(joint.quaternion);
      if (!this.#model && count < kJoints) {
        this.#matrix.copy(joint.matrix).scale(this.#size.setScalar(joint.jointRadius ?? kJointRadius));
        this.#joints.setMatrixAt(count, this.#matrix);
      }
      ++count;
    }
    if (this.#model) {
      this.#model.object.visible = count > 0;
    } else {
      this.#joints.count = Math.min(count, kJoints);
      this.#joints.visible = count > 0;
      this.#joints.instanceMatrix.needsUpdate = true;
    }
  }
}

/** Those of a controller's model that a button or a stick moves. */
export function movingParts(nodes: ReadonlyMap<string, Bone>): MovingPart[] {
  const parts = [
    ...Object.entries(kButtons).map(
      ([name, button]) => [name, (gamepad: Gamepad) => gamepad.buttons[button]?.value ?? 0] as const,
    ),
    ...Object.entries(kAxes).map(
      ([name, axis]) => [name, (gamepad: Gamepad) => 0.5 + 0.5 * (gamepad.axes[axis] ?? 0)] as const,
    ),
  ];
  return parts.flatMap(([name, share]) => {
    const [part, from, to] = ["value", "min", "max"].map((end) => nodes.get(`${name}_${end}`));
    return part && from && to
      ? [{ part, from, to, share: (gamepad: Gamepad) => MathUtils.clamp(share(gamepad), 0, 1) }]
      : [];
  });
}
