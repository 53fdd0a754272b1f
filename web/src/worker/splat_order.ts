import type { PackedScene } from "../sog/sog";
import { CaseError } from "../sog/zip";
import { kViewFloats } from "./protocol";

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  reserve(count: number): number;
  packed_scene(): number;
  scene_layers(): number;
  decoding_floats(): number;
  view_floats(): number;
  draw_order(): number;
  unpack(): void;
  cull_and_sort(clip: number): number;
}

/** wasm/splat_order.cpp: which splats to draw and in what order. */
export class SplatOrder {
  readonly #wasm: Exports;

  constructor(module: WebAssembly.Module) {
    this.#wasm = new WebAssembly.Instance(module, {}).exports as unknown as Exports;
    this.#wasm._initialize();
  }

  /** Takes a scene, forgetting the one before. Throws CaseError when memory is out. */
  load(scene: PackedScene): void {
    const wasm = this.#wasm;
    if (!wasm.reserve(scene.count)) {
      throw new CaseError(`there is not enough memory for ${scene.count} splats; close other tabs`);
    }
    new Uint32Array(wasm.memory.buffer, wasm.packed_scene(), scene.packed.length).set(scene.packed);
    const decoding = new Float32Array(wasm.memory.buffer, wasm.decoding_floats(), 6 + 256);
    decoding.set(scene.meanMin, 0);
    decoding.set(scene.meanMax, 3);
    decoding.set(scene.scaleCodebook, 6);
    if (scene.layers) {
      new Int32Array(wasm.memory.buffer, wasm.scene_layers(), scene.count).set(scene.layers);
    }
    wasm.unpack();
  }

  /** Writes the splats that `view` may show, far to near, to `order`; returns how many. */
  sort(view: Float32Array, clip: number, order: Uint32Array): number {
    const wasm = this.#wasm;
    new Float32Array(wasm.memory.buffer, wasm.view_floats(), kViewFloats).set(view);
    const count = wasm.cull_and_sort(clip);
    order.set(new Uint32Array(wasm.memory.buffer, wasm.draw_order(), count));
    return count;
  }
}
