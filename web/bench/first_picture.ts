// How soon a volume is seen by whoever types `clipgs view VOLUME`: seconds from the command. Prints Markdown.
//
//   npx vite-node bench/first_picture.ts -- VOLUME [OPTIONS of clipgs view...]
//
// The browser is running, as it is on most desks; it draws without a GPU. The volume is read from a warm disk.

import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { createInterface } from "node:readline";

import { kProgram } from "../test/browser/program";
import { launchBrowser } from "../test/browser/session";
import { median, table } from "./measure";

const kRounds = 3;
const [volume = "", ...options] = process.argv.slice(2);

interface Times {
  address: number;
  picture: number; // the body, whole
  cut: number; // all that a cut shows is there
}

async function once(): Promise<Times> {
  const browser = await launchBrowser();
  const folder = mkdtempSync(join(tmpdir(), "clipgs-first-"));
  try {
    const page = await browser.newPage({ viewport: { width: 1024, height: 768 } });
    page.setDefaultTimeout(600_000);
    const start = Date.now();
    const program = spawn(kProgram, ["view", volume, ...options, "--no-open", "--work", folder], {
      stdio: ["ignore", "pipe", "ignore"],
    });
    const lines = createInterface(program.stdout);
    const url = await new Promise<string>((done) =>
      lines.on("line", (line) => line.includes("http://") && done(line.trim())),
    );
    const address = Date.now() - start;
    await page.goto(url);
    await page.waitForFunction(() => window.clipgs !== undefined);
    await page.evaluate(() => window.clipgs.ready);
    const cut = Date.now() - start;
    const picture = await page.evaluate(() => {
      const [mark] = performance.getEntriesByName("clipgs: picture");
      return performance.timeOrigin + mark!.startTime;
    });
    program.kill("SIGTERM");
    await new Promise((done) => program.once("exit", done));
    return { address, picture: picture - start, cut };
  } finally {
    await browser.close();
    rmSync(folder, { recursive: true, force: true });
  }
}

if (statSync(volume).isFile()) {
  readFileSync(volume);
}
const rounds: Times[] = [];
for (let i = 0; i < kRounds; ++i) {
  rounds.push(await once());
}
const seconds = (of: keyof Times) => (median(rounds.map((times) => times[of])) / 1000).toFixed(1);
console.log(
  table(
    ["s from the command", "address printed", "first picture", "can be cut"],
    [[basename(volume), seconds("address"), seconds("picture"), seconds("cut")]],
  ),
);
