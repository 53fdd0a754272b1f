import type { LightRig, Section } from "../sog/section";
import type { CutLightTexels, OpeningsInfo, WallLight } from "./protocol";

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  section_description(): number;
  cut_planes(): number;
  reserve(bytes: number): number;
  prepare(): number;
  blocks(): number;
  grid(): number;
  own_light(): number;
  scale(): number;
  relight(): void;
  solve(count: number, quick: number): number;
}

/** Voxels along a side of a block: EmptySpace::kBlock of src/light/empty_space.h. */
const kBlock = 2;
/** What is drawn of a section, by the bits of wasm/cut_light.cpp's prepare(). */
const kOpened = 1;
const kOutlined = 2;
/** For walls and for splats, of six sides. */
const kSides = 2 * 6;

/** Lights as wasm/cut_light.cpp wants them described. */
function describeRig({ skyTop, skyHorizon, skyBottom, keys }: LightRig): number[] {
  const lamps = keys.flatMap((key) => [...key.direction, ...key.radiance, key.angularRadius]);
  return [...skyTop, ...skyHorizon, ...skyBottom, keys.length, ...lamps];
}

/** A section without its voxels, as wasm/cut_light.cpp wants it described. */
function describe(section: Section): Float32Array {
  const { dims, channels, origin, axes, spacing, sourceSpacing, curve, materials, boundary, rig } = section;
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
      ...(boundary?.reflectance.map((table) => table[code]!) ?? [0, 0, 0]),
    ]),
    boundary?.from ?? 0,
    boundary?.to ?? 0,
    ...describeRig(rig),
  ]);
}

/** wasm/cut_light.cpp: what a cut opens of one section, and the light in there. */
export class CutLight {
  readonly #wasm: Exports;
  readonly #rigAt: number; // among the floats of the description
  #bytes = 0; // of texels

  /** Takes the section's voxels over as a copy. Throws where memory is out. */
  constructor(module: WebAssembly.Module, section: Section) {
    const instance = new WebAssembly.Instance(module);
    this.#wasm = instance.exports as unknown as Exports;
    this.#wasm._initialize();
    const voxels = this.#wasm.reserve(section.voxels.length);
    new Uint8Array(this.#wasm.memory.buffer, voxels, section.voxels.length).set(section.voxels);
    const description = describe(section);
    this.#rigAt = description.length - describeRig(section.rig).length;
    this.#describe(0, description);
  }

  /** Finds walls and horizons, a second or so. */
  prepare({ dims }: Pick<Section, "dims">): OpeningsInfo {
    const wasm = this.#wasm;
    const drawn = wasm.prepare();
    const blockDims = dims.map((n) => Math.ceil(n / kBlock)) as OpeningsInfo["blockDims"];
    const count = blockDims[0] * blockDims[1] * blockDims[2];
    return {
      blocks: new Uint8Array(wasm.memory.buffer, wasm.blocks(), count).slice(),
      blockDims,
      outlined: (drawn & kOutlined) !== 0,
      light: (drawn & kOpened) !== 0 ? this.#wallLight() : null,
    };
  }

  #wallLight(): WallLight {
    const wasm = this.#wasm;
    const [x, y, z, cellSize] = new Float32Array(wasm.memory.buffer, wasm.grid(), 4);
    this.#bytes = 4 * kSides * x! * y! * z!;
    return { cells: [x!, y!, z!], cellSize: cellSize!, ownLight: this.#read(wasm.own_light()) };
  }

  /** From now on other lights. */
  setRig(rig: LightRig): void {
    this.#describe(this.#rigAt, Float32Array.from(describeRig(rig)));
    this.#wasm.relight();
  }

  /** The light under a cut; `quick`: nearly, where that was asked before of a cut nearby. */
  solve(planes: Float32Array, quick: boolean): CutLightTexels {
    const wasm = this.#wasm;
    new Float32Array(wasm.memory.buffer, wasm.cut_planes(), planes.length).set(planes);
    return this.#read(wasm.solve(planes.length / 4, quick ? 1 : 0));
  }

  #read(at: number): CutLightTexels {
    const texels = new Uint8Array(this.#wasm.memory.buffer, at, this.#bytes).slice();
    return { texels, scale: this.#wasm.scale() };
  }

  /** Writes floats of the description from one on. */
  #describe(first: number, values: Float32Array): void {
    const { memory, section_description } = this.#wasm;
    new Float32Array(memory.buffer, section_description() + 4 * first, values.length).set(values);
  }
}
