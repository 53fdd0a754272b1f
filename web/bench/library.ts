// What a folder of many cases costs: the server's list of them, the first picture, and the library of the page. Prints
// Markdown.
//
//   npx vite-node bench/library.ts -- CASE.sog [COUNT]
//
// COUNT (1,000) copies of CASE, each with a title, region and date of its own, are served from a warm disk; the browser
// draws without a GPU. Tasks are those of the page's main thread that take more than 50 ms, by the clock, which others on
// the machine make longer, and by that of the CPU.

import { readFileSync, statSync } from "node:fs";

import { makeManyCases } from "../test/browser/many_cases";
import { Session } from "../test/browser/session";
import { table } from "./measure";

const [file = "", count = "1000"] = process.argv.slice(2);
const session = new Session();
await session.start((cases) => makeManyCases(file, Number(count), cases));

/** The program's memory, MB: now, and at its highest. */
function memory(): { now: string; most: string } {
  const status = readFileSync(`/proc/${session.pid}/status`, "utf8");
  const of = (key: string) => (Number(new RegExp(`${key}:\\s+(\\d+)`).exec(status)![1]) / 1000).toFixed(0);
  return { now: of("VmRSS"), most: of("VmHWM") };
}

async function listed(): Promise<{ ms: number; bytes: number }> {
  const start = performance.now();
  const text = await (await fetch(`${session.url}api/cases`)).text();
  return { ms: performance.now() - start, bytes: text.length };
}

try {
  const page = await session.open("", [], { width: 1024, height: 768, scale: 1 });
  await page.evaluate(() => window.clipgs.ready);
  const picture = await page.evaluate(() => performance.getEntriesByName("clipgs: picture")[0]!.startTime);
  await page.waitForTimeout(3000); // until all is drawn and at rest
  const again = await listed();

  const devtools = await page.context().newCDPSession(page);
  /** The tasks of the page's main thread while something is done, and until all is there that it shows. */
  const tasks = async (work: () => Promise<unknown>): Promise<string> => {
    const events: TraceEvent[] = [];
    const collect = ({ value }: { value: unknown[] }) => void events.push(...(value as TraceEvent[]));
    devtools.on("Tracing.dataCollected", collect);
    await devtools.send("Tracing.start", { traceConfig: { includedCategories: ["toplevel"] } });
    await work();
    await page.waitForTimeout(1000);
    const complete = new Promise((done) => devtools.once("Tracing.tracingComplete", done));
    await devtools.send("Tracing.end");
    await complete;
    devtools.off("Tracing.dataCollected", collect);
    return summary(events);
  };
  const library = page.getByRole("dialog", { name: "Cases" });
  const cards = (number: number) =>
    page.waitForFunction((n) => document.querySelectorAll("dialog.library .card").length === n, number);
  const rows = [
    [
      "opened",
      await tasks(async () => {
        await page.keyboard.press("m");
        await cards(Number(count));
      }),
    ],
    [
      "searched for, letter by letter",
      await tasks(() => library.getByRole("searchbox").pressSequentially("knee 10")),
    ],
    ["all shown again", await tasks(() => library.getByRole("searchbox").fill(""))],
    ["sorted by date", await tasks(() => library.getByRole("combobox").selectOption("date"))],
    [
      "scrolled to its end",
      await tasks(() =>
        library.evaluate(async (dialog) => {
          const list = dialog.querySelector(".cards")!;
          for (let i = 0; i < 60; ++i) {
            list.scrollTop += list.scrollHeight / 60;
            await new Promise((next) => requestAnimationFrame(next));
          }
        }),
      ),
    ],
  ];
  const { now, most } = memory();
  console.log(
    table(
      [`${count} cases of ${(statSync(file).size / 1e6).toFixed(1)} MB`, ""],
      [
        ["first picture of the page, of a server that has read none", `${(picture / 1000).toFixed(2)} s`],
        ["the list again", `${again.ms.toFixed(0)} ms, ${(again.bytes / 1000).toFixed(0)} KB`],
        ["memory of the server, at its highest", `${now} MB, ${most} MB`],
        ...rows.map(([what, long]) => [`library ${what}: long tasks`, long!]),
      ],
    ),
  );
} finally {
  await session.stop();
}

/** Of Chromium's traces; µs. */
interface TraceEvent {
  name: string;
  pid: number;
  tid: number;
  dur?: number;
  tdur?: number; // of the CPU
  args: { name?: string };
}

/** How many tasks are long, and the longest by the clock and by the CPU. */
function summary(events: readonly TraceEvent[]): string {
  const thread = ({ pid, tid }: TraceEvent) => `${pid} ${tid}`;
  const isMain = ({ name, args }: TraceEvent) => name === "thread_name" && args.name === "CrRendererMain";
  const main = new Set(events.filter(isMain).map(thread));
  const run = events.filter((one) => one.name.endsWith("RunTask") && main.has(thread(one)));
  const longest = (of: "dur" | "tdur") => Math.max(0, ...run.map((one) => (one[of] ?? 0) / 1000)).toFixed(0);
  const long = (of: "dur" | "tdur") => run.filter((one) => (one[of] ?? 0) > 50_000).length;
  return `${long("dur")}, the longest ${longest("dur")} ms; by the CPU's clock ${long("tdur")}, ${longest("tdur")} ms`;
}
