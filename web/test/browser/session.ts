import { execFileSync, spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { type Browser, chromium, type Page } from "playwright-core";

/** The program that serves and renders; the build of the C++ side names it. */
export const kProgram = resolve(process.env["CLIPGS"] ?? "../build/release/src/cli/clipgs");
const kChromium = process.env["CHROMIUM"] ?? "/usr/bin/chromium";

/** Why these tests cannot run here, or nothing. Where the program is named, it must be there. */
export const missing = process.env["CLIPGS"]
  ? undefined
  : [kProgram, kChromium].find((path) => !existsSync(path));

/** Runs the program and returns what it prints. */
export function clipgs(...args: string[]): string {
  return execFileSync(kProgram, ["--quiet", ...args], {
    stdio: ["ignore", "pipe", "inherit"],
    encoding: "utf8",
  });
}

/** A case made of the phantom: hardly trained, but with everything a case has. */
export function makePhantomCase(work: string, out: string): void {
  const at = (name: string) => join(work, name);
  clipgs("phantom", at("phantom.nii.gz"), "--size", "96");
  clipgs(
    "dataset",
    at("phantom.nii.gz"),
    "-o",
    at("dataset"),
    "--preset",
    "skin-and-bone",
    "--size",
    "96",
    "--train-frames",
    "24",
    "--train-spp",
    "4",
    "--test-frames",
    "1",
    "--test-noise-db",
    "15",
    "--test-spp",
    "8",
    "--points",
    "20000",
  );
  clipgs(
    "train",
    at("dataset"),
    "-o",
    at("scene.ply"),
    "--steps",
    "100",
    "--budget",
    "20000",
    "--sh-degree",
    "3",
  );
  clipgs("pack", at("scene.ply"), "-o", out, "--title", "Torso phantom");
}

/** A served folder of cases and a browser that looks at it. */
export class Session {
  readonly folder = mkdtempSync(join(tmpdir(), "clipgs-browser-"));
  readonly cases = join(this.folder, "cases");
  url = "";
  #server!: ChildProcess;
  #browser!: Browser;

  /** Serves what `makeCases` puts into the folder of cases. */
  async start(makeCases: (cases: string) => void): Promise<void> {
    mkdirSync(this.cases, { recursive: true });
    makeCases(this.cases);
    this.#server = spawn(kProgram, ["serve", this.cases, "--port", "0", "--json"], {
      stdio: ["ignore", "pipe", "inherit"],
    });
    const line = await new Promise<string>((done) =>
      createInterface(this.#server.stdout!).once("line", done),
    );
    this.url = (JSON.parse(line) as { url: string }).url;
    this.#browser = await chromium.launch({
      executablePath: kChromium,
      args: [
        "--headless=new",
        "--no-sandbox",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--enable-unsafe-swiftshader",
      ],
    });
  }

  /** Opens the viewer; `hash` as in a link. Errors of the page fail the test through `errors`. */
  async open(hash = "", errors: string[] = []): Promise<Page> {
    const page = await this.#browser.newPage({ viewport: { width: 900, height: 600 } });
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(this.url + hash);
    await page.waitForFunction(() => window.clipgs !== undefined);
    return page;
  }

  /** How the server ends when it is asked to. */
  async stop(): Promise<number | null> {
    await this.#browser?.close();
    const ended = new Promise<number | null>((done) => this.#server.once("exit", done));
    this.#server.kill("SIGTERM");
    const status = await ended;
    rmSync(this.folder, { recursive: true, force: true });
    return status;
  }
}
