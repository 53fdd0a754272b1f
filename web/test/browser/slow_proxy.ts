import { createServer, request } from "node:http";
import type { AddressInfo } from "node:net";

const kPart = 8192; // bytes
const kPause = 50; // ms

/** A server that passes on what another one answers, all but one file at once, and counts what it gives of that. */
export interface SlowProxy {
  url: string;
  /** Bytes of that file, of its last answer: given, and all. */
  given(): number;
  whole(): number;
  /** Once that answer is over, however it ended. */
  ended(): Promise<void>;
  stop(): void;
}

export async function startSlowProxy(url: string, slowPath: string): Promise<SlowProxy> {
  let given = 0;
  let whole = 0;
  let ended = Promise.resolve();
  const server = createServer((incoming, response) => {
    const options = { method: incoming.method, headers: { ...incoming.headers, host: new URL(url).host } };
    const forwarded = request(new URL(incoming.url!, url), options, async (answer) => {
      response.writeHead(answer.statusCode!, answer.headers);
      if (!incoming.url!.startsWith(slowPath)) {
        answer.pipe(response);
        return;
      }
      ended = new Promise((done) => response.once("close", done));
      const parts: Buffer[] = [];
      for await (const part of answer) {
        parts.push(part as Buffer);
      }
      const file = Buffer.concat(parts);
      whole = file.length;
      for (given = 0; given < whole && !response.destroyed; given += kPart) {
        response.write(file.subarray(given, given + kPart));
        await new Promise((resume) => setTimeout(resume, kPause));
      }
      response.end();
    });
    incoming.pipe(forwarded);
  });
  await new Promise<void>((listening) => server.listen(0, "127.0.0.1", listening));
  return {
    url: `http://127.0.0.1:${(server.address() as AddressInfo).port}/`,
    given: () => given,
    whole: () => whole,
    ended: () => ended,
    stop: () => {
      server.closeAllConnections();
      server.close();
    },
  };
}
