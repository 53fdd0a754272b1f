import { Vector3 } from "three";

import type { LightRig } from "../sog/section";
import type { Triple } from "./geometry";

// The light rigs of presets/rigs that can light a case: a sky and lamps that are infinitely far away.

interface Radiance {
  color: string;
  intensity: number;
}

interface RigFile {
  title: string;
  sky: Record<"top" | "horizon" | "bottom", Radiance>;
  keys: (Radiance & { direction: Triple; angular_radius_deg: number; distance?: number })[];
}

export interface NamedRig {
  title: string;
  rig: LightRig;
}

const kFiles = import.meta.glob<RigFile>("../../../presets/rigs/*.json", { import: "default", eager: true });

function linearFromSrgb(srgb: number): number {
  return srgb <= 0.04045 ? srgb / 12.92 : ((srgb + 0.055) / 1.055) ** 2.4;
}

/** Linear RGB of `#rrggbb` times the intensity. */
function radiance({ color, intensity }: Radiance): Triple {
  const part = (at: number): number =>
    intensity * linearFromSrgb(parseInt(color.slice(at, at + 2), 16) / 255);
  return [part(1), part(3), part(5)];
}

function rigOf({ sky, keys }: RigFile): LightRig {
  return {
    skyTop: radiance(sky.top),
    skyHorizon: radiance(sky.horizon),
    skyBottom: radiance(sky.bottom),
    keys: keys.map((key) => ({
      direction: new Vector3(...key.direction).normalize().toArray(),
      radiance: radiance(key),
      angularRadius: (key.angular_radius_deg * Math.PI) / 180,
    })),
  };
}

/** By their names: those of the files. */
export const kRigs: ReadonlyMap<string, NamedRig> = new Map(
  Object.entries(kFiles)
    .filter(([, file]) => file.keys.every((key) => !key.distance))
    .map(([path, file]) => [/([^/]+)\.json$/.exec(path)![1]!, { title: file.title, rig: rigOf(file) }]),
);
