// Chromium and WebKitGTK, driven by the W3C's WebDriver (https://www.w3.org/TR/webdriver2/) through drivers of their own.

import type { ChildProcess } from "node:child_process";

import { type Browser, inPage, kActions, type Spot, type Tab } from "./tab";

/** Of what a page does: long, as pictures are drawn without a GPU. */
const kPageMs = 120_000;

async function ask<T>(method: "POST" | "DELETE", url: string, body: unknown = {}): Promise<T> {
  const response = await fetch(url, { method, body: method === "POST" ? JSON.stringify(body) : null });
  const { value } = (await response.json()) as { value: T & { error?: string; message?: string } };
  if (!response.ok) {
    throw new Error(`${value.error}: ${value.message}`);
  }
  return value;
}

class WebDriverTab implements Tab {
  readonly #session: string;

  constructor(session: string) {
    this.#session = session;
  }

  async open(url: string): Promise<void> {
    await this.#post("url", { url });
  }

  async evaluate<R>(what: (given: never) => R | Promise<R>, given?: unknown): Promise<R> {
    const script = `const done = arguments[0];
      ${inPage(what, given)}.then((json) => done({ json }), (error) => done({ error: String(error?.message ?? error) }));`;
    const { json, error } = await this.#post<{ json: string; error?: string }>("execute/async", {
      script,
      args: [],
    });
    if (error !== undefined) {
      throw new Error(error);
    }
    return JSON.parse(json) as R;
  }

  async move(to: Spot): Promise<void> {
    await this.#post("actions", { actions: kActions.move(to) });
  }

  async click(at: Spot): Promise<void> {
    await this.#post("actions", { actions: kActions.click(at) });
  }

  async press(key: string): Promise<void> {
    await this.#post("actions", { actions: kActions.press(key) });
  }

  async screenshot(): Promise<Buffer> {
    const response = await fetch(`${this.#session}/screenshot`);
    return Buffer.from(((await response.json()) as { value: string }).value, "base64");
  }

  #post<T>(path: string, body: unknown): Promise<T> {
    return ask<T>("POST", `${this.#session}/${path}`, body);
  }
}

/** A browser of a driver that listens at `port` and ends with it. */
export async function startWebDriver(
  driver: ChildProcess,
  port: number,
  capabilities: Record<string, unknown>,
): Promise<Browser> {
  const root = `http://127.0.0.1:${port}`;
  await answering(`${root}/status`, driver);
  const { sessionId, capabilities: got } = await ask<{
    sessionId: string;
    capabilities: { browserName: string; browserVersion: string };
  }>("POST", `${root}/session`, { capabilities: { alwaysMatch: capabilities } });
  const session = `${root}/session/${sessionId}`;
  await ask("POST", `${session}/timeouts`, { script: kPageMs, pageLoad: kPageMs });
  return {
    tab: new WebDriverTab(session),
    version: `${got.browserName} ${got.browserVersion}`,
    close: async () => void (await ask("DELETE", session)),
  };
}

/** Until a driver is there. */
async function answering(url: string, driver: ChildProcess): Promise<void> {
  for (const end = Date.now() + kPageMs; Date.now() < end; ) {
    if (driver.exitCode !== null) {
      throw new Error(`the browser's driver ended with ${driver.exitCode}`);
    }
    if (
      await fetch(url).then(
        ({ ok }) => ok,
        () => false,
      )
    ) {
      return;
    }
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  throw new Error("the browser's driver does not answer");
}
