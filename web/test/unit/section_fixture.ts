import { countCodes, kCodes, parseSection, type Section, type SectionInfo } from "../../src/sog/section";
import { makeRandom } from "./sog_fixture";

const ramp = (from: number, to: number) =>
  Array.from({ length: kCodes }, (_, i) => from + ((to - from) * i) / (kCodes - 1));

/** The `section` block of a small case: 5 × 18 × 7 voxels, slices three in a row. */
export function makeSectionBlock(): Record<string, unknown> {
  return {
    version: 1,
    file: "section.webp",
    dims: [5, 18, 7],
    tile: [16, 32],
    columns: 3,
    channels: 1,
    spacing: [2, 1, 1.5],
    origin: [-4, 10, 20],
    axis_x: [0, 1, 0],
    axis_y: [-1, 0, 0],
    axis_z: [0, 0, 1],
    source_spacing: [1, 0.5, 1.5],
    modality: "CT",
    curve: ramp(-1000, 1550),
    value_errors: Array(16).fill(4),
    materials: {
      extinction: ramp(0, 3),
      specular: ramp(0, 0.2),
      roughness: ramp(0.3, 0.6),
      surface_r: ramp(0.1, 0.9),
      surface_g: ramp(0.1, 0.8),
      surface_b: ramp(0.1, 0.7),
      interior_r: ramp(0.2, 1.9),
      interior_g: ramp(0.2, 1.8),
      interior_b: ramp(0.2, 1.7),
    },
    boundary: { from: 20, to: 80, r: ramp(0.3, 0.5), g: ramp(0.3, 0.4), b: ramp(0.3, 0.3) },
    lights: {
      sky_top: [0.4, 0.5, 0.6],
      sky_horizon: [0.2, 0.2, 0.2],
      sky_bottom: [0.3, 0.25, 0.2],
      keys: [
        { direction: [-0.55, 0.63, 0.55], radiance: [0.75, 0.7, 0.65], angular_radius: 0.14 },
        { direction: [0.8, 0.48, 0.36], radiance: [0.2, 0.2, 0.2], angular_radius: 0.31 },
        { direction: [0, -1, 0], radiance: [0.3, 0.3, 0.3], angular_radius: 0 },
      ].map((key) => {
        const length = Math.hypot(...key.direction);
        return { ...key, direction: key.direction.map((v) => v / length) };
      }),
      exposure: 1.2,
    },
  };
}

/** `object` with the value at `path` replaced (undefined: left out). */
export function withValue<T extends object>(object: T, path: string, value: unknown): T {
  const copy = structuredClone(object);
  const keys = path.split(".");
  const last = keys.pop()!;
  const parent = keys.reduce<Record<string, unknown>>(
    (o, key) => o[key] as Record<string, unknown>,
    copy as Record<string, unknown>,
  );
  if (value === undefined) {
    delete parent[last];
  } else {
    parent[last] = value;
  }
  return copy;
}

export function withVoxels(info: SectionInfo, voxels: Uint8Array): Section {
  return { ...info, voxels, counts: countCodes(voxels) };
}

/** The fixture with random voxels. */
export function makeSection(changes: object = {}): Section {
  const block = { ...makeSectionBlock(), ...changes };
  const info = parseSection({ section: block }, new Map([["section.webp", null]]))!;
  const random = makeRandom(5);
  const [nx, ny, nz] = info.dims;
  return withVoxels(
    info,
    Uint8Array.from({ length: nx * ny * nz * info.channels }, () => Math.floor(256 * random())),
  );
}
