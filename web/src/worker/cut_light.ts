import type { Section } from "../sog/section";
import type { OpeningsInfo } from "./protocol";

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  section_description(): number;
  cut_planes(): number;
  reserve(bytes: number): number;
  prepare(): number;
  blocks(): number;
  grid(): number;
  solve(count: number, quick: number): number;
}

/** Voxels along a side of a block: EmptySpace::kBlock of src/light/empty_space.h. */
const kBlock = 2;
const kSides = 6;

/** The C++ library asks for these where it reports what ends it; there is nobody to read that. */
const kNoFiles = { fd_close: () => 8, fd_seek: () => 8, fd_write: () => 8 };

/** A section without its voxels, as wasm/cut_light.cpp wants it described. */
function describe(section: Section): Float32Array {
  const { dims, channels, origin, axes, spacing, sourceSpacing, curve, materials, rig } = section;
  const keys = rig.keys.flatMap((key) => [...key.direction, ...key.radiance, key.angularRadius]);
  return Float32Array.from([
    ...dims,
    channels,
    ...origin,
    ...axes.flat(),
    ...spacing,
    ...sourceSpacing,
    ...curve,
    ...curve.flatMap((_, code) => [
      materials.extinction[code]!,
      materials.specular[code]!,
      materials.roughness[code]!,
      ...materials.surface.map((table) => table[code]!),
      ...materials.interior.map((table) => table[code]!),
    ]),
    ...rig.skyTop,
    ...rig.skyHorizon,
    ...rig.skyBottom,
    rig.keys.length,
    ...keys,
  ]);
}

/** wasm/cut_light.cpp: what a cut opens of one section, and the light in there. */
export class CutLight {
  readonly #wasm: Exports;
  #texels = 0;

  /** Takes the section's voxels over as a copy. Throws where memory is out. */
  constructor(module: WebAssembly.Module, section: Section) {
    const instance = new WebAssembly.Instance(module, { wasi_snapshot_preview1: kNoFiles });
    this.#wasm = instance.exports as unknown as Exports;
    this.#wasm._initialize();
    const voxels = this.#wasm.reserve(section.voxels.length);
    new Uint8Array(this.#wasm.memory.buffer, voxels, section.voxels.length).set(section.voxels);
    const description = describe(section);
    new Float32Array(this.#wasm.memory.buffer, this.#wasm.section_description(), description.length).set(
      description,
    );
  }

  /** Finds walls and horizons, a second or so; null where openings are left to the splats. */
  prepare({ dims }: Pick<Section, "dims">): OpeningsInfo | null {
    const wasm = this.#wasm;
    if (!wasm.prepare()) {
      return null;
    }
    const blockDims = dims.map((n) => Math.ceil(n / kBlock)) as OpeningsInfo["blockDims"];
    const count = blockDims[0] * blockDims[1] * blockDims[2];
    const [x, y, z, cellSize] = new Float32Array(wasm.memory.buffer, wasm.grid(), 4);
    this.#texels = 4 * kSides * x! * y! * z!;
    return {
      blocks: new Uint8Array(wasm.memory.buffer, wasm.blocks(), count).slice(),
      blockDims,
      cells: [x!, y!, z!],
      cellSize: cellSize!,
    };
  }

  /** Half floats of the light under a cut; `quick`: nearly, where that was asked before of a cut nearby. */
  solve(planes: Float32Array, quick: boolean): Uint16Array {
    const wasm = this.#wasm;
    new Float32Array(wasm.memory.buffer, wasm.cut_planes(), planes.length).set(planes);
    const texels = wasm.solve(planes.length / 4, quick ? 1 : 0);
    return new Uint16Array(wasm.memory.buffer, texels, this.#texels).slice();
  }
}
