import { expect, it } from "vitest";

import { FrameRate } from "../../src/render/frame_rate";

const kTarget = 30; // ms

/** Draws frames of movements that at full resolution cost `rich` ms, or `lean` where less is drawn. */
class Drawing {
  readonly rate = new FrameRate(kTarget, 0.35);
  #now = 0;
  #tick = 0;

  draw(frames: number, rich: number, lean: number): void {
    for (let i = 0; i < frames; ++i) {
      this.#now += (this.rate.lean ? lean : rich) * this.rate.scale ** 2;
      this.rate.count(this.#now, this.#tick++);
    }
  }
}

it("draws all where frames are in time", () => {
  const drawing = new Drawing();
  const { rate } = drawing;
  drawing.draw(50, 20, 10);
  expect(rate.lean).toBe(false);
  expect(rate.scale).toBe(1);
});

it("draws less before resolution falls far, and all again where there is time", () => {
  const drawing = new Drawing();
  const { rate } = drawing;
  drawing.draw(60, 200, 25);
  expect(rate.lean).toBe(true);
  expect(rate.scale).toBe(1);
  drawing.draw(60, 8, 5);
  expect(rate.lean).toBe(false);
  expect(rate.scale).toBe(1);
});

it("gives up resolution where drawing less does not do", () => {
  const drawing = new Drawing();
  const { rate } = drawing;
  drawing.draw(60, 400, 120);
  expect(rate.lean).toBe(true);
  expect(rate.scale).toBeGreaterThan(0.4);
  expect(rate.scale).toBeLessThan(0.6);
});
