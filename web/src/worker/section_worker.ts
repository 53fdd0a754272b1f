// Decodes the section of one case, off the main thread and beside the worker that sorts its splats.

import { readVoxels } from "../sog/section";
import { CaseError } from "../sog/zip";
import { WebpDecoder } from "../sog/webp";
import type { CodedSection, SectionReply } from "./protocol";

// What a worker's global object has of DedicatedWorkerGlobalScope, whose types clash with the page's.
const worker = self as unknown as {
  postMessage(message: SectionReply, transfer: Transferable[]): void;
  onmessage: (event: MessageEvent<CodedSection>) => void;
};

worker.onmessage = ({ data: { info, webp, libwebp } }) => {
  try {
    const section = new WebpDecoder(libwebp).decode(webp, info.file, (texels) => readVoxels(info, texels));
    worker.postMessage({ section }, [section.voxels.buffer]);
  } catch (error) {
    const message =
      error instanceof CaseError ? error.message : `${info.file} cannot be decoded: ${String(error)}`;
    worker.postMessage({ message }, []);
  }
};
