import { execFile, spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { promisify } from "node:util";
import { type Browser, chromium, type Page } from "playwright-core";

/** The program that serves and renders; the build of the C++ side names it. */
export const kProgram = resolve(process.env["CLIPGS"] ?? "../build/release/src/cli/clipgs");
const kChromium = process.env["CHROMIUM"] ?? "/usr/bin/chromium";

/** Why these tests cannot run here, or nothing. Where the program is named, it must be there. */
export const missing = process.env["CLIPGS"]
  ? undefined
  : [kProgram, kChromium].find((path) => !existsSync(path));

/** Of what waits for the page: long, as pictures are drawn without a GPU. Tests have more time (vite.config.ts). */
const kPageMs = 120_000;

/** Runs the program and returns what it prints. Not synchronously: the test runner expects to be answered meanwhile. */
export async function clipgs(...args: string[]): Promise<string> {
  const { stdout } = await promisify(execFile)(kProgram, ["--quiet", ...args]);
  return stdout;
}

/** A case of a volume, in the folder `work`: hardly trained, but with everything a case has. */
async function makeCase(
  volume: string,
  preset: string,
  title: string,
  work: string,
  out: string,
): Promise<void> {
  const dataset = join(work, "dataset");
  const scene = join(work, "scene.ply");
  const pictures =
    "--size 96 --train-frames 24 --train-spp 4 --test-frames 1 --test-noise-db 15 --test-spp 8";
  await clipgs(
    "dataset",
    volume,
    "-o",
    dataset,
    "--preset",
    preset,
    ...pictures.split(" "),
    "--points",
    "20000",
  );
  await clipgs("train", dataset, "-o", scene, ..."--steps 100 --budget 20000 --sh-degree 3".split(" "));
  await clipgs("pack", scene, "-o", out, "--title", title);
}

export async function makePhantomCase(work: string, out: string): Promise<void> {
  const volume = join(work, "phantom.nii.gz");
  await clipgs("phantom", volume, "--size", "96");
  await makeCase(volume, "skin-and-bone", "Torso phantom", work, out);
}

/** A case of the same pictures without a section: its splats are solid and have face colours. */
export async function makeSolidCase(work: string, out: string): Promise<void> {
  const scene = join(work, "solid.ply");
  const options = "--no-section --steps 300 --budget 20000 --sh-degree 1".split(" ");
  await clipgs("train", join(work, "dataset"), "-o", scene, ...options);
  await clipgs("pack", scene, "-o", out, "--title", "Solid phantom");
}

/** A case of colour photographs: a ball with stripes of three colours, and a hole in it, on black. */
export async function makePhotoCase(work: string, out: string): Promise<void> {
  const n = 48;
  const colors = [
    [200, 120, 90],
    [90, 160, 110],
    [230, 220, 200],
  ] as const;
  const rgb = Buffer.alloc(3 * n ** 3);
  for (let i = 0; i < n ** 3; ++i) {
    const [x, y, z] = [i % n, Math.floor(i / n) % n, Math.floor(i / n ** 2)].map((at) => at - 0.5 * (n - 1));
    const radius = Math.hypot(x!, y!, z!);
    if (radius < 20 && Math.hypot(x! - 5, y! + 4) > 5) {
      rgb.set(colors[Math.floor((x! + 2 * z! + 90) / 7) % 3]!, 3 * i);
    }
  }
  const header = [
    "NRRD0004",
    "type: uchar",
    "dimension: 4",
    `sizes: 3 ${n} ${n} ${n}`,
    "space: right-anterior-superior",
    "space directions: none (2,0,0) (0,2,0) (0,0,2)",
    "space origin: (-47,-47,-47)",
    "kinds: RGB-color domain domain domain",
    "encoding: raw",
  ];
  mkdirSync(work);
  const volume = join(work, "photo.nrrd");
  writeFileSync(volume, Buffer.concat([Buffer.from(`${header.join("\n")}\n\n`), rgb]));
  await makeCase(volume, "photo", "Striped ball", work, out);
}

/** A served folder of cases and a browser that looks at it. */
export class Session {
  readonly folder = mkdtempSync(join(tmpdir(), "clipgs-browser-"));
  readonly cases = join(this.folder, "cases");
  url = "";
  #server!: ChildProcess;
  #browser!: Browser;

  /** Serves what `makeCases` puts into the folder of cases. */
  async start(makeCases: (cases: string) => Promise<void>): Promise<void> {
    mkdirSync(this.cases, { recursive: true });
    await makeCases(this.cases);
    this.#server = spawn(kProgram, ["serve", this.cases, "--port", "0", "--json"], {
      stdio: ["ignore", "pipe", "inherit"],
    });
    const line = await new Promise<string>((done, fail) => {
      createInterface(this.#server.stdout!).once("line", done);
      this.#server.once("exit", () => fail(new Error("clipgs serve ended before it served")));
    });
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

  /** Opens the viewer in a browser with an emulated Quest 3, whose eyes see pictures of half that size. */
  async openInHeadset(hash = "", errors: string[] = []): Promise<Page> {
    const scripts = [
      { path: resolve("node_modules/iwer/build/iwer.min.js") },
      {
        content: `window.headset = new IWER.XRDevice(IWER.metaQuest3, { stereoEnabled: true, ipd: 0.063 });
          window.headset.installRuntime({ forceInstall: true });`,
      },
    ];
    return this.open(hash, errors, { width: 560, height: 400 }, scripts);
  }

  /** Opens the viewer; `hash` as in a link. Errors of the page fail the test through `errors`. */
  async open(
    hash = "",
    errors: string[] = [],
    viewport = { width: 900, height: 600 },
    scripts: { path?: string; content?: string }[] = [],
  ): Promise<Page> {
    const page = await this.#browser.newPage({ viewport });
    for (const script of scripts) {
      await page.addInitScript(script);
    }
    page.setDefaultTimeout(kPageMs);
    page.on("pageerror", (error) => errors.push(error.message));
    await page.goto(this.url + hash);
    await page.waitForFunction(() => window.clipgs !== undefined);
    return page;
  }

  /** How the server ends when it is asked to. */
  async stop(): Promise<number | null> {
    await this.#browser?.close();
    if (this.#server?.exitCode === null) {
      const ended = new Promise((done) => this.#server.once("exit", done));
      this.#server.kill("SIGTERM");
      await ended;
    }
    const status = this.#server?.exitCode ?? null;
    rmSync(this.folder, { recursive: true, force: true });
    return status;
  }
}
