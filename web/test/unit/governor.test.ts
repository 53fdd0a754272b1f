import { describe, expect, it } from "vitest";

import { Governor } from "../../src/xr/governor";

const kTarget = 1000 / 72;

/** Draws for `seconds` on a device whose frames take `cost` ms of what is drawn in full: whole periods of the display. */
function draw(governor: Governor, seconds: number, cost: number, from = 0): number {
  let now = from;
  while (now < from + 1000 * seconds) {
    const { scale, extent } = governor.effort;
    const share = scale ** 2 * Math.min(1, extent / 3) ** 2;
    now += kTarget * Math.ceil((cost * share) / kTarget);
    governor.count(now, kTarget);
  }
  return now;
}

describe("the governor", () => {
  it("leaves a fast device alone", () => {
    const governor = new Governor();
    draw(governor, 20, 10);
    expect(governor.relaxed).toBe(true);
  });

  it("gives up no more than frames need to be in time", () => {
    const governor = new Governor();
    draw(governor, 5, 17); // a scale of 0.9 does
    expect(governor.effort.scale).toBeCloseTo(0.9);
    expect(governor.effort.extent).toBe(Infinity);
    draw(governor, 10, 200, 10_000); // nothing does
    expect(governor.effort).toEqual({
      scale: 0.5,
      extent: Math.sqrt(5),
      leastPixels: 3,
      walls: "least",
      rays: 1,
      fine: false,
      detail: "splats",
      surfacePixel: 2,
    });
  });

  it("tries more again, and more and more rarely where that is too much", () => {
    const governor = new Governor();
    let now = draw(governor, 5, 17);
    const tries: number[] = [];
    for (let before = governor.effort.scale; now < 125_000; before = governor.effort.scale) {
      now = draw(governor, 1e-3, 17, now); // a frame
      if (before < 1 && governor.effort.scale === 1) {
        tries.push(now);
      }
    }
    const pauses = tries.slice(1).map((at, i) => at - tries[i]!);
    expect(pauses.length).toBeGreaterThan(3);
    pauses.slice(1).forEach((pause, i) => expect(pause).toBeGreaterThan(1.8 * pauses[i]!));
    draw(governor, 130, 8, now); // it became faster
    expect(governor.relaxed).toBe(true);
  });

  it("takes no pause for a late frame, and can be told to leave things as they are", () => {
    const governor = new Governor();
    for (let i = 0; i < 100; ++i) {
      governor.count(5000 * i, kTarget);
    }
    expect(governor.relaxed).toBe(true);
    draw(governor, 5, 60, 1e6);
    expect(governor.relaxed).toBe(false);
    governor.enabled = false;
    expect(governor.relaxed).toBe(true);
  });
});
