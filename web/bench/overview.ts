// What the overview of a thousand cases costs: to make it, until its first picture is seen, and to sort and search it.
// Prints Markdown.
//
//   npx vite-node bench/overview.ts -- CASE.sog [COUNT]
//
// COUNT (1,000) copies of CASE, with figures of chance and notes of a batch, lie on a warm disk; the browser draws without
// a GPU.

import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import type { Page } from "playwright-core";

import { makeManyCases } from "../test/browser/many_cases";
import { clipgs } from "../test/browser/program";
import { Session } from "../test/browser/session";
import { table } from "./measure";

const [file = "", count = "1000"] = process.argv.slice(2);
const kWindow = { width: 1024, height: 768, scale: 1 };
/** Says when the first picture was there. */
const kWatch = {
  content: `document.addEventListener("load", (event) => {
    if (event.target instanceof HTMLImageElement) window.firstPicture ??= performance.now();
  }, true);`,
};

/** What `clipgs eval` and a batch would write beside a case; the same at every run. */
function addNotes(folder: string, index: number): void {
  const name = `copy-${String(index).padStart(4, "0")}`;
  const chance = (Math.sin(index * 12.9898) * 43758.5453) % 1;
  const rows = ["test_axis", "test_oblique", "test_uncut"].map((split) => ({
    subject: name,
    clip: "exact",
    section: "volume",
    against: "truth",
    split,
    psnr_masked: 31 + chance,
    psnr_face: index % 97 === 5 ? 21 : 34 + chance,
  }));
  const figures = { rows, masked_noise_floor_db: { test_axis: 42 + chance } };
  writeFileSync(join(folder, `${name}.figures`), JSON.stringify(figures));
  const batch = join(folder, `${name}.clipgs-work`, "batch");
  mkdirSync(batch, { recursive: true });
  const record = { status: "done", seconds: 180 + 20 * chance, peak_mb: 900 };
  writeFileSync(join(batch, "build.json"), JSON.stringify(record));
  writeFileSync(join(batch, "build.log"), "warning: ct: took 312 ml of table, cushions and the like off\n");
}

let folder = "";
let seconds = 0;
const session = new Session();
await session.start(async (cases) => {
  folder = cases;
  await makeManyCases(file, Number(count), cases);
  for (let i = 0; i < Number(count); ++i) {
    addNotes(cases, i);
  }
  const start = performance.now();
  await clipgs("overview", cases);
  seconds = (performance.now() - start) / 1000;
});

/** The program's memory at its highest, MB. */
function memory(): string {
  const status = readFileSync(`/proc/${session.pid}/status`, "utf8");
  return (Number(/VmHWM:\s+(\d+)/.exec(status)![1]) / 1000).toFixed(0);
}

async function firstPicture(url: string): Promise<{ page: Page; seconds: string }> {
  const page = await session.openPage(url, [], kWindow, [kWatch]);
  const handle = await page.waitForFunction(() => (window as { firstPicture?: number }).firstPicture);
  return { page, seconds: (Number(await handle.jsonValue()) / 1000).toFixed(2) };
}

/** Milliseconds until the page has drawn what an action did. */
async function drawn(page: Page, action: string): Promise<string> {
  const ms = await page.evaluate(async (text) => {
    const start = performance.now();
    (0, eval)(text);
    await new Promise((next) => requestAnimationFrame(() => setTimeout(next)));
    return performance.now() - start;
  }, action);
  return `${ms.toFixed(0)} ms`;
}

try {
  const served = await firstPicture(`${session.url}overview/`);
  const opened = await firstPicture(`file://${join(folder, "overview", "index.html")}`);
  const { page } = opened;
  const fetched = await served.page.evaluate(
    () => performance.getEntriesByType("resource").filter((one) => one.name.endsWith(".webp")).length,
  );
  const page_kb = (readFileSync(join(folder, "overview", "index.html")).length / 1000).toFixed(0);
  const words = "document.forms[0].elements.words";
  const rows = [
    ["made by `clipgs overview`", `${seconds.toFixed(2)} s`],
    ["the page", `${page_kb} KB`],
    ["first picture, served", `${served.seconds} s; wanted: 2 s`],
    ["first picture, from the disk", `${opened.seconds} s`],
    ["pictures fetched until then, of those in sight and soon", String(fetched)],
    ["sorted by faces", await drawn(page, 'document.querySelector("[data-key=f0] button").click()')],
    [
      "searched for a word",
      await drawn(page, `${words}.value = "knee"; ${words}.dispatchEvent(new Event("input"))`),
    ],
    ["memory of the server, at its highest", `${memory()} MB; wanted: 200 MB`],
  ];
  console.log(table([`${count} cases`, ""], rows));
} finally {
  await session.stop();
}
