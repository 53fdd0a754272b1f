import { kMaxPlanes } from "../model/cut";
import type { LightRig, Section, SectionInfo } from "../sog/section";
import type { Hull } from "../sog/hull";
import type { PackedScene } from "../sog/sog";
import type { Cover } from "./arriving";

/** Where a case is: an address, or a file of the person's own. */
export type CaseSource = string | File;

/** Why there is nothing of a case, to whoever waited for it. */
export const kSuperseded = "another case was chosen meanwhile";

/** A section's image or video, and what decodes it: libwebp or dav1d. */
export interface CodedSection {
  info: SectionInfo;
  coded: Uint8Array;
  decoder: WebAssembly.Module;
}

/** Light in what cuts open: of 255 `scale`, linear, in sRGB, and A of what is lit [walls and splats, side, z, y, x, RGBA]. */
export interface CutLightTexels {
  texels: Uint8Array;
  scale: number;
}

/** How the light of walls lies in space. */
export interface WallLight {
  /** Cells of the light along each axis of the section, and their side, mm. */
  cells: [number, number, number];
  cellSize: number;
  /** The light uncut, under the lights that the case was made in. */
  ownLight: CutLightTexels;
}

/** Where matter may be: what outlines and openings are drawn from beside the section's voxels. */
export interface OpeningsInfo {
  /** Of 2³ voxels each, as EmptySpace of src/light/empty_space.h has them. */
  blocks: Uint8Array;
  blockDims: [number, number, number];
  /** Whether what is kept is given its outline. */
  outlined: boolean;
  /** Null: splats show what is opened. */
  light: WallLight | null;
}

/** To the section's worker: first the section, then other lights, and cuts (x, y, z, offset of each plane, RAS mm). */
export type SectionRequest =
  | { kind: "decode"; coded: CodedSection }
  | { kind: "rig"; rig: LightRig }
  | { kind: "light"; planes: Float32Array; quick: boolean };

/**
 * From it: the section, or why there is none; what its outline and openings are drawn from (null: splats show
 * them); the light under the cut that was asked for.
 */
export type SectionReply =
  | { kind: "section"; section: Section }
  | { kind: "failed"; message: string }
  | { kind: "openings"; openings: OpeningsInfo | null }
  | { kind: "lit"; light: CutLightTexels };

/**
 * A case, decoded, but for its section: that takes longer, and has a worker of its own. Its file need not be whole yet.
 */
export interface LoadedCase {
  ticket: number;
  scene: PackedScene;
  hull: Hull;
  /** Whether its section is still to come. */
  hasSection: boolean;
  /** What is wrong with the section that it has, if something is: splats show the case without it. */
  sectionProblem: string | null;
  /** The `clipgs` block of meta.json, unchecked. */
  clipgs: unknown;
  /** Whether that says how it lies in the patient: files of other programs do not, and one unit is taken as a metre. */
  hasWorld: boolean;
}

/** The clip operators, numbered as in shaders/gaussian.glsl and wasm/splat_order.cpp. By layers, what they cannot draw is cut exactly. */
export const kClipOperators = { none: 0, hard: 1, soft: 2, exact: 3, layers: 4 } as const;
export type ClipOperator = Exclude<keyof typeof kClipOperators, "none">;

/** What culling and sorting look at, in scene space: the floats of `View` in wasm/splat_order.cpp. */
export const kViewFloats = 9 + 3 + 2 + 2 + 1 + 1 + 1 + 1 + 2 + 4 * kMaxPlanes;

/** To the worker. */
export type Request =
  /** `early`: it is answered as soon as its splats are there. */
  | { kind: "load"; ticket: number; source: CaseSource; early: boolean }
  /** Fetches what may be loaded next; nothing answers. */
  | { kind: "prefetch"; url: string }
  /** `scene` is the ticket of the load that made it; `order` a buffer to reuse for the answer. */
  | { kind: "sort"; scene: number; view: Float32Array; clip: number; order: Uint32Array };

/**
 * From the worker. A ticket is that of the request that is answered; `count` is −1 if the scene is gone. A case that is
 * loaded is whole with what is the rest of it, which may say that its section is missing.
 */
export type Reply =
  | ({ kind: "cover"; ticket: number } & Cover)
  | { kind: "progress"; ticket: number; loaded: number; total: number }
  | ({ kind: "loaded" } & LoadedCase)
  | { kind: "rest"; ticket: number; section: CodedSection | null; sectionProblem: string | null }
  | { kind: "failed"; ticket: number; message: string }
  | { kind: "sorted"; scene: number; order: Uint32Array; count: number; milliseconds: number };
