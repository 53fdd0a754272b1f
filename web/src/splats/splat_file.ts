import type { PackedScene } from "../sog/sog";
import { readBytes } from "../worker/own_file";
import { packCloud } from "./pack_cloud";
import { readPly } from "./ply";
import { readSpz } from "./spz";

/** Scene space → RAS mm: the axes of 3DGS, upright and facing the viewer, in metres (src/splat/similarity.h). */
const kSceneToPatient = [
  [-1000, 0, 0, 0],
  [0, 0, -1000, 0],
  [0, -1000, 0, 0],
  [0, 0, 0, 1],
];
/** Of splats along an axis, what lies farther out at either end is no part of what is looked at. */
const kOutliers = 0.01;
const kFaint = 26; // of opacity 255
const kLeastRadius = 1e-3; // mm

/** The scene of a file of other programs, and what a case would say of it (docs/format.md). Rejects with CaseError. */
export async function readSplatFile(
  file: File,
  kind: "ply" | "spz",
): Promise<{ scene: PackedScene; clipgs: object }> {
  const cloud = kind === "ply" ? readPly(new Uint8Array(await readBytes(file))) : await readSpz(file);
  const scene = packCloud(cloud);
  return { scene, clipgs: describeSplats(scene, file.name) };
}

/** What a case would say of splats that nothing is said of: where almost all of them are. */
export function describeSplats(scene: PackedScene, title: string): object {
  const [x, y, z] = [0, 1, 2].map((axis) => coordinates(scene, axis)) as [Range, Range, Range];
  // Scene x, y and z are −R, −S and −A.
  const [r, a, s] = [x, z, y].map(([least, most]) => [-1000 * most, -1000 * least]) as [Range, Range, Range];
  const min = [r[0], a[0], s[0]];
  const max = [r[1], a[1], s[1]];
  const radius = Math.max(kLeastRadius, 0.5 * Math.hypot(...max.map((v, i) => v - min[i]!)));
  return {
    version: 1,
    title,
    preset: "",
    world: { scene_to_ras_mm: kSceneToPatient },
    sphere: { center: min.map((v, i) => 0.5 * (v + max[i]!)), radius },
    bounds: { min, max },
    axis: [0, 0, 1],
    extent: s[1] > s[0] ? s : [s[0], s[0] + kLeastRadius],
  };
}

type Range = [least: number, most: number];

/** Of splats that are not faint, without outliers. */
function coordinates({ count, packed, meanMin, meanMax }: PackedScene, axis: number): Range {
  const codes = new Uint16Array(packed.buffer);
  const beyond = (least: number): number[] => {
    const values: number[] = [];
    for (let i = 0; i < count; ++i) {
      if (packed[4 * i + 3]! >>> 24 >= least) {
        const v = meanMin[axis]! + (codes[8 * i + axis]! / 65535) * (meanMax[axis]! - meanMin[axis]!);
        values.push(Math.sign(v) * Math.expm1(Math.abs(v)));
      }
    }
    return values;
  };
  const seen = beyond(kFaint);
  const sorted = Float64Array.from(seen.length > 0 ? seen : beyond(0)).sort();
  const last = sorted.length - 1;
  return [sorted[Math.floor(kOutliers * last)]!, sorted[Math.ceil((1 - kOutliers) * last)]!];
}
