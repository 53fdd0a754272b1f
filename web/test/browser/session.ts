import { resolve } from "node:path";
import { type Browser, type BrowserContext, chromium, type Page } from "playwright-core";

import { kChromium } from "./program";
import { Server } from "./server";

/** Of what waits for the page: long, as pictures are drawn without a GPU. Tests have more time (vite.config.ts). */
export const kPageMs = 120_000;

/**
 * A browser that draws without a GPU: by Mesa, which takes two thirds of the time of Chromium's own renderer, which
 * browsers.test.ts draws with.
 */
export function launchBrowser(): Promise<Browser> {
  return chromium.launch({
    executablePath: kChromium,
    args: [
      "--headless=new",
      "--no-sandbox",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--use-angle=gl-egl",
      "--ignore-gpu-blocklist",
      "--disable-gpu-sandbox",
    ],
    env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: "1" },
  });
}

/** Pages show everything that there is, where the browser lets them remember that. */
const kExpert = { content: `try { localStorage.setItem("clipgs.level", "expert"); } catch {}` };

/** Nor do they say what to do first. */
const kNoHint = { content: `try { localStorage.setItem("clipgs.hint", "seen"); } catch {}` };

/** Takes the page's GPU away and gives it back. */
export async function loseGpu(page: Page): Promise<void> {
  await page.evaluate(async () => {
    const canvas = document.querySelector<HTMLCanvasElement>("canvas.stage")!;
    const lost = canvas.getContext("webgl2")!.getExtension("WEBGL_lose_context")!;
    const happened = (event: string) =>
      new Promise<Event>((resolve) => canvas.addEventListener(event, resolve, { once: true }));
    const gone = happened("webglcontextlost");
    lost.loseContext();
    await gone;
    await new Promise((resolve) => setTimeout(resolve)); // until the event is over
    const back = happened("webglcontextrestored");
    lost.restoreContext();
    await back;
  });
}

/** What a page is shown in, CSS px; `scale`: pixels that are drawn for one of them. */
interface Viewport {
  width: number;
  height: number;
  scale?: number;
}

/** Layout does not depend on how finely it is drawn, and pixels are what takes time without a GPU. */
const kUsual: Viewport = { width: 900, height: 600, scale: 0.25 };

/** What an emulated headset's two eyes see, side by side. */
const kEyes: Viewport = { width: 320, height: 200, scale: 1 };
/** The same where pictures matter little. Of much smaller pages Chromium draws but one frame a second. */
export const kSmallEyes: Viewport = { width: 240, height: 120, scale: 1 };

/** A served folder of cases and Chromium, which looks at it. */
export class Session extends Server {
  #browser!: Browser;

  override async start(
    makeCases: (cases: string) => Promise<void> | void,
    ...options: string[]
  ): Promise<void> {
    await super.start(makeCases, ...options);
    this.#browser = await launchBrowser();
  }

  /** Opens the viewer in a browser with an emulated Quest 3, whose two eyes see half of that each. */
  async openInHeadset(hash = "", errors: string[] = [], viewport = kEyes): Promise<Page> {
    const scripts = [
      { path: resolve("node_modules/iwer/build/iwer.min.js") },
      {
        content: `window.headset = new IWER.XRDevice(IWER.metaQuest3, { stereoEnabled: true, ipd: 0.063 });
          window.headset.installRuntime({ forceInstall: true });`,
      },
    ];
    return this.open(hash, errors, viewport, scripts);
  }

  /** Opens the viewer; `hash` as in a link. Errors of the page fail the test through `errors`. */
  async open(
    hash = "",
    errors: string[] = [],
    viewport = kUsual,
    scripts: { path?: string; content?: string }[] = [],
  ): Promise<Page> {
    const page = await this.openPage(this.url + hash, errors, viewport, scripts);
    await page.waitForFunction(() => window.clipgs !== undefined);
    return page;
  }

  /** Opens any page in the same browser. */
  async openPage(
    url: string,
    errors: string[] = [],
    viewport = kUsual,
    scripts: { path?: string; content?: string }[] = [],
  ): Promise<Page> {
    const { scale: deviceScaleFactor = kUsual.scale, ...size } = viewport;
    const page = await this.#browser.newPage({ viewport: size, deviceScaleFactor, ignoreHTTPSErrors: true });
    for (const script of [kExpert, kNoHint, ...scripts]) {
      await page.addInitScript(script);
    }
    page.setDefaultTimeout(kPageMs);
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(url);
    return page;
  }

  /** Pages that remember what others of it were told. */
  async context(): Promise<BrowserContext> {
    const { scale: deviceScaleFactor, ...viewport } = kUsual;
    const context = await this.#browser.newContext({ ignoreHTTPSErrors: true, viewport, deviceScaleFactor });
    await context.addInitScript(kExpert);
    return context;
  }

  override async stop(): Promise<number | null> {
    await this.#browser?.close();
    return super.stop();
  }
}
