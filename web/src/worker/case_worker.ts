// Fetches and decodes cases, and culls and sorts their splats, off the main thread.

import wasmUrl from "@wasm/splat_order.wasm?url";

import { decodeBitmap, ImageDecoder } from "../sog/images";
import { parseSection, type SectionInfo } from "../sog/section";
import { packScene, parseSogMeta, type SogImages, type SogMeta } from "../sog/sog";
import { CaseError, readZip } from "../sog/zip";
import { FileCache } from "./file_cache";
import type { Reply, Request } from "./protocol";
import { SplatOrder } from "./splat_order";

// What a worker's global object has of DedicatedWorkerGlobalScope, whose types clash with the page's.
const worker = self as unknown as {
  postMessage(message: Reply, transfer: Transferable[]): void;
  onmessage: (event: MessageEvent<Request>) => void;
};

const files = new FileCache();
let module: Promise<WebAssembly.Module> | null = null;
let current: {
  ticket: number;
  order: SplatOrder;
  section: { info: SectionInfo; bitmap: Promise<ImageBitmap> } | null; // until it is asked for
} | null = null;
let newestLoad = -1;
const kSuperseded = "another case was chosen meanwhile";

function reply(message: Reply, transfer: Transferable[] = []): void {
  worker.postMessage(message, transfer);
}

function fail(ticket: number, error: unknown): void {
  const message = error instanceof CaseError ? error.message : `the case cannot be shown: ${String(error)}`;
  reply({ kind: "failed", ticket, message });
}

async function compile(): Promise<WebAssembly.Module> {
  module ??= WebAssembly.compileStreaming(fetch(wasmUrl));
  return module;
}

/** With a decoder that is freed afterwards. */
async function decoding<T>(use: (decoder: ImageDecoder) => Promise<T>): Promise<T> {
  const decoder = new ImageDecoder();
  try {
    return await use(decoder);
  } finally {
    decoder.dispose();
  }
}

async function decodeImages(
  decoder: ImageDecoder,
  meta: SogMeta,
  archive: Map<string, Uint8Array>,
): Promise<SogImages> {
  const decode = (name: string) => decoder.decode(archive.get(name)!, name);
  const palette = async (meta: { files: string[] } | null) => {
    const [centroids, labels] = await Promise.all(meta ? meta.files.map(decode) : []);
    return centroids && labels ? { centroids, labels } : null;
  };
  const [meansLow, meansHigh, scales, quats, sh0, shN, faces, layers] = await Promise.all([
    decode(meta.means.files[0]!),
    decode(meta.means.files[1]!),
    decode(meta.scales.files[0]!),
    decode(meta.quats.files[0]!),
    decode(meta.sh0.files[0]!),
    palette(meta.shN),
    palette(meta.faces),
    meta.layers ? decode(meta.layers.file) : null,
  ]);
  return { meansLow, meansHigh, scales, quats, sh0, shN, faces, layers };
}

/** Throws CaseError once another case was asked for. */
function checkNewest(ticket: number): void {
  if (ticket !== newestLoad) {
    throw new CaseError(kSuperseded);
  }
}

async function load(ticket: number, url: string): Promise<void> {
  newestLoad = ticket;
  try {
    const [bytes, wasm] = await Promise.all([
      files.get(url, (loaded, total) => reply({ kind: "progress", ticket, loaded, total })),
      compile(),
    ]);
    const archive = await readZip(bytes);
    const meta = parseSogMeta(archive);
    const info = parseSection(meta.clipgs, archive);
    const scene = packScene(meta, await decoding((decoder) => decodeImages(decoder, meta, archive)));
    checkNewest(ticket);
    const order = new SplatOrder(wasm); // a new instance: the memory of the case before is given back
    order.load(scene);
    current?.section?.bitmap.then(
      (bitmap) => bitmap.close(), // nobody asked for it
      () => {},
    );
    current = {
      ticket,
      order,
      section: info && { info, bitmap: decodeBitmap(archive.get(info.file)!, info.file) },
    };
    current.section?.bitmap.catch(() => {}); // said when it is asked for
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
    const { clipgs } = meta;
    reply(
      { kind: "loaded", ticket, scene, hasSection: info !== null, clipgs, bytes: bytes.length },
      transfer,
    );
  } catch (error) {
    fail(ticket, error);
  }
}

async function sendSection(ticket: number): Promise<void> {
  const start = performance.now();
  try {
    if (current?.ticket !== ticket) {
      throw new CaseError(kSuperseded);
    }
    const { info, bitmap } = current.section!;
    current.section = null;
    const image = await bitmap;
    const section = { ...info, voxels: await decoding((decoder) => decoder.readSection(image, info)) };
    checkNewest(ticket);
    const milliseconds = performance.now() - start;
    reply({ kind: "section", ticket, section, milliseconds }, [section.voxels.buffer]);
  } catch (error) {
    fail(ticket, error);
  }
}

function sort(request: Extract<Request, { kind: "sort" }>): void {
  const start = performance.now();
  const { scene, order } = request;
  const count = current?.ticket === scene ? current.order.sort(request.view, request.clip, order) : -1;
  reply({ kind: "sorted", scene, order, count, milliseconds: performance.now() - start }, [order.buffer]);
}

worker.onmessage = (event) => {
  const request = event.data;
  if (request.kind === "load") {
    void load(request.ticket, request.url);
  } else if (request.kind === "section") {
    void sendSection(request.ticket);
  } else if (request.kind === "prefetch") {
    void files.prefetch(request.url);
  } else {
    sort(request);
  }
};
