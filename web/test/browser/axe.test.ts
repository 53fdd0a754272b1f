// No rule of axe-core is broken, whatever is shown, in both languages, colours, levels, and on a desk and a telephone.

import type { RunOptions } from "axe-core";
import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { broken, kAxe } from "./axe";
import { copyMadeCases } from "./made_cases";
import { missing } from "./program";
import { Session } from "./session";
import { markAxialFace } from "./shot";

/** What depends on colours; all else is the same in the other ones. */
const kColors: RunOptions = { runOnly: ["color-contrast"] };

/** Controls with less room than a finger needs (WCAG 2.2, 2.5.5); faces of the cube are as large as it can be. */
function tooSmall(page: Page): Promise<string[]> {
  return page.evaluate(() => {
    const kFinger = 44;
    const kTolerance = 0.5;
    const root = document.querySelector("dialog[open]") ?? document;
    return [...root.querySelectorAll<HTMLElement>("button, input, select, textarea")]
      .filter((one) => one.checkVisibility() && !one.matches(".face, [type=file]"))
      .map((one) => {
        const target = one.matches("[type=checkbox], [type=radio]") ? (one.closest("label") ?? one) : one;
        const { width, height } = target.getBoundingClientRect();
        return { name: one.title || one.ariaLabel || one.textContent || one.outerHTML, width, height };
      })
      .filter(({ width, height }) => Math.min(width, height) + kTolerance < kFinger)
      .map(({ name, width, height }) => `${name}: ${Math.round(width)} x ${Math.round(height)} px`);
  });
}

/** What is to be read or pressed whatever happens, and is cut off by what holds it, or lies below something else. */
function notSeen(page: Page): Promise<string[]> {
  return page.evaluate(() => {
    const leaves = (inner: DOMRect, outer: DOMRect): boolean =>
      inner.left < outer.left - 1 ||
      inner.right > outer.right + 1 ||
      inner.top < outer.top - 1 ||
      inner.bottom > outer.bottom + 1;
    const seen = (selector: string): HTMLElement[] =>
      [...document.querySelectorAll<HTMLElement>(selector)].filter((one) => one.checkVisibility());
    const cutOff = seen(
      ".viewer > footer .warning, .beside .warning, .beside-title, .slice-head > *, .card > :last-child",
    )
      .filter((one) =>
        leaves(
          one.getBoundingClientRect(),
          one.closest(".slice, .beside, .card, .viewer")!.getBoundingClientRect(),
        ),
      )
      .map((one) => `cut off: ${one.textContent}`);
    const below = seen(".message button")
      .filter((one) => {
        const { x, y, width, height } = one.getBoundingClientRect();
        return !one.contains(document.elementFromPoint(x + width / 2, y + height / 2));
      })
      .map((one) => `below something: ${one.title || one.textContent}`);
    return [...cutOff, ...below];
  });
}

/** Puts the page into one state after the other, each from the one before. */
function states(page: Page): Record<string, () => Promise<unknown>> {
  const stage = page.locator("canvas.stage").first(); // not that of a case beside
  const press = async (key: string): Promise<void> => {
    await stage.focus();
    await page.keyboard.press(key);
  };
  const dialog = page.locator("dialog[open]");
  const openSheet = async (open: boolean): Promise<void> => {
    const grabber = page.locator(".grabber");
    if (await grabber.isVisible()) {
      await grabber.evaluate((button, wanted) => {
        if ((button.getAttribute("aria-expanded") === "true") !== wanted) {
          (button as HTMLElement).click();
        }
      }, open);
    }
  };
  return {
    "a case": () => page.evaluate(() => window.clipgs.setPlane({ normal: [0, 0, -1], offset: 0 })),
    "all controls": () => openSheet(true),
    "several cuts, grey": () =>
      page.evaluate(() => {
        const { clipgs } = window;
        clipgs.setGrey(1);
        clipgs.setCuts([
          { normal: [0, 0, -1], offset: 0 },
          { normal: [0, -1, 0], offset: -60, thickness: 60 },
        ]);
      }),
    "marks, and the card of one": async () => {
      await markAxialFace(page);
      await page.locator(".mark-name").first().dispatchEvent("click");
      await page.locator(".mark-card").waitFor();
    },
    "views, one of which is changed": async () => {
      await page.evaluate(() => {
        window.clipgs.saveView("Overview", "From the front");
        window.clipgs.setView({ azimuth: 60, elevation: 20 });
        window.clipgs.saveView("", "");
      });
      await page.locator(".view-row button").last().dispatchEvent("click");
      await page.locator(".view-card:visible").waitFor();
    },
    "a tour": async () => {
      await openSheet(false);
      await page.evaluate(() => void window.clipgs.playTour());
      await page.locator(".tour-caption:visible").waitFor();
    },
    slices: async () => {
      await press("Escape");
      await press("q");
      await page.locator(".slice-tools").waitFor();
    },
    "all slices": () => page.locator(".slice-tools .segments button").last().dispatchEvent("click"),
    cases: async () => {
      await press("q");
      await press("y");
      await dialog.locator(".card").first().waitFor();
    },
    "no case found": () => dialog.locator("[type=search]").fill("nothing at all"),
    "two cases": async () => {
      await dialog.locator("[type=search]").fill("");
      await dialog.locator(".card[data-case=solid]").click();
      await page.locator(".beside-title").waitFor();
    },
    "the looks": async () => {
      await press("y");
      await press("k");
      await dialog.locator(".card").first().waitFor();
    },
    "the help": async () => {
      await page.keyboard.press("Escape");
      await press("?");
    },
    "a picture of another size": async () => {
      await page.keyboard.press("Escape");
      await press("Shift+D");
      await dialog.locator(".segments button").last().click();
    },
    "an error": async () => {
      await page.keyboard.press("Escape");
      await page.evaluate(() => window.clipgs.open("nobody").catch(() => {}));
      await page.locator(".message:visible").waitFor();
    },
    "a case on its way": async () => {
      await page.route("**/cases/photo.sog*", () => {}); // never answered
      await page.evaluate(() => void window.clipgs.open("photo").catch(() => {}));
      await page.locator(".loading:visible").waitFor();
    },
  };
}

describe.skipIf(missing !== undefined)(`axe${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];

  beforeAll(() => session.start(() => copyMadeCases(session)));

  afterAll(async () => {
    expect(errors).toEqual([]);
    await session.stop();
  });

  for (const [device, lang, level, viewport] of [
    ["a desk", "en", "expert", { width: 1000, height: 760 }],
    ["a telephone", "de", "simple", { width: 390, height: 844 }],
  ] as const) {
    it(`finds nothing wrong on ${device}, in ${lang}, ${level}`, async () => {
      const url = `${session.url}?lang=${lang}#case=phantom&view=10,40`;
      const page = await session.openPage(url, errors, viewport, [
        { content: `try { localStorage.setItem("clipgs.level", "${level}"); } catch {}` },
        kAxe,
      ]);
      await page.waitForFunction(() => window.clipgs !== undefined);
      await page.evaluate(() => window.clipgs.ready);
      const found: string[] = [];
      const isPhone = viewport.width < viewport.height;
      if (isPhone) {
        const devtools = await page.context().newCDPSession(page);
        await devtools.send("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 5 });
        expect(await page.evaluate(() => matchMedia("(pointer: coarse)").matches)).toBe(true);
      }
      for (const [state, enter] of Object.entries(states(page))) {
        await enter();
        await page.emulateMedia({ colorScheme: "dark" });
        const dark = await broken(page);
        await page.emulateMedia({ colorScheme: "light" });
        const light = await broken(page, kColors);
        const laid = await notSeen(page);
        if (isPhone) {
          laid.push(...(await tooSmall(page)));
          await page.setViewportSize({ width: viewport.height, height: viewport.width });
          await page.waitForTimeout(200); // what is laid out by what is free of the picture follows
          const onItsSide = [...(await tooSmall(page)), ...(await notSeen(page))];
          laid.push(...onItsSide.map((what) => `on its side, ${what}`));
          await page.setViewportSize(viewport);
        }
        found.push(...[...dark, ...light, ...laid].map((what) => `${state}: ${what}`));
      }
      expect(found).toEqual([]);
      await page.close();
    });
  }

  it("finds nothing wrong where there is no case", async () => {
    const page = await session.openPage("about:blank", errors, { width: 900, height: 700 }, [kAxe]);
    await page.route("**/api/cases*", (route) => route.fulfill({ json: { cases: [] } }));
    await page.goto(session.url);
    await page.locator("dialog[open]").waitFor();
    expect(await broken(page)).toEqual([]);
    await page.close();
  });
});
