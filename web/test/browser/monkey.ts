// Random input, the same for the same seed, and what a page holds before and after.

import type { CDPSession, Page } from "playwright-core";

import { type Evaluates, type Spot, type Tab, waitFor } from "./tab";

/** What a page holds while nothing goes on. */
export interface Holdings {
  heap: number; // bytes
  buffers: number; // bytes outside the heap, as of decoded files
  nodes: number;
  listeners: number;
  gpu: Record<string, number>; // objects of WebGL, by kind
}

/** Counts objects of WebGL, of contexts that are not lost; for addInitScript(). */
export const kCountGpu = {
  content: `{
    const counts = new WeakMap(), contexts = [];
    const { prototype } = WebGL2RenderingContext;
    for (const kind of ["Texture", "Buffer", "Framebuffer", "Renderbuffer", "Program", "VertexArray"]) {
      for (const [verb, step] of [["create", 1], ["delete", -1]]) {
        const original = prototype[verb + kind];
        prototype[verb + kind] = function (...args) {
          if (!counts.has(this)) {
            counts.set(this, {});
            contexts.push(new WeakRef(this));
          }
          const known = counts.get(this);
          known[kind] = (known[kind] ?? 0) + (args[0] === null ? 0 : step);
          return original.apply(this, args);
        };
      }
    }
    window.countGpu = () => {
      const sum = {};
      for (const context of contexts.map((one) => one.deref())) {
        if (context && !context.isContextLost()) {
          Object.entries(counts.get(context)).forEach(([kind, n]) => (sum[kind] = (sum[kind] ?? 0) + n));
        }
      }
      return sum;
    };
  }`,
};

/** Keys that do something; "v" would want a headset. */
const kKeys =
  "a c s f p n e x b u g w i l h o 1 2 3 4 q y r j 0 , . t m k ? d Shift+D + - Tab Enter Escape Delete Control+z Control+Shift+z ArrowUp ArrowDown ArrowLeft ArrowRight PageUp PageDown Shift+ArrowUp Alt+ArrowUp Control+ArrowRight Space Home End".split(
    " ",
  );

/** Those with names, as WebDriver writes them. */
const kCodes: Record<string, string> = {
  Tab: "\uE004",
  Enter: "\uE007",
  Escape: "\uE00C",
  Delete: "\uE017",
  ArrowLeft: "\uE012",
  ArrowUp: "\uE013",
  ArrowRight: "\uE014",
  ArrowDown: "\uE015",
  PageUp: "\uE00E",
  PageDown: "\uE00F",
  Space: " ",
  End: "\uE010",
  Home: "\uE011",
};
/** Of the keys those that are pressed alone; "d" would have some browsers ask where to. */
const kTabKeys = kKeys.flatMap((key) => kCodes[key] ?? (key.length === 1 && key !== "d" ? key : []));

/** Numbers from 0 to 1 (Mulberry32). */
function randomFrom(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Uses everything at random for so long. Returns how many things it did. */
export async function useAtRandom(page: Page, seed: number, milliseconds: number): Promise<number> {
  const random = randomFrom(seed);
  const below = (n: number) => Math.floor(random() * n);
  const { width, height } = page.viewportSize()!;
  const spot = () => ({ x: below(width), y: below(height) });
  const devtools = await page.context().newCDPSession(page);
  const end = Date.now() + milliseconds;
  let count = 0;
  for (; Date.now() < end; ++count) {
    const what = random();
    if (what < 0.3) {
      await page.keyboard.press(kKeys[below(kKeys.length)]!);
    } else if (what < 0.6) {
      await page.evaluate(pressControl, [random(), random()] as const);
    } else if (what < 0.75) {
      const { x, y } = spot();
      await page.mouse.click(x, y, { button: random() < 0.2 ? "right" : "left" });
    } else if (what < 0.88) {
      await drag(page, spot(), spot(), random() < 0.3 ? "right" : "left");
    } else if (what < 0.94) {
      const { x, y } = spot();
      await page.mouse.move(x, y);
      await page.mouse.wheel(0, 400 * (random() - 0.5));
    } else {
      await touch(devtools, spot, 1 + below(2));
    }
  }
  await devtools.detach();
  return count;
}

/** Does so many things at random to a page in any browser: keys, clicks, and whatever can be pressed. */
export async function useTabAtRandom(tab: Tab, seed: number, count: number): Promise<void> {
  const random = randomFrom(seed);
  const below = (n: number) => Math.floor(random() * n);
  const [width, height] = await tab.evaluate(() => [innerWidth, innerHeight] as const);
  for (let i = 0; i < count; ++i) {
    const what = random();
    if (what < 0.35) {
      await tab.press(kTabKeys[below(kTabKeys.length)]!);
    } else if (what < 0.75) {
      await tab.evaluate(pressControl, [random(), random()] as const);
    } else {
      await tab.click({ x: below(width), y: below(height) });
    }
  }
}

/** Presses, moves or types into one of what can be used now. */
function pressControl([which, value]: readonly [number, number]): void {
  const root = document.querySelector("dialog[open]") ?? document;
  const controls = [...root.querySelectorAll<HTMLElement>("button, input, select, textarea")].filter(
    (one) => one.checkVisibility() && !one.matches(":disabled, [type=file], .open-file"),
  );
  const control = controls[Math.floor(which * controls.length)];
  if (control instanceof HTMLSelectElement) {
    control.selectedIndex = Math.floor(value * control.options.length);
    control.dispatchEvent(new Event("change", { bubbles: true }));
  } else if (control instanceof HTMLInputElement && control.type === "range") {
    control.value = String(Number(control.min) + value * (Number(control.max) - Number(control.min)));
    control.dispatchEvent(new Event("input", { bubbles: true }));
    control.dispatchEvent(new Event("change", { bubbles: true }));
  } else if (control?.matches("textarea, [type=text], [type=number], [type=search]")) {
    (control as HTMLInputElement).value = String(Math.round(1000 * value));
    control.dispatchEvent(new Event("input", { bubbles: true }));
    control.dispatchEvent(new Event("change", { bubbles: true }));
  } else {
    control?.click();
  }
}

async function drag(page: Page, from: Spot, to: Spot, button: "left" | "right"): Promise<void> {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down({ button });
  await page.mouse.move(to.x, to.y, { steps: 4 });
  await page.mouse.up({ button });
}

/** One finger or two that move. */
async function touch(devtools: CDPSession, spot: () => Spot, fingers: number): Promise<void> {
  const points = () => Array.from({ length: fingers }, (_, id) => ({ ...spot(), id }));
  for (const type of ["touchStart", "touchMove", "touchMove"] as const) {
    await devtools.send("Input.dispatchTouchEvent", { type, touchPoints: points() });
  }
  await devtools.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
}

/** Brings the page back to where it began: this case, whole, without marks, views, or anything beside it. */
export async function comeToRest(page: Evaluates, name: string): Promise<void> {
  await page.evaluate(async (wanted) => {
    document.querySelectorAll<HTMLDialogElement>("dialog[open]").forEach((dialog) => dialog.close());
    const { clipgs } = window;
    clipgs.stopTour();
    const stage = document.querySelector<HTMLElement>("canvas.stage")!;
    stage.focus();
    const press = (key: string) => stage.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    press("Escape");
    if (document.querySelector(".beside:not([hidden])")) {
      press("y");
    }
    if (document.querySelector(".slices:not([hidden])")) {
      press("q");
    }
    await clipgs.open(wanted);
    clipgs.marks.forEach(({ id }) => clipgs.removeMark(id));
    clipgs.setMode("arbitrary");
    clipgs.setCuts([]);
    clipgs.setLayers({ body: true, faces: true, marks: true });
    clipgs.setClip("exact");
    clipgs.setGrey(0);
    clipgs.setSection("volume");
    clipgs.setRig(null); // another light is held besides the case's own
    clipgs.setTurn(0);
    clipgs.setLamp(null);
    clipgs.setView({ azimuth: 0, elevation: 0, zoom: 1 });
    document.querySelector<HTMLElement>(".message:not([hidden]) .dismiss")?.click();
  }, name);
  // As a person removes them: no function of scripts does.
  await page.evaluate(() => {
    for (let i = 0; i < 100; ++i) {
      document.querySelector<HTMLElement>(".view-card [title^='Remove this view']")?.click();
    }
  });
  await waitFor(page, () => window.clipgs.stats.settled, undefined);
}

/** What the page holds once it has come to rest. */
export async function holdings(page: Page, name: string): Promise<Holdings> {
  await comeToRest(page, name);
  const devtools = await page.context().newCDPSession(page);
  await devtools.send("HeapProfiler.collectGarbage");
  await page.waitForTimeout(300); // what is freed when others are
  await devtools.send("HeapProfiler.collectGarbage");
  const heap = (await devtools.send("Runtime.getHeapUsage")) as {
    usedSize: number;
    backingStorageSize: number;
  };
  const dom = await devtools.send("Memory.getDOMCounters");
  await devtools.detach();
  const gpu = await page.evaluate(() =>
    (window as unknown as { countGpu(): Record<string, number> }).countGpu(),
  );
  return {
    heap: heap.usedSize,
    buffers: heap.backingStorageSize,
    nodes: dom.nodes,
    listeners: dom.jsEventListeners,
    gpu,
  };
}
