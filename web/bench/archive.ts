// When a case that a server is about to have is seen: waits for the first one in its list, opens it, and prints its name
// and the time, s since 1970, of the body's first picture.
//
//   npx vite-node bench/archive.ts -- http://127.0.0.1:8080/
//
// The browser is running, as it is on most desks; it draws without a GPU.

import { launchBrowser } from "../test/browser/session";

const [url = ""] = process.argv.slice(2);

async function firstCase(): Promise<string> {
  for (;;) {
    const { cases } = (await (await fetch(new URL("api/cases", url))).json()) as {
      cases: { name: string }[];
    };
    if (cases[0]) {
      return cases[0].name;
    }
    await new Promise((done) => setTimeout(done, 100));
  }
}

const browser = await launchBrowser();
try {
  const page = await browser.newPage({ viewport: { width: 1024, height: 768 } });
  page.setDefaultTimeout(600_000);
  console.error("waiting"); // for who starts the sending
  const name = await firstCase();
  await page.goto(`${url}#case=${encodeURIComponent(name)}`);
  await page.waitForFunction(() => window.clipgs !== undefined);
  await page.evaluate(() => window.clipgs.ready);
  const seen = await page.evaluate(() => {
    const [mark] = performance.getEntriesByName("clipgs: picture");
    return performance.timeOrigin + mark!.startTime;
  });
  console.log(name, (seen / 1000).toFixed(2));
} finally {
  await browser.close();
}
