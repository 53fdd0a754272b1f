import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { copyMadeCases } from "./made_cases";
import { holdings, kCountGpu, useAtRandom } from "./monkey";
import { missing } from "./program";
import { Session } from "./session";

const kSeed = 20261128;
const kMs = 12_000;
const kWarmMs = 3000;
const kFirstUses = 3; // of what is made when it is used first, as a program of the GPU is; what is not freed is made each time

describe.skipIf(missing !== undefined)(`random input${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];

  beforeAll(() => session.start(() => copyMadeCases(session)));
  afterAll(() => session.stop());

  it("breaks nothing, and leaves nothing behind", async () => {
    const page = await session.open("#case=phantom", errors, { width: 760, height: 560 }, [kCountGpu]);
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("filechooser", () => {}); // none is chosen
    await page.evaluate(() => window.clipgs.ready);
    // Code that is fetched when it is used first is there, and what it keeps.
    await page.locator("canvas.stage").first().focus();
    await page.keyboard.press("q");
    await page.locator(".slice canvas").first().waitFor();
    await page.keyboard.press("y");
    await page.locator("dialog[open] .card").first().waitFor();
    await page.keyboard.press("Escape");
    await useAtRandom(page, 1, kWarmMs);
    const before = await holdings(page, "phantom");
    const actions = await useAtRandom(page, kSeed, kMs);
    const after = await holdings(page, "phantom");
    expect(actions).toBeGreaterThan(20);
    expect(errors).toEqual([]);
    for (const [kind, count] of Object.entries(after.gpu)) {
      expect(count - (before.gpu[kind] ?? 0), kind).toBeLessThanOrEqual(kFirstUses);
    }
    expect(after.heap - before.heap).toBeLessThan(2e6);
    expect(after.buffers - before.buffers).toBeLessThan(2e6);
    expect(after.nodes - before.nodes).toBeLessThan(300);
    expect(after.listeners - before.listeners).toBeLessThan(60);
    await page.close();
  });
});
