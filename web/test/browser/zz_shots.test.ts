import { describe, expect, it } from "vitest";
import { cpSync } from "node:fs";
import { Session } from "./session";

describe("shots", () => {
  it("takes them", async () => {
    const session = new Session();
    const errors: string[] = [];
    await session.start((cases) => cpSync("/tmp/looks/cases", cases, { recursive: true }));
    for (const [w, hgt] of [
      [1280, 800],
      [390, 844],
    ] as const) {
      const page = await session.open("#case=torso-skin&view=30,20", errors, { width: w, height: hgt });
      await page.evaluate(() => window.clipgs.ready);
      await page.waitForTimeout(1500);
      await page.screenshot({ path: `/tmp/looks/page-${w}.png` });
      await page.keyboard.press("k");
      await page.getByRole("dialog", { name: "Looks" }).waitFor();
      await page.waitForTimeout(800);
      await page.screenshot({ path: `/tmp/looks/looks-${w}.png` });
      await page.locator('dialog[open] [data-case="torso-skeleton"]').click();
      await page.waitForFunction(() => window.clipgs.state.case === "torso-skeleton");
      await page.waitForFunction(() => window.clipgs.stats.settled);
      await page.screenshot({ path: `/tmp/looks/skeleton-${w}.png` });
      await page.keyboard.press("m");
      await page.waitForTimeout(1000);
      await page.screenshot({ path: `/tmp/looks/menu-${w}.png` });
      await page.close();
    }
    expect(errors).toEqual([]);
    await session.stop();
  });
});
