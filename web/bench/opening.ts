// What is seen of a case while it comes through a slow network, and when. Prints Markdown.
//
//   npx vite-node bench/opening.ts -- CASE.sog
//
// The viewer's code comes through the same network, compressed as the server sends it, into a browser that has nothing
// kept and draws without a GPU. Seconds from the request; medians.

import { copyFileSync } from "node:fs";
import { basename, join } from "node:path";

import { launchBrowser } from "../test/browser/session";
import { Server } from "../test/browser/server";
import { startSlowProxy } from "../test/browser/slow_proxy";
import { median, table } from "./measure";

const kRounds = 3;
const kSampleMs = 20;
const kRates = [250e3, 1e6, 1e9]; // bytes a second; the last: loopback
const [file = ""] = process.argv.slice(2).filter((argument) => argument !== "--");

interface Times {
  shell: number; // first contentful paint
  picture: number; // of the body, ms
  share: number; // of the case that had been given then
  whole: number; // with all that cuts need
}

/** `name` is a case of `server`'s. */
async function once(server: Server, name: string, rate: number): Promise<Times> {
  const proxy = await startSlowProxy(server.url, "/", rate, `/cases/${name}.sog`);
  const browser = await launchBrowser();
  try {
    const page = await browser.newPage({ viewport: { width: 1024, height: 768 } });
    page.setDefaultTimeout(600_000);
    const samples: { at: number; given: number }[] = [];
    const sampling = setInterval(() => samples.push({ at: Date.now(), given: proxy.given() }), kSampleMs);
    await page.goto(`${proxy.url}#case=${name}`, { waitUntil: "commit" });
    await page.waitForFunction(() => window.clipgs !== undefined);
    const seen = await page.evaluate(async () => {
      await window.clipgs.ready;
      const [shell] = performance.getEntriesByName("first-contentful-paint");
      const [picture] = performance.getEntriesByName("clipgs: picture");
      const times = { shell: shell!.startTime, picture: picture!.startTime, whole: performance.now() };
      return { ...times, origin: performance.timeOrigin };
    });
    clearInterval(sampling);
    const given = samples.filter(({ at }) => at <= seen.origin + seen.picture).at(-1)?.given ?? 0;
    return { ...seen, share: given / proxy.whole() };
  } finally {
    await browser.close();
    proxy.stop();
  }
}

const server = new Server();
await server.start((cases) => copyFileSync(file, join(cases, basename(file))));
const rows: string[][] = [];
for (const rate of kRates) {
  const rounds: Times[] = [];
  for (let i = 0; i < kRounds; ++i) {
    rounds.push(await once(server, basename(file, ".sog"), rate));
  }
  const of = (key: keyof Times) => median(rounds.map((times) => times[key]));
  const seconds = (key: keyof Times) => (of(key) / 1000).toFixed(2);
  const network = rate < 1e9 ? `${rate / 1e3} KB/s` : "loopback";
  rows.push([
    network,
    seconds("shell"),
    seconds("picture"),
    `${Math.round(100 * of("share"))} %`,
    seconds("whole"),
  ]);
}
await server.stop();
console.log(table(["", "shell", "first picture", "of the bytes", "can be cut"], rows));
