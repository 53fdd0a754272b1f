import { Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from "three";

import type { Viewer } from "../viewer";
import type { Hand } from "./hand";
import type { Stage } from "./stage";

/** Turned less than so many radians from where it was, the lamp is where it was: hands tremble. */
const kLeastTurn = 0.02;
const kRadius = 0.015; // m
/** Before the hand, m. */
const kAhead = new Vector3(0, 0, -0.06);

/** A lamp that a hand holds: it shines from there towards the case's middle. */
export class HeldLamp {
  /** In the room. */
  readonly object = new Mesh(new SphereGeometry(kRadius, 16, 12), new MeshBasicMaterial({ color: 0xffd36b }));
  /** That holds it. */
  hand: "left" | "right" | null = null;
  readonly #viewer: Viewer;
  readonly #stage: Stage;
  readonly #before = new Vector3();

  constructor(viewer: Viewer, stage: Stage) {
    this.#viewer = viewer;
    this.#stage = stage;
    (this.object as Mesh & { pointerEvents?: string }).pointerEvents = "none";
    this.object.visible = false;
  }

  /** Once a frame. */
  update(hands: readonly Hand[]): void {
    const holder = hands.find(({ source }) => source?.handedness === this.hand);
    const center = this.#viewer.info?.sphere.center;
    this.object.visible = holder !== undefined && center !== undefined;
    if (holder && center) {
      holder.toRoom(this.object.position.copy(kAhead));
      const from = this.#stage.toPatient(this.object.position).sub(center).normalize();
      const lamp = this.#viewer.state.lamp;
      if (!lamp || this.#before.set(...lamp).angleTo(from) > kLeastTurn) {
        this.#viewer.store.setLamp(from.toArray());
      }
    }
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
