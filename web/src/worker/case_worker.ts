// Fetches and decodes cases, and culls and sorts their splats, off the main thread.

import libwebpUrl from "@cwasm/webp/webp.wasm?url";
import splatOrderUrl from "@wasm/splat_order.wasm?url";
import dav1dUrl from "ogv/dist/ogv-decoder-video-av1-wasm.wasm?url";

import { requireTexelChecksum } from "../sog/checksum";
import { hullOf } from "../sog/hull";
import { parseSection, type SectionInfo } from "../sog/section";
import {
  type PackedScene,
  packScene,
  parseSogMeta,
  type SogImages,
  type SogMeta,
  type Texels,
} from "../sog/sog";
import { WebpDecoder } from "../sog/webp";
import { type Archive, CaseError } from "../sog/zip";
import { arrive } from "./arriving";
import { FileCache, type Progress } from "./file_cache";
import { kindOf, readWholeFile } from "./own_file";
import { type CaseSource, kSuperseded, type LoadedCase, type Reply, type Request } from "./protocol";
import { SplatOrder } from "./splat_order";

// What a worker's global object has of DedicatedWorkerGlobalScope, whose types clash with the page's.
const worker = self as unknown as {
  postMessage(message: Reply, transfer: Transferable[]): void;
  onmessage: (event: MessageEvent<Request>) => void;
};

const files = new FileCache();
let modules: Promise<[WebAssembly.Module, WebAssembly.Module]> | null = null;
let dav1d: Promise<WebAssembly.Module> | null = null;
fetchModules().catch(() => {}); // while the first case is on its way, which says what failed
// What was loaded last, and what is shown until that is.
let scenes: { ticket: number; order: SplatOrder }[] = [];
let sorted = -1; // the ticket of what is shown
let newest = { ticket: -1, superseded: new AbortController() }; // load

function reply(message: Reply, transfer: Transferable[] = []): void {
  worker.postMessage(message, transfer);
}

function fail(ticket: number, error: unknown): void {
  const message = error instanceof CaseError ? error.message : `the case cannot be shown: ${String(error)}`;
  reply({ kind: "failed", ticket, message });
}

/** Once, or again where that failed. */
function fetchModules(): Promise<[WebAssembly.Module, WebAssembly.Module]> {
  if (!modules) {
    modules = Promise.all([compile(splatOrderUrl), compile(libwebpUrl)]);
    modules.catch(() => (modules = null));
  }
  return modules;
}

/** What decodes sections that are videos: fetched once there is one, and again where that failed. */
function fetchDav1d(): Promise<WebAssembly.Module> {
  if (!dav1d) {
    dav1d = compile(dav1dUrl);
    dav1d.catch(() => (dav1d = null));
  }
  return dav1d;
}

async function compile(url: string): Promise<WebAssembly.Module> {
  try {
    return await WebAssembly.compileStreaming(fetch(url));
  } catch (error) {
    throw new CaseError(`a part of the viewer cannot be fetched (${String(error)}); try again`);
  }
}

function decodeImages(decoder: WebpDecoder, meta: SogMeta, archive: Archive): SogImages {
  const decode = (name: string): Texels =>
    decoder.decode(archive.get(name)!, name, ({ width, height, rgba }) => {
      requireTexelChecksum(meta.clipgs, rgba, name);
      return { width, height, rgba: rgba.slice() };
    });
  const palette = (meta: { files: string[] } | null) =>
    meta && { centroids: decode(meta.files[0]!), labels: decode(meta.files[1]!) };
  return {
    meansLow: decode(meta.means.files[0]!),
    meansHigh: decode(meta.means.files[1]!),
    scales: decode(meta.scales.files[0]!),
    quats: decode(meta.quats.files[0]!),
    sh0: decode(meta.sh0.files[0]!),
    shN: palette(meta.shN),
    faces: palette(meta.faces),
    layers: meta.layers && decode(meta.layers.file),
  };
}

/** The section of a case, or what is wrong with it: its splats can be shown all the same. */
function sectionOf(clipgs: unknown, archive: Archive): { info: SectionInfo | null; problem: string | null } {
  try {
    return { info: parseSection(clipgs, archive), problem: null };
  } catch (error) {
    return { info: null, problem: (error as CaseError).message };
  }
}

/** Of the scene in the patient; what is not as it should be is refused where the block is checked. */
function rowsOf(clipgs: unknown): number[][] {
  const { world } = (clipgs ?? {}) as { world?: { scene_to_ras_mm?: unknown } };
  const rows = world?.scene_to_ras_mm;
  const isMatrix = Array.isArray(rows) && rows.length === 4 && rows.every(Array.isArray);
  return isMatrix ? (rows as number[][]) : [0, 1, 2].map((i) => [0, 1, 2].map((k) => (i === k ? 1 : 0)));
}

/** Throws CaseError once another case was asked for. */
function checkNewest(ticket: number): void {
  if (ticket !== newest.ticket) {
    throw new CaseError(kSuperseded);
  }
}

async function load({ ticket, source, early }: Extract<Request, { kind: "load" }>): Promise<void> {
  newest.superseded.abort();
  newest = { ticket, superseded: new AbortController() };
  const { signal } = newest.superseded;
  try {
    const kind = typeof source === "string" ? "case" : await kindOf(source);
    if (typeof source !== "string" && kind !== "case") {
      await loadSplats(ticket, source, kind);
    } else {
      await loadCase(ticket, source, early, signal);
    }
  } catch (error) {
    fail(ticket, error);
  }
}

/** A file of other programs: splats alone. */
async function loadSplats(ticket: number, file: File, kind: "ply" | "spz"): Promise<void> {
  const { readSplatFile } = await import("../splats/splat_file");
  const [{ scene, clipgs }, [splatOrder]] = await Promise.all([readSplatFile(file, kind), fetchModules()]);
  checkNewest(ticket);
  giveScene(ticket, scene, splatOrder, { clipgs, hasWorld: false, hasSection: false, sectionProblem: null });
  reply({ kind: "rest", ticket, section: null, sectionProblem: null });
}

async function loadCase(
  ticket: number,
  source: CaseSource,
  early: boolean,
  signal: AbortSignal,
): Promise<void> {
  const arriving = arrive(
    (progress) => {
      const tell: Progress = (loaded, total, bytes) => {
        reply({ kind: "progress", ticket, loaded, total });
        progress(loaded, total, bytes);
      };
      return typeof source === "string" ? files.get(source, tell, signal) : readWholeFile(source, tell);
    },
    early,
    (cover) => reply({ kind: "cover", ticket, ...cover }, [cover.thumbnail.buffer]),
  );
  const [archive, [splatOrder, libwebp]] = await Promise.all([arriving.splats, fetchModules()]);
  const meta = parseSogMeta(archive);
  const { info, problem } = sectionOf(meta.clipgs, archive);
  checkNewest(ticket);
  const sectionDecoder = info?.mosaic === null ? fetchDav1d() : Promise.resolve(libwebp);
  sectionDecoder.catch(() => {}); // told when it is needed
  const scene = packScene(meta, decodeImages(new WebpDecoder(libwebp), meta, archive));
  const isOther = meta.clipgs === undefined && typeof source !== "string"; // a SOG of another program
  const clipgs = isOther
    ? (await import("../splats/splat_file")).describeSplats(scene, source.name)
    : meta.clipgs;
  giveScene(ticket, scene, splatOrder, {
    clipgs,
    hasWorld: !isOther,
    hasSection: info !== null,
    sectionProblem: problem,
  });
  await giveRest(ticket, meta.clipgs, await arriving.whole, sectionDecoder);
}

/** Sorts a scene from now on, and gives it away. */
function giveScene(
  ticket: number,
  scene: PackedScene,
  splatOrder: WebAssembly.Module,
  said: Omit<LoadedCase, "ticket" | "scene" | "hull">,
): void {
  const order = new SplatOrder(splatOrder); // an instance for each, whose memory goes with it
  order.load(scene);
  scenes = [...scenes.filter((scene) => scene.ticket === sorted), { ticket, order }];
  const transfer = [scene.packed.buffer, scene.sh0.buffer];
  if (scene.shN) {
    transfer.push(scene.shN.centroids.rgba.buffer);
  }
  if (scene.faces) {
    transfer.push(scene.faces.labels.buffer, scene.faces.palette.rgba.buffer);
  }
  if (scene.layers) {
    transfer.push(scene.layers.buffer);
  }
  const hull = hullOf(scene, rowsOf(said.clipgs));
  reply({ kind: "loaded", ticket, scene, hull, ...said }, transfer);
}

/** What is not shown at first. */
async function giveRest(
  ticket: number,
  clipgs: unknown,
  archive: Archive,
  decoding: Promise<WebAssembly.Module>,
): Promise<void> {
  const { info, problem } = sectionOf(clipgs, archive);
  const coded = info && archive.get(info.file)!.slice();
  try {
    const section = info && coded && { info, coded, decoder: await decoding };
    reply({ kind: "rest", ticket, section, sectionProblem: problem }, coded ? [coded.buffer] : []);
  } catch (error) {
    reply({ kind: "rest", ticket, section: null, sectionProblem: (error as CaseError).message });
  }
}

function sort(request: Extract<Request, { kind: "sort" }>): void {
  const start = performance.now();
  const { scene, order } = request;
  if (scene > sorted) {
    sorted = scene;
    scenes = scenes.filter(({ ticket }) => ticket >= sorted); // the memory of the case before is given back
  }
  const known = scenes.find(({ ticket }) => ticket === scene);
  const count = known ? known.order.sort(request.view, request.clip, order) : -1;
  reply({ kind: "sorted", scene, order, count, milliseconds: performance.now() - start }, [order.buffer]);
}

worker.onmessage = (event) => {
  const request = event.data;
  if (request.kind === "load") {
    void load(request);
  } else if (request.kind === "prefetch") {
    void files.prefetch(request.url);
  } else {
    sort(request);
  }
};
