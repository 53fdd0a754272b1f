import type { Page } from "playwright-core";
import { Matrix4, Quaternion, Vector3 } from "three";

import type { Triple } from "../../src/model/geometry";
import { kPageMs } from "./session";

/** Of a hand from what it points at, m: too far to reach it. */
const kPointingDistance = 0.3;

export type Side = "left" | "right";

type Button = "trigger" | "squeeze" | "a-button" | "x-button";

/** What a hand or its controller does, and how many pictures are waited for then. */
interface Act {
  side?: Side;
  pose?: {
    kind: "hands" | "controllers";
    position: Triple;
    quaternion: [number, number, number, number];
  };
  button?: Button;
  value?: 0 | 1;
  pinch?: 0 | 1;
  frames: number;
}

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
    await this.#act({ frames: count });
  }

  /** Waits until what is held has followed the hand: its pose is filtered. */
  async settle(): Promise<void> {
    await this.#page.evaluate(async () => {
      const end = performance.now() + 800;
      for (let i = 0; i < 10 || performance.now() < end; ++i) {
        await new Promise(requestAnimationFrame);
      }
    });
  }

  /** Of a controller. */
  async press(side: Side, button: Button, value: 0 | 1): Promise<void> {
    await this.#act({ side, button, value, frames: 1 });
  }

  /** Points at a text of the panel, which may take a moment to be there, and presses. */
  async pressText(side: Side, text: string): Promise<void> {
    await this.pressAt(side, await this.#textPlace(text));
  }

  /** Presses a text of the panel with the tip of a bare hand's forefinger, from before it. */
  async poke(side: Side, text: string): Promise<void> {
    const place = new Vector3(...(await this.#textPlace(text)));
    const towards = new Vector3(...(await this.#eye())).sub(place).normalize();
    await this.reach(side, place.clone().addScaledVector(towards, 0.2));
    const offset = await this.tipOffset(side);
    for (const before of [0.05, 0.02, 0.002, 0.02, 0.08]) {
      await this.reach(side, place.clone().addScaledVector(towards, before).sub(offset));
    }
  }

  /** From where a bare hand is put to the tip of its forefinger. */
  async tipOffset(side: Side): Promise<Vector3> {
    const offset = await this.#page.evaluate(async (which) => {
      const session = window.headset.activeSession as unknown as XRSession;
      const space = await session.requestReferenceSpace("local-floor");
      return new Promise<Triple>((resolve) =>
        session.requestAnimationFrame((_time, frame) => {
          const source = [...session.inputSources].find(({ handedness }) => handedness === which)!;
          const joint = source.hand!.get("index-finger-tip")!;
          const { x, y, z } = frame.getJointPose!(joint, space)!.transform.position;
          const { position: hand } = window.headset.hands[which]!;
          resolve([x - hand.x, y - hand.y, z - hand.z]);
        }),
      );
    }, side);
    return new Vector3(...offset);
  }

  /** Where a text of the panel is, in the room, once it stays there. */
  async #textPlace(text: string): Promise<Triple> {
    return this.#page.evaluate(
      async ([wanted, most]) => {
        const end = performance.now() + most;
        let before: Triple | null = null;
        for (;;) {
          const at = window.clipgs.headset.find(wanted);
          if (at && before && at.every((v, k) => Math.abs(v - before![k]!) < 1e-4)) {
            return at; // it stays there
          }
          if (performance.now() > end) {
            throw new Error(`the panel does not show "${wanted}"`);
          }
          before = at;
          await new Promise(requestAnimationFrame);
        }
      },
      [text, kPageMs] as const,
    );
  }

  /** Points at a place in the room, m, from before it, and presses and lets go the trigger, or pinches. */
  async pressAt(side: Side, place: Triple): Promise<void> {
    await this.#act(await this.#pointing(side, place), this.#holding(side, 1), this.#holding(side, 0));
  }

  /** Points at a place in the room, m, from before it. */
  async pointAt(side: Side, place: Triple): Promise<void> {
    await this.#act(await this.#pointing(side, place));
  }

  /** Moves what is in use, a controller or a bare hand. */
  async reach(side: Side, position: Vector3, quaternion = new Quaternion()): Promise<void> {
    await this.#act(this.#reaching(side, position, quaternion));
  }

  /** Presses the trigger, or pinches; or lets go. */
  async hold(side: Side, value: 0 | 1): Promise<void> {
    await this.#act(this.#holding(side, value));
  }

  /** Bare hands instead of controllers, or controllers again. */
  async use(what: "hand" | "controller"): Promise<void> {
    this.#bare = what === "hand";
    await this.#page.evaluate((mode) => (window.headset.primaryInputMode = mode), what);
    await this.frames(3);
  }

  #eye(): Promise<Triple> {
    return this.#page.evaluate(() => {
      const { x, y, z } = window.headset.position;
      return [x, y, z] as Triple;
    });
  }

  async #pointing(side: Side, place: Triple): Promise<Act> {
    const eye = await this.#eye();
    const at = new Vector3(...place);
    const hand = new Vector3(...eye).sub(at).setLength(kPointingDistance).add(at);
    const turn = new Matrix4().lookAt(hand, at, new Vector3(0, 1, 0));
    return this.#reaching(side, hand, new Quaternion().setFromRotationMatrix(turn));
  }

  #reaching(side: Side, position: Vector3, quaternion: Quaternion): Act {
    const kind = this.#bare ? "hands" : "controllers";
    return {
      side,
      pose: { kind, position: position.toArray(), quaternion: quaternion.toArray() },
      frames: 2,
    };
  }

  #holding(side: Side, value: 0 | 1): Act {
    return this.#bare ? { side, pinch: value, frames: 3 } : { side, button: "trigger", value, frames: 1 };
  }

  /** One after the other, without a word to the page in between: each takes as long as a picture. */
  async #act(...acts: Act[]): Promise<void> {
    await this.#page.evaluate(async (all) => {
      for (const { side = "right", pose, button, value, pinch, frames } of all) {
        if (pose) {
          const [x, y, z] = pose.position;
          const [qx, qy, qz, qw] = pose.quaternion;
          const hand = window.headset[pose.kind][side]!;
          hand.position.set(x, y, z);
          hand.quaternion.set(qx, qy, qz, qw);
        }
        if (button) {
          window.headset.controllers[side]!.updateButtonValue(button, value!);
        }
        if (pinch !== undefined) {
          window.headset.hands[side]!.updatePinchValue(pinch);
        }
        for (let i = 0; i < frames; ++i) {
          await new Promise(requestAnimationFrame);
        }
      }
    }, acts);
  }
}
