// Many clients at once of a server as a hospital runs it: with named tokens, an access log and an audit. Prints Markdown,
// and ends with 1 if a request failed.
//
//   npx vite-node bench/service.ts -- CASE.sog [COUNT] [CLIENTS] [SECONDS]
//
// COUNT (1,000) copies of CASE, each with a title of its own, are served; each of CLIENTS (64) has a token and a connection
// of its own, and for SECONDS (60) asks, without a pause, for the list, a screen of twelve thumbnails, a case and its marks.

import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { Agent, request } from "node:http";
import { cpus } from "node:os";
import { join } from "node:path";

import { makeManyCases } from "../test/browser/many_cases";
import { kProgram } from "../test/browser/program";
import { Server } from "../test/browser/server";
import { table } from "./measure";

const [file = "", count = "1000", clients = "64", seconds = "60"] = process.argv.slice(2);
const kThumbnails = 12;
const kinds = ["index", "thumbnail", "case", "marks"] as const;
type Kind = (typeof kinds)[number];

const took: Record<Kind, number[]> = { index: [], thumbnail: [], case: [], marks: [] };
const failures: string[] = [];
let bytes = 0;

/** How long it took until all was there, ms; with the body of what is to be read. */
function ask(
  url: string,
  token: string,
  agent: Agent,
  wanted: number,
): Promise<{ ms: number; body: Buffer }> {
  const begin = performance.now();
  return new Promise((done, fail) => {
    const sent = request(url, { agent, headers: { Authorization: `Bearer ${token}` } }, (response) => {
      const parts: Buffer[] = [];
      response.on("data", (part: Buffer) => parts.push(part));
      response.on("error", fail);
      response.on("end", () => {
        const body = Buffer.concat(parts);
        if (response.statusCode !== wanted) {
          fail(new Error(`${response.statusCode} of ${url}: ${body.toString().slice(0, 200)}`));
        }
        done({ ms: performance.now() - begin, body });
      });
    });
    sent.on("error", fail);
    sent.end();
  });
}

interface Listed {
  name: string;
  bytes: number;
  file: string;
  thumbnail: string;
}

/** One client, until its time is over. */
async function use(url: string, token: string, first: number, end: number): Promise<void> {
  const agent = new Agent({ keepAlive: true, maxSockets: 1 });
  const get = async (kind: Kind, path: string, wanted = 200) => {
    const { ms, body } = await ask(url + path, token, agent, wanted);
    took[kind].push(ms);
    bytes += body.length;
    return body;
  };
  for (let i = first; performance.now() < end; i += 7) {
    try {
      const { cases } = JSON.parse((await get("index", "api/cases")).toString()) as { cases: Listed[] };
      if (cases.length !== Number(count)) {
        throw new Error(`${cases.length} cases are listed`);
      }
      for (let k = 0; k < kThumbnails; ++k) {
        await get("thumbnail", cases[(i + k) % cases.length]!.thumbnail);
      }
      const one = cases[i % cases.length]!;
      const body = await get("case", one.file);
      if (body.length !== one.bytes) {
        throw new Error(`${body.length} of ${one.bytes} bytes of ${one.name}`);
      }
      await get("marks", one.file.replace(/sog$/, "marks.json"), 204);
    } catch (error) {
      failures.push(String(error));
    }
  }
  agent.destroy();
}

/** The program's memory at its highest, MB, and its time of the CPUs so far, s. */
function costs(pid: number): { memory: number; cpu: number } {
  const memory = Number(/VmHWM:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))![1]) / 1000;
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1]!.split(" ");
  return { memory, cpu: (Number(fields[11]) + Number(fields[12])) / 100 };
}

function quantile(values: readonly number[], share: number): string {
  const sorted = [...values].sort((a, b) => a - b);
  return `${(sorted[Math.floor(share * (sorted.length - 1))] ?? 0).toFixed(0)} ms`;
}

const server = new Server();
const at = (name: string) => join(server.folder, name);
const tokens = Array.from({ length: Number(clients) }, (_, i) =>
  execFileSync(kProgram, ["token", at("tokens.json"), "--add", `client-${i}`, "--folder", "."], {
    encoding: "utf8",
    stdio: ["ignore", "pipe", "ignore"],
  }).trim(),
);
try {
  await server.start(
    (cases) => makeManyCases(file, Number(count), cases),
    ...["--tokens", at("tokens.json"), "--audit", at("audit"), "--access-log", at("access")],
  );
  const begin = performance.now();
  const end = begin + 1000 * Number(seconds);
  await Promise.all(tokens.map((token, i) => use(server.url, token, 13 * i, end)));
  const passed = (performance.now() - begin) / 1000;
  const { memory, cpu } = costs(server.pid);
  const lines = (name: string) => readFileSync(at(name), "utf8").trimEnd().split("\n").length;
  const total = kinds.reduce((sum, kind) => sum + took[kind].length, 0);
  console.log(
    table(
      [`${clients} clients, ${count} cases of ${(statSync(file).size / 1e6).toFixed(1)} MB`, ""],
      [
        ["failed", `${failures.length} of ${total} requests in ${passed.toFixed(0)} s`],
        ["a second", `${(total / passed).toFixed(0)} requests, ${(bytes / 1e6 / passed).toFixed(0)} MB`],
        ["the server's memory, at its highest", `${memory.toFixed(0)} MB; wanted: 200 MB`],
        ["its CPU time", `${(cpu / passed).toFixed(2)} of ${cpus().length} cores`],
        ["lines of the audit, of the access log", `${lines("audit")}, ${lines("access")}`],
        ...kinds.map((kind) => [
          `${kind}: half, 99 %`,
          `${quantile(took[kind], 0.5)}, ${quantile(took[kind], 0.99)}`,
        ]),
      ],
    ),
  );
} finally {
  for (const failure of failures.slice(0, 10)) {
    console.error(failure);
  }
  await server.stop();
}
process.exitCode = failures.length > 0 ? 1 : 0;
