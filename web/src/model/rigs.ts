import { MathUtils, Vector3 } from "three";

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

/** Which lights a case is seen in. */
export interface Lighting {
  rig: string | null; // one of kRigs; null: the lights that the case was made in
  turn: number; // degrees that they are turned about the patient's long axis, counterclockwise seen from the head
  lamp: Triple | null; // a lamp instead of the rig's: where it shines from, unit RAS
}

/** Of the sky beside a lamp: as much as shows what it does not shine on. */
const kSkyBesideLamp = 0.35;
const kLampColor: Triple = [1, 0.97, 0.92];
const kLeastLamp = 1.5;
const kLampRadius = MathUtils.degToRad(3);

function scaled([x, y, z]: Triple, factor: number): Triple {
  return [factor * x, factor * y, factor * z];
}

/** Lights as they are chosen, of a case that was made in `own`. */
export function lightsOf({ rig, turn, lamp }: Lighting, own: LightRig): LightRig {
  const base = (rig && kRigs.get(rig)?.rig) || own;
  if (lamp) {
    // As bright as the lamps whose place it takes.
    const strength = base.keys.reduce((sum, { radiance }) => sum + Math.max(...radiance), 0);
    const radiance = scaled(kLampColor, Math.max(kLeastLamp, strength));
    return {
      skyTop: scaled(base.skyTop, kSkyBesideLamp),
      skyHorizon: scaled(base.skyHorizon, kSkyBesideLamp),
      skyBottom: scaled(base.skyBottom, kSkyBesideLamp),
      keys: [{ direction: lamp, radiance, angularRadius: kLampRadius }],
    };
  }
  const axis = new Vector3(0, 0, 1);
  const angle = MathUtils.degToRad(turn);
  return {
    ...base,
    keys: base.keys.map((key) => ({
      ...key,
      direction: new Vector3(...key.direction).applyAxisAngle(axis, angle).toArray(),
    })),
  };
}

/** Whether a case is seen in the lights that it was made in. */
export function isOwn({ rig, turn, lamp }: Lighting): boolean {
  return !rig && !turn && !lamp;
}
