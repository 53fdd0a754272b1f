import { describe, expect, it } from "vitest";
import { cpSync } from "node:fs";
import { Session } from "./session";
import { Wearer } from "./wearer";

describe("shots", () => {
  it("takes them", async () => {
    const session = new Session();
    const errors: string[] = [];
    await session.start((cases) => cpSync("/tmp/looks/cases", cases, { recursive: true }), "--headset");
    const page = await session.openInHeadset("#case=torso-skin", errors);
    await page.evaluate(() => window.clipgs.ready);
    await page.setViewportSize({ width: 1100, height: 700 });
    const wearer = new Wearer(page);
    await wearer.wear();
    await page.evaluate(() => { const a = 0.62; window.headset.quaternion.set(-0.05, Math.sin(a / 2), 0, Math.cos(a / 2)); });
    await wearer.frames(3);
    for (const [tab, file] of [["Looks", "looks"], ["Cases", "cases"]] as const) {
      await page.evaluate((t) => { const p = window.clipgs.headset.find(t); if (!p) throw new Error("none"); }, tab);
      await wearer.pressText("right", tab);
      await wearer.frames(6);
      await page.waitForTimeout(1500);
      await wearer.frames(6);
      await page.screenshot({ path: `/tmp/looks/hs-${file}.png` });
    }
    await wearer.pressText("right", "Skeleton");
    await page.waitForFunction(() => window.clipgs.state.case === "torso-skeleton");
    await wearer.frames(6);
    await page.screenshot({ path: `/tmp/looks/hs-skeleton.png` });
    expect(errors).toEqual([]);
    await session.stop();
  });
});
