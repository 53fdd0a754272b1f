import type { LightRig } from "../sog/section";
import type { CutLightTexels, OpeningsInfo, SectionReply, SectionRequest } from "./protocol";

/** The main thread's end of section_worker.ts, once it has decoded: what cuts open, and the light in there. */
export class LightClient {
  /** What the outline and openings are drawn from; null: splats show them. */
  readonly openings: Promise<OpeningsInfo | null>;
  readonly #worker: Worker;
  #lit: ((light: CutLightTexels | null) => void) | null = null;

  constructor(worker: Worker) {
    this.#worker = worker;
    this.openings = new Promise((resolve) => {
      worker.onmessage = ({ data }: MessageEvent<SectionReply>) => {
        if (data.kind === "openings") {
          resolve(data.openings);
        } else if (data.kind === "lit") {
          this.#answer(data.light);
        }
      };
      worker.onerror = () => {
        resolve(null);
        this.#answer(null);
      };
    });
  }

  /** What is solved from now on is under other lights. */
  setRig(rig: LightRig): void {
    this.#worker.postMessage({ kind: "rig", rig } satisfies SectionRequest);
  }

  /** Of one cut at a time; null where the worker has stopped. */
  solve(planes: Float32Array, quick: boolean): Promise<CutLightTexels | null> {
    return new Promise((resolve) => {
      this.#lit = resolve;
      this.#worker.postMessage({ kind: "light", planes, quick } satisfies SectionRequest, [planes.buffer]);
    });
  }

  dispose(): void {
    this.#worker.terminate();
    this.#worker.onmessage = this.#worker.onerror = null; // browsers keep ended workers, and with these what came of them
    this.#answer(null);
  }

  #answer(light: CutLightTexels | null): void {
    this.#lit?.(light);
    this.#lit = null;
  }
}
