import { createServer, request } from "node:http";
import type { AddressInfo } from "node:net";

const kPart = 4096; // bytes
/** As of a file of 8 KiB twenty times a second. */
const kUsualRate = 163_840;

/** A server that passes on what another one answers, some of it slowly, and counts what it gives of that. */
export interface SlowProxy {
  url: string;
  /** Bytes of the last slow answer to what `counted` begins with: given, and all. */
  given(): number;
  whole(): number;
  /** Once that answer is over, however it ended. */
  ended(): Promise<void>;
  stop(): void;
}

/** What begins with `slowPath` shares `rate` bytes a second; what begins with `counted` of it is counted. */
export async function startSlowProxy(
  url: string,
  slowPath: string,
  rate = kUsualRate,
  counted = slowPath,
): Promise<SlowProxy> {
  let given = 0;
  let whole = 0;
  let ended = Promise.resolve();
  let free = 0; // when the next bytes may go, ms
  const turn = async (bytes: number): Promise<void> => {
    const now = performance.now();
    free = Math.max(now, free) + (1000 * bytes) / rate;
    await new Promise((resume) => setTimeout(resume, free - now));
  };
  const server = createServer((incoming, response) => {
    const options = { method: incoming.method, headers: { ...incoming.headers, host: new URL(url).host } };
    const forwarded = request(new URL(incoming.url!, url), options, async (answer) => {
      response.writeHead(answer.statusCode!, answer.headers);
      if (!incoming.url!.startsWith(slowPath)) {
        answer.pipe(response);
        return;
      }
      const counts = incoming.url!.startsWith(counted);
      if (counts) {
        ended = new Promise((done) => response.once("close", done));
        given = 0;
      }
      const parts: Buffer[] = [];
      for await (const part of answer) {
        parts.push(part as Buffer);
      }
      const file = Buffer.concat(parts);
      whole = counts ? file.length : whole;
      for (let at = 0; at < file.length && !response.destroyed; at += kPart) {
        const part = file.subarray(at, at + kPart);
        await turn(part.length);
        response.write(part);
        given += counts ? part.length : 0;
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
