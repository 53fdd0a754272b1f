// Decodes the section of one case, then finds and lights what cuts open of it: off the main thread and beside the worker
// that sorts its splats.

import cutLightUrl from "@wasm/cut_light.wasm?url";

import { decodeAv1 } from "../sog/av1";
import { readMosaicVoxels, type Section, sectionOf } from "../sog/section";
import { CaseError } from "../sog/zip";
import { WebpDecoder } from "../sog/webp";
import { CutLight } from "./cut_light";
import type { CodedSection, OpeningsInfo, SectionReply, SectionRequest } from "./protocol";

// What a worker's global object has of DedicatedWorkerGlobalScope, whose types clash with the page's.
const worker = self as unknown as {
  postMessage(message: SectionReply, transfer: Transferable[]): void;
  onmessage: (event: MessageEvent<SectionRequest>) => void;
};

const module = WebAssembly.compileStreaming(fetch(cutLightUrl)).catch(() => null);
let light: CutLight | null = null;

async function decode(coded: CodedSection): Promise<void> {
  const { info } = coded;
  let section: Section;
  try {
    section = sectionOf(info, await decodeVoxels(coded));
  } catch (error) {
    const message =
      error instanceof CaseError ? error.message : `${info.file} cannot be decoded: ${String(error)}`;
    worker.postMessage({ kind: "failed", message }, []);
    return;
  }
  const { dims } = section;
  light = await takeOver(section); // before the voxels are given away
  worker.postMessage({ kind: "section", section }, [section.voxels.buffer]);
  const openings = prepare(dims);
  const parts = [openings?.blocks, openings?.light?.ownLight.texels];
  worker.postMessage(
    { kind: "openings", openings },
    parts.flatMap((part) => part?.buffer ?? []),
  );
}

async function decodeVoxels({ info, coded, decoder }: CodedSection): Promise<Uint8Array> {
  const { mosaic, dims, file } = info;
  return mosaic
    ? new WebpDecoder(decoder).decode(coded, file, (texels) => readMosaicVoxels(info, mosaic, texels))
    : decodeAv1(decoder, coded, dims, file);
}

/** Without the module, or memory for it, splats show what cuts open. */
async function takeOver(section: Section): Promise<CutLight | null> {
  const compiled = await module;
  try {
    return compiled && new CutLight(compiled, section);
  } catch {
    return null;
  }
}

function prepare(dims: Section["dims"]): OpeningsInfo | null {
  try {
    return light?.prepare({ dims }) ?? null;
  } catch {
    return null;
  }
}

worker.onmessage = ({ data }) => {
  if (data.kind === "decode") {
    void decode(data.coded);
  } else if (data.kind === "rig") {
    light?.setRig(data.rig);
  } else if (light) {
    const lit = light.solve(data.planes, data.quick);
    worker.postMessage({ kind: "lit", light: lit }, [lit.texels.buffer]);
  }
};
