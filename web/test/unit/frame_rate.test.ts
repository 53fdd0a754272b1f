import { expect, it } from "vitest";

import { FrameRate } from "../../src/render/frame_rate";

const kTarget = 30; // ms

/** Draws frames for a movement that at full resolution cost `rich` ms, or `lean` where less is drawn. */
function draw(rate: FrameRate, frames: number, rich: number, lean: number, from = 0): void {
  let now = 0;
  for (let tick = from; tick < from + frames; ++tick) {
    now += (rate.lean ? lean : rich) * rate.scale ** 2;
    rate.count(now, tick);
  }
}

it("draws all where frames are in time", () => {
  const rate = new FrameRate(kTarget, 0.35);
  draw(rate, 50, 20, 10);
  expect(rate.lean).toBe(false);
  expect(rate.scale).toBe(1);
});

it("draws less before resolution falls far, and all again where there is time", () => {
  const rate = new FrameRate(kTarget, 0.35);
  draw(rate, 60, 200, 25);
  expect(rate.lean).toBe(true);
  expect(rate.scale).toBe(1);
  draw(rate, 60, 8, 5, 60);
  expect(rate.lean).toBe(false);
  expect(rate.scale).toBe(1);
});

it("gives up resolution where drawing less does not do", () => {
  const rate = new FrameRate(kTarget, 0.35);
  draw(rate, 60, 400, 120);
  expect(rate.lean).toBe(true);
  expect(rate.scale).toBeGreaterThan(0.4);
  expect(rate.scale).toBeLessThan(0.6);
});
