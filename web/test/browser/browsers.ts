import { type ChildProcess, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { type AddressInfo, createServer } from "node:net";
import { tmpdir } from "node:os";
import { delimiter, join } from "node:path";
import { createInterface } from "node:readline";
import type { Readable } from "node:stream";

import { startBidi } from "./bidi";
import { kChromium } from "./program";
import type { Browser } from "./tab";
import { startWebDriver } from "./webdriver";

/** Those that the viewer is tested in. */
export const kBrowsers = ["chromium", "firefox", "webkit"] as const;
export type BrowserName = (typeof kBrowsers)[number];

const kFirefox = process.env["FIREFOX"] ?? "firefox-esr";
/** WebKitGTK's own browser, which lies beside its library. */
const kMiniBrowser = readdirSync("/usr/lib")
  .flatMap((machine) =>
    ["webkit2gtk-4.1", "webkit2gtk-4.0", "webkitgtk-6.0"].map((api) => join(machine, api)),
  )
  .map((folder) => join("/usr/lib", folder, "MiniBrowser"))
  .find((path) => existsSync(path));

/** Of a window, CSS px: pixels are what takes time without a GPU. */
const [kWidth, kHeight] = [900, 600];

/** The programs that each needs (scripts/setup.sh). */
const kNeeds: Record<BrowserName, string[]> = {
  chromium: [kChromium, "chromedriver"],
  firefox: [kFirefox, "Xvfb"],
  webkit: [kMiniBrowser ?? "MiniBrowser of WebKitGTK", "WebKitWebDriver", "Xvfb"],
};

/** Why a browser cannot be tested here; undefined: it can. */
export function missingFor(name: BrowserName): string | undefined {
  const missing = kNeeds[name].find((program) => !isThere(program));
  return missing && `${missing} is missing`;
}

function isThere(program: string): boolean {
  const folders = program.startsWith("/") ? [""] : (process.env["PATH"] ?? "").split(delimiter);
  return folders.some((folder) => existsSync(join(folder, program)));
}

async function freePort(): Promise<number> {
  const server = createServer();
  await new Promise<void>((listening) => server.listen(0, "127.0.0.1", listening));
  const { port } = server.address() as AddressInfo;
  await new Promise((closed) => server.close(closed));
  return port;
}

type Run = (program: string, args: string[], environment?: Record<string, string>) => ChildProcess;

/** Starts a browser that draws without a GPU, with a folder of its own for what it remembers. */
export async function startBrowser(name: BrowserName): Promise<Browser> {
  const folder = mkdtempSync(join(tmpdir(), `clipgs-${name}-`));
  const running: ChildProcess[] = [];
  const run: Run = (program, args, environment = {}) => {
    const child = spawn(program, args, {
      stdio: ["ignore", "ignore", "pipe", "pipe"],
      env: { ...process.env, HOME: folder, ...environment },
      detached: true, // so that what it starts ends with it
    });
    child.stderr!.resume();
    running.push(child);
    return child;
  };
  const end = async (): Promise<void> => {
    for (const child of running.reverse()) {
      if (child.exitCode === null && child.signalCode === null) {
        const ended = new Promise((done) => child.once("exit", done));
        process.kill(-child.pid!, "SIGTERM");
        await ended;
      }
    }
    rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
  };
  try {
    const browser = await kStarts[name](run, folder);
    return {
      ...browser,
      close: async () => {
        await browser.close();
        await end();
      },
    };
  } catch (error) {
    await end();
    throw error;
  }
}

const kStarts: Record<BrowserName, (run: Run, folder: string) => Promise<Browser>> = {
  async chromium(run, folder) {
    const port = await freePort();
    const args = [
      "--headless=new",
      "--no-sandbox",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      "--enable-unsafe-swiftshader",
      "--force-device-scale-factor=0.5", // its own renderer is the slowest of the three
      `--window-size=${kWidth},${kHeight}`,
      `--user-data-dir=${folder}`,
    ];
    return startWebDriver(run("chromedriver", [`--port=${port}`]), port, {
      browserName: "chrome",
      "goog:chromeOptions": { binary: kChromium, args },
    });
  },

  async firefox(run, folder) {
    const settings = { "webgl.force-enabled": true, "datareporting.policy.dataSubmissionEnabled": false };
    const lines = Object.entries(settings).map(([key, value]) => `user_pref("${key}", ${value});\n`);
    const profile = join(folder, "profile");
    mkdirSync(profile);
    writeFileSync(join(profile, "user.js"), lines.join(""));
    // Not --headless: it has no WebGL then.
    const args = ["--no-remote", "--profile", profile, "--remote-debugging-port=0"];
    args.push("--width", String(kWidth), "--height", String(kHeight));
    const firefox = run(kFirefox, args, await startScreen(run));
    const address = await lineOf(firefox, firefox.stderr!, /WebDriver BiDi listening on (ws:\S+)/);
    return startBidi(address);
  },

  async webkit(run) {
    const port = await freePort();
    const driver = run("WebKitWebDriver", [`--port=${port}`], await startScreen(run));
    return startWebDriver(driver, port, {
      browserName: "MiniBrowser",
      "webkitgtk:browserOptions": {
        binary: kMiniBrowser,
        args: ["--automation", `--geometry=${kWidth}x${kHeight}`],
      },
    });
  },
};

/** Starts a screen that nobody sees; returns the environment of what is shown there. */
async function startScreen(run: Run): Promise<Record<string, string>> {
  const args = ["-displayfd", "3", "-screen", "0", "1280x1024x24", "-nolisten", "tcp"];
  const screen = run("Xvfb", args);
  const display = await lineOf(screen, screen.stdio[3] as Readable, /(\d+)/);
  return { DISPLAY: `:${display}`, GDK_BACKEND: "x11", LIBGL_ALWAYS_SOFTWARE: "1", NO_AT_BRIDGE: "1" };
}

/** What a program says there, once it does. */
function lineOf(program: ChildProcess, output: Readable, pattern: RegExp): Promise<string> {
  return new Promise((found, fail) => {
    program.once("exit", (code) =>
      fail(new Error(`${program.spawnfile} ended with ${code} before it was ready`)),
    );
    createInterface(output).on("line", (line) => {
      const said = pattern.exec(line);
      if (said) {
        found(said[1]!);
      }
    });
  });
}
