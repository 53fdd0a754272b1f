import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { BrowserContext, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { copyMadeCases } from "./made_cases";
import { missing } from "./program";
import { Session } from "./session";

type Point = [number, number, number];

describe.skipIf(missing !== undefined)(
  `marks on a server${missing ? ` (${missing} is missing)` : ""}`,
  () => {
    const session = new Session();
    const file = () => join(session.cases, "phantom.marks.json");
    let contexts: BrowserContext[] = [];

    beforeAll(() => session.start(() => copyMadeCases(session), "--keep-marks"));

    afterAll(async () => {
      await Promise.all(contexts.map((context) => context.close()));
      expect(await session.stop(), "exit status of clipgs serve").toBe(0);
    });

    /** Somebody else's browser. */
    async function visit(): Promise<Page> {
      const context = await session.context();
      contexts = [...contexts, context];
      const page = await context.newPage();
      await page.goto(`${session.url}#case=phantom&view=10,60&plane=0,0,-1,0`);
      await page.waitForFunction(() => window.clipgs !== undefined);
      await page.evaluate(() => window.clipgs.ready);
      return page;
    }

    const names = (page: Page) => page.evaluate(() => window.clipgs.marks.map(({ name }) => name));
    const mark = (page: Page, name: string, shift: number) =>
      page.evaluate(
        ([text, by]) => {
          const { min, max } = window.clipgs.bounds!;
          const point = [0, 1, 2].map((k) => 0.5 * (min[k]! + max[k]!)) as Point;
          point[0] += by as number;
          return window.clipgs.addMark({ kind: "point", points: [point], name: text as string })!;
        },
        [name, shift],
      );
    const kept = () =>
      existsSync(file())
        ? (JSON.parse(readFileSync(file(), "utf8")) as { marks: { name: string }[] }).marks.map(
            ({ name }) => name,
          )
        : [];

    it("are kept beside the case, and what two do at once is kept of both", async () => {
      const [first, second] = await Promise.all([visit(), visit()]);
      const id = await mark(first, "from the first", -10);
      await expect.poll(kept).toEqual(["from the first"]);
      await mark(second, "from the second", 10); // who knows nothing of the first
      await expect.poll(kept).toEqual(["from the first", "from the second"]);
      await first.evaluate((one) => window.clipgs.removeMark(one), id);
      await expect.poll(kept).toEqual(["from the second"]);
      await first.reload();
      await first.waitForFunction(() => window.clipgs !== undefined);
      await first.evaluate(() => window.clipgs.ready);
      expect(await names(await visit())).toEqual(["from the second"]);
    });

    it("of a newer version are said to be, and left as they are", async () => {
      const text = JSON.stringify({ clipgs_marks: 7, volume: "", marks: [] });
      writeFileSync(file(), text);
      const page = await visit();
      await page
        .getByRole("status")
        .getByText(/phantom\.marks\.json: of a version/)
        .waitFor();
      await mark(page, "lost on nobody", 5);
      await page.waitForTimeout(600);
      expect(readFileSync(file(), "utf8")).toBe(text);
      expect(await names(page)).toEqual(["lost on nobody"]);
    });
  },
);
