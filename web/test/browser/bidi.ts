// Firefox, driven by WebDriver BiDi (https://www.w3.org/TR/webdriver-bidi/), which it speaks itself: no driver is needed.

import WebSocket from "ws";

import { type Browser, inPage, kActions, type Spot, type Tab } from "./tab";

interface Message {
  id?: number;
  type: string;
  result?: unknown;
  error?: string;
  message?: string;
}

/** What is asked over a socket and answered. */
class Connection {
  readonly #socket: WebSocket;
  readonly #waiting = new Map<number, (message: Message) => void>();
  #asked = 0;

  constructor(socket: WebSocket) {
    this.#socket = socket;
    socket.on("message", (data: Buffer) => {
      const message = JSON.parse(data.toString()) as Message;
      this.#waiting.get(message.id ?? -1)?.(message);
      this.#waiting.delete(message.id ?? -1);
    });
    socket.on("close", () => {
      this.#waiting.forEach((answer) => answer({ type: "error", error: "the browser has gone" }));
      this.#waiting.clear();
    });
  }

  async ask<T>(method: string, params: unknown): Promise<T> {
    const id = ++this.#asked;
    const answer = await new Promise<Message>((resolve) => {
      this.#waiting.set(id, resolve);
      this.#socket.send(JSON.stringify({ id, method, params }));
    });
    if (answer.type === "error") {
      throw new Error(`${answer.error}: ${answer.message}`);
    }
    return answer.result as T;
  }
}

class BidiTab implements Tab {
  readonly #connection: Connection;
  readonly #context: string;

  constructor(connection: Connection, context: string) {
    this.#connection = connection;
    this.#context = context;
  }

  async open(url: string): Promise<void> {
    await this.#ask("browsingContext.navigate", { url, wait: "complete" });
  }

  async evaluate<R>(what: (given: never) => R | Promise<R>, given?: unknown): Promise<R> {
    const answer = await this.#connection.ask<{
      result: { value: string };
      exceptionDetails?: { text: string };
    }>("script.evaluate", {
      expression: inPage(what, given),
      target: { context: this.#context },
      awaitPromise: true,
      userActivation: true,
    });
    if (answer.exceptionDetails) {
      throw new Error(answer.exceptionDetails.text);
    }
    return JSON.parse(answer.result.value) as R;
  }

  async move(to: Spot): Promise<void> {
    await this.#ask("input.performActions", { actions: kActions.move(to) });
  }

  async click(at: Spot): Promise<void> {
    await this.#ask("input.performActions", { actions: kActions.click(at) });
  }

  async press(key: string): Promise<void> {
    await this.#ask("input.performActions", { actions: kActions.press(key) });
  }

  async screenshot(): Promise<Buffer> {
    const { data } = await this.#ask<{ data: string }>("browsingContext.captureScreenshot", {});
    return Buffer.from(data, "base64");
  }

  #ask<T>(method: string, params: object): Promise<T> {
    return this.#connection.ask<T>(method, { context: this.#context, ...params });
  }
}

/** The browser that listens at an address, as it says when it starts. */
export async function startBidi(address: string): Promise<Browser> {
  const socket = new WebSocket(`${address}/session`, { maxPayload: 1 << 28 });
  await new Promise<void>((resolve, reject) => socket.once("open", resolve).once("error", reject));
  const connection = new Connection(socket);
  const { capabilities } = await connection.ask<{
    capabilities: { browserName: string; browserVersion: string };
  }>("session.new", { capabilities: {} });
  const { contexts } = await connection.ask<{ contexts: { context: string }[] }>(
    "browsingContext.getTree",
    {},
  );
  return {
    tab: new BidiTab(connection, contexts[0]!.context),
    version: `${capabilities.browserName} ${capabilities.browserVersion}`,
    close: async () => {
      await connection.ask("browser.close", {}).catch(() => {}); // it may go before it answers
      socket.close();
    },
  };
}
