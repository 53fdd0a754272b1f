import type { Page } from "playwright-core";
import { Matrix4, Quaternion, Vector3 } from "three";

import type { Triple } from "../../src/model/geometry";

/** Of a hand from what it points at, m: too far to reach it. */
const kPointingDistance = 0.3;

export type Side = "left" | "right";

/** Somebody with the emulated headset on (session.ts): who moves its controllers and hands, and presses. */
export class Wearer {
  readonly #page: Page;
  #bare = false;

  constructor(page: Page) {
    this.#page = page;
  }

  /** Puts it on, unless it is, and stands straight. */
  async wear(): Promise<void> {
    const page = this.#page;
    if (!(await page.evaluate(() => window.clipgs.headset.worn))) {
      await page.getByTitle("Show it in the headset (V)").waitFor();
      await page.keyboard.press("v");
      await page.waitForFunction(() => window.clipgs.headset.worn);
    }
    await this.stand([0, 1.6, 0]);
    await this.frames(3);
  }

  /** Stands with the head at a place of the room, bent up by an angle. */
  async stand([x, y, z]: Triple, pitch = 0): Promise<void> {
    await this.#page.evaluate(
      ([position, angle]) => {
        window.headset.position.set(...position);
        window.headset.quaternion.set(Math.sin(angle / 2), 0, 0, Math.cos(angle / 2));
      },
      [[x, y, z] as Triple, pitch] as const,
    );
    await this.frames(2);
  }

  /** Waits until the headset has drawn so many pictures. */
  async frames(count: number): Promise<void> {
    await this.#page.evaluate(async (n) => {
      for (let i = 0; i < n; ++i) {
        await new Promise(requestAnimationFrame);
      }
    }, count);
  }

  /** Of a controller. */
  async press(
    side: Side,
    button: "trigger" | "squeeze" | "a-button" | "x-button",
    value: 0 | 1,
  ): Promise<void> {
    await this.#page.evaluate(
      ([which, name, pressed]) => window.headset.controllers[which]!.updateButtonValue(name, pressed),
      [side, button, value] as const,
    );
    await this.frames(2);
  }

  /** Points at a text of the panel, which may take a moment to be there, and presses. */
  async pressText(side: Side, text: string): Promise<void> {
    const page = this.#page;
    await page.waitForFunction((wanted) => window.clipgs.headset.find(wanted) !== null, text);
    await this.frames(1); // it is where it stays
    await this.pressAt(side, await page.evaluate((wanted) => window.clipgs.headset.find(wanted)!, text));
  }

  /** Points at a place in the room, m, from before it, and presses and lets go the trigger, or pinches. */
  async pressAt(side: Side, place: Triple): Promise<void> {
    await this.pointAt(side, place);
    await this.hold(side, 1);
    await this.hold(side, 0);
  }

  /** Points at a place in the room, m, from before it. */
  async pointAt(side: Side, place: Triple): Promise<void> {
    const eye = await this.#page.evaluate(() => {
      const { x, y, z } = window.headset.position;
      return [x, y, z] as Triple;
    });
    const at = new Vector3(...place);
    const hand = new Vector3(...eye).sub(at).setLength(kPointingDistance).add(at);
    const turn = new Matrix4().lookAt(hand, at, new Vector3(0, 1, 0));
    await this.reach(side, hand, new Quaternion().setFromRotationMatrix(turn));
  }

  /** Moves what is in use, a controller or a bare hand. */
  async reach(side: Side, position: Vector3, quaternion = new Quaternion()): Promise<void> {
    await this.#page.evaluate(
      ([kind, which, [x, y, z], [qx, qy, qz, qw]]) => {
        const hand = window.headset[kind][which]!;
        hand.position.set(x, y, z);
        hand.quaternion.set(qx, qy, qz, qw);
      },
      [this.#bare ? "hands" : "controllers", side, position.toArray(), quaternion.toArray()] as const,
    );
    await this.frames(2);
  }

  /** Presses the trigger, or pinches; or lets go. */
  async hold(side: Side, value: 0 | 1): Promise<void> {
    if (!this.#bare) {
      return this.press(side, "trigger", value);
    }
    await this.#page.evaluate(([which, much]) => window.headset.hands[which]!.updatePinchValue(much), [
      side,
      value,
    ] as const);
    await this.frames(3);
  }

  /** Bare hands instead of controllers, or controllers again. */
  async use(what: "hand" | "controller"): Promise<void> {
    this.#bare = what === "hand";
    await this.#page.evaluate((mode) => (window.headset.primaryInputMode = mode), what);
    await this.frames(3);
  }
}
