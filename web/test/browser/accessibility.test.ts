import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";

import { copyMadeCases } from "./made_cases";
import { missing } from "./program";
import { Session } from "./session";
import { markAxialFace, show } from "./shot";

/** What a person does something with. */
const kControls = ["button", "link", "slider", "spinbutton", "textbox", "combobox", "checkbox", "dialog"];
/** Of text to what is behind it (WCAG 2.2, 1.4.3). */
const kLeastContrast = 4.5;

describe.skipIf(missing !== undefined)(`accessibility${missing ? ` (${missing} is missing)` : ""}`, () => {
  const session = new Session();
  const errors: string[] = [];
  let page: Page;

  beforeAll(async () => {
    await session.start(() => copyMadeCases(session));
    page = await session.open("#case=phantom&view=10,60&plane=0,0,-1,0", errors, {
      width: 1000,
      height: 900,
    });
    await page.evaluate(() => window.clipgs.ready);
  });

  afterAll(async () => {
    expect(errors).toEqual([]);
    await session.stop();
  });

  /** Shows as much as can be shown at once: several planes, a slab, grey faces, and marks. */
  async function showMuch(): Promise<void> {
    const more: [number, number, number, number, number?][] = [[0, -1, 0, -60, 60]];
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], more, clip: "exact", grey: 1 });
    await page.evaluate(() => window.clipgs.marks.forEach(({ id }) => window.clipgs.removeMark(id)));
    const points = await markAxialFace(page);
    await page.evaluate(
      (rim) => window.clipgs.addMark({ kind: "region", points: rim, normal: [0, 0, -1] }),
      points,
    );
    await page.getByRole("list", { name: "Marks" }).getByRole("listitem").last().waitFor();
    await page.getByRole("list", { name: "Marks" }).getByRole("button").first().click();
    await page.getByRole("region", { name: "Mark", exact: true }).waitFor();
  }

  /** Roles and names of the controls that are not hidden, as the browser tells readers of the screen. */
  async function controls(): Promise<{ role: string; name: string }[]> {
    const devtools = await page.context().newCDPSession(page);
    const { nodes } = await devtools.send("Accessibility.getFullAXTree");
    await devtools.detach();
    return nodes
      .filter(({ ignored, role }) => !ignored && kControls.includes(String(role?.value)))
      .map(({ role, name }) => ({ role: String(role!.value), name: String(name?.value ?? "") }));
  }

  const nameless = async () => (await controls()).filter(({ name }) => name.trim() === "");

  it("has a name for every control", async () => {
    await showMuch();
    const shown = await controls();
    expect(shown.length).toBeGreaterThan(35);
    expect(await nameless()).toEqual([]);
    expect(shown.map(({ name }) => name)).toEqual(
      expect.arrayContaining(["Save a picture (D)", "Help (?)", "From cinematic to grey", "Look from left"]),
    );
    for (const [key, name] of [
      ["?", "Help"],
      ["m", "Cases"],
      ["k", "Looks"],
    ] as const) {
      await page.keyboard.press(key);
      await page.getByRole("dialog", { name }).waitFor();
      expect((await controls()).length).toBeGreaterThan(1);
      await expect.poll(nameless).toEqual([]); // cards of a list have theirs once they are laid out
      await page.keyboard.press("Escape");
    }
    await page.keyboard.press("q");
    await page.getByRole("slider", { name: / slice$/ }).waitFor();
    await expect.poll(nameless).toEqual([]);
    await page.keyboard.press("q");
  });

  it("is gone through in reading order", async () => {
    await page.locator("canvas.stage").focus();
    const seen: { part: string; top: number; left: number }[] = [];
    for (let i = 0; i < 80; ++i) {
      const at = await page.evaluate(() => {
        const element = document.activeElement!;
        const part = element.closest(".stage, .mark-layer, .mark-card, .bar, .panel, .cube-stage");
        const { top, left } = element.getBoundingClientRect();
        return { part: part?.classList[0] ?? "", top: top + (part?.scrollTop ?? 0), left };
      });
      if (at.part === "") {
        break; // after the last one
      }
      seen.push(at);
      await page.keyboard.press("Tab");
    }
    const parts = seen.map(({ part }) => part).filter((part, i, all) => part !== all[i - 1]);
    expect(parts).toEqual(["stage", "mark-layer", "mark-card", "bar", "panel", "cube-stage"]);
    for (const part of ["bar", "panel"]) {
      const within = seen.filter((one) => one.part === part);
      expect(within.length).toBeGreaterThan(3);
      within.slice(1).forEach(({ top, left }, i) => {
        const before = within[i]!;
        const kRow = 16; // px: things in a row are not all equally high
        expect(top > before.top + kRow || (top > before.top - kRow && left > before.left)).toBe(true);
      });
    }
  });

  it("keeps the focus in dialogs, and gives it back", async () => {
    for (const [button, name] of [
      ["Help (?)", "Help"],
      ["Cases (M)", "Cases"],
      ["Looks of this volume (K)", "Looks"],
    ] as const) {
      const opener = page.getByTitle(button);
      await opener.focus();
      await page.keyboard.press("Enter");
      const dialog = page.getByRole("dialog", { name });
      await dialog.waitFor();
      // Past the last control the browser's own bars have it: where a key goes from there is theirs to say.
      const hasFocus = async (): Promise<boolean> => {
        const where = await dialog.evaluate((element) => {
          const { activeElement } = document;
          return element.contains(activeElement) ? "in" : activeElement === document.body ? "bars" : "out";
        });
        expect(where, name).not.toBe("out");
        return where === "in";
      };
      for (let i = 0; !(await hasFocus()) || i < 12; ++i) {
        await page.keyboard.press("Tab");
      }
      await page.keyboard.press("Escape");
      await dialog.waitFor({ state: "hidden" });
      await expect
        .poll(() => page.evaluate(() => document.activeElement?.getAttribute("title")))
        .toBe(button);
    }
  });

  it("says which toggles are on", async () => {
    for (const [name, key] of [
      ["Cut or uncut (P)", "p"],
      ["Show or hide the handle (H)", "h"],
      ["A second face behind the plane (B)", "b"],
      ["Measure between two points of faces (L)", "l"],
    ] as const) {
      const pressed = () => page.getByTitle(name).getAttribute("aria-pressed");
      const before = await pressed();
      expect(["true", "false"]).toContain(before);
      await page.locator("canvas.stage").focus();
      await page.mouse.move(5, 450);
      await page.keyboard.press(key);
      await expect.poll(pressed).toBe(before === "true" ? "false" : "true");
      await page.keyboard.press(key);
      await expect.poll(pressed).toBe(before);
    }
  });

  it("says where the plane came to rest, and not all the way there", async () => {
    await show(page, { view: [10, 60, 1], plane: [0, 0, -1, 0], clip: "exact" });
    await page.waitForTimeout(1500);
    await page.evaluate(() => {
      const said: string[] = [];
      const live = document.querySelectorAll(
        '[aria-live="polite"], output:not([aria-live="off"]), [role="status"]',
      );
      for (const element of live) {
        new MutationObserver(() => said.push(element.textContent)).observe(element, {
          childList: true,
          characterData: true,
          subtree: true,
        });
      }
      Object.assign(window, { said });
    });
    await page.evaluate(async () => {
      for (let i = 1; i <= 30; ++i) {
        window.clipgs.setPlane({ normal: [0, 0, -1], offset: i });
        await new Promise((resolve) => setTimeout(resolve, 20));
      }
    });
    const said = () => page.evaluate("said");
    const readout = await page.locator(".readout").first().textContent();
    await expect.poll(said).toEqual([`Axial, superior removed, ${readout}`]);
    await page.keyboard.press("p");
    await expect.poll(said).toEqual([`Axial, superior removed, ${readout}`, "Nothing is cut"]);
    await page.keyboard.press("p");
  });

  it("moves nothing by itself for those who do not want that", async () => {
    const moving = () =>
      page.evaluate(
        () =>
          [...document.querySelectorAll("*")].filter((element) => {
            const { transitionProperty, transitionDuration, animationName } = getComputedStyle(element);
            const eased = transitionProperty !== "none" && /[1-9]/.test(transitionDuration);
            return eased || animationName !== "none";
          }).length,
      );
    const card = page.locator(".loading").first(); // comes gently where another case is opened
    await card.evaluate((element) => element.classList.add("over"));
    expect(await moving()).toBeGreaterThan(0);
    await page.emulateMedia({ reducedMotion: "reduce" });
    expect(await moving()).toBe(0);
    await card.evaluate((element) => element.classList.remove("over"));
    await page.emulateMedia({ reducedMotion: "no-preference" });
  });

  for (const colorScheme of ["dark", "light"] as const) {
    it(`can be read in ${colorScheme} colours`, async () => {
      await page.emulateMedia({ colorScheme });
      await showMuch();
      await expect.poll(() => page.locator("main.light").count()).toBe(colorScheme === "light" ? 1 : 0);
      const faint = await contrasts(page);
      expect(faint.length).toBeGreaterThan(30);
      expect(faint.filter(({ contrast }) => contrast < kLeastContrast)).toEqual([]);
      await page.keyboard.press("p");
      await page.keyboard.press("?");
      const helped = await contrasts(page);
      expect(helped.length).toBeGreaterThan(50);
      expect(helped.filter(({ contrast }) => contrast < kLeastContrast)).toEqual([]);
      await page.keyboard.press("Escape");
      for (const key of ["m", "k"]) {
        await page.keyboard.press(key);
        await page.locator("dialog[open] .card").first().waitFor();
        expect((await contrasts(page)).filter(({ contrast }) => contrast < kLeastContrast)).toEqual([]);
        await page.keyboard.press("Escape");
      }
      await page.keyboard.press("p");
    });
  }

  it("has colours as the system or the user wants them, and remembers the choice", async () => {
    const shown = (one: Page) => one.locator("main").evaluate((main) => main.classList.contains("light"));
    await page.emulateMedia({ colorScheme: "dark" });
    await expect.poll(() => shown(page)).toBe(false);
    await page.emulateMedia({ colorScheme: "light" });
    await expect.poll(() => shown(page)).toBe(true);
    await page.locator("canvas.stage").focus();
    await page.keyboard.press("t");
    expect(await shown(page)).toBe(false);
    expect(await page.getByRole("button", { name: "Colours: dark (T)" }).count()).toBe(1);
    await page.reload();
    await page.evaluate(() => window.clipgs.ready);
    expect(await shown(page)).toBe(false);
    await page.getByRole("button", { name: "Colours: dark (T)" }).click();
    expect(await shown(page)).toBe(true);
    await page.emulateMedia({ colorScheme: "dark" });
    expect(await shown(page)).toBe(true);

    const barred = `Object.defineProperty(window, "localStorage", { get() { throw new DOMException("barred"); } });`;
    const visitor = await session.open("#case=phantom", errors, undefined, [{ content: barred }]);
    await visitor.evaluate(() => window.clipgs.ready);
    const before = await shown(visitor);
    await visitor.keyboard.press("t");
    await visitor.keyboard.press("t");
    await expect.poll(() => shown(visitor)).toBe(true);
    expect(before).toBe(true); // what the browser of these tests asks for
    await visitor.close();
  });
});

/** The contrast of every text that is shown to what is behind it, where its control can be used. */
function contrasts(page: Page): Promise<{ text: string; contrast: number }[]> {
  return page.evaluate(() => {
    type Color = [number, number, number, number];
    const parse = (text: string): Color => {
      const [r = 0, g = 0, b = 0, a = 1] = text.match(/[\d.]+/g)!.map(Number);
      return [r, g, b, a];
    };
    const over = ([r, g, b, a]: Color, below: Color): Color => {
      const mixed = [r, g, b].map((v, i) => a * v + (1 - a) * below[i]!);
      return [mixed[0]!, mixed[1]!, mixed[2]!, 1];
    };
    const luminance = (color: Color) => {
      const [r, g, b] = color.map((v) =>
        v / 255 <= 0.04045 ? v / 3294.6 : ((v / 255 + 0.055) / 1.055) ** 2.4,
      );
      return 0.2126 * r! + 0.7152 * g! + 0.0722 * b!;
    };
    const behind = (element: Element | null): Color => {
      if (!element) {
        return [0, 0, 0, 1];
      }
      const color = parse(getComputedStyle(element).backgroundColor);
      return color[3] === 1 ? color : over(color, behind(element.parentElement));
    };
    const dialog = document.querySelector("dialog[open]");
    return [...(dialog ?? document).querySelectorAll<HTMLElement>("*")]
      .filter((element) => {
        const hasText = [...element.childNodes].some(
          (node) => node.nodeType === 3 && node.textContent?.trim(),
        );
        const shown = element.checkVisibility() && !element.closest(":disabled, .unseen, title");
        return hasText && shown;
      })
      .map((element) => {
        const ground = behind(element);
        const color = over(parse(getComputedStyle(element).color), ground);
        const [a, b] = [luminance(color), luminance(ground)];
        const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
        return { text: element.textContent.trim(), contrast };
      });
  });
}
