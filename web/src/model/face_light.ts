import { Vector3 } from "three";

import type { LightRig } from "../sog/section";

// The light on an exposed face: the twin of src/section/face_light.cpp. All kept matter lies behind the plane,
// so every point of the face sees the whole hemisphere, and its light follows in closed form.

/** Mean of max(0, n·ω) over a disc of angular radius asin(s) about a direction at cosine c: exact for a flat disc. */
function discCosine(c: number, s: number): number {
  if (c >= s) {
    return c;
  }
  if (c <= -s) {
    return 0;
  }
  const u = c / s;
  const root = Math.sqrt(Math.max(0, 1 - u * u));
  return s * (u * (0.5 + (Math.asin(u) + u * root) / Math.PI) + (2 / (3 * Math.PI)) * root ** 3);
}

/** (1/π)·∫ max(0, a·ω)·max(0, b·ω) dω over the sphere, for cos of the angle between a and b. */
function overlap(cosine: number): number {
  const c = Math.min(1, Math.max(-1, cosine));
  const angle = Math.acos(c);
  return (2 / (3 * Math.PI)) * (Math.sin(angle) + (Math.PI - angle) * c);
}

/** What a white Lambert face with unit `normal` (RAS, away from the kept side) radiates, linear RGB. */
export function faceDiffuse(rig: LightRig, normal: Vector3): Vector3 {
  const horizon = new Vector3(...rig.skyHorizon);
  const sum = horizon.clone();
  sum.addScaledVector(new Vector3(...rig.skyTop).sub(horizon), overlap(normal.z));
  sum.addScaledVector(new Vector3(...rig.skyBottom).sub(horizon), overlap(-normal.z));
  for (const key of rig.keys) {
    const cosine = normal.dot(new Vector3(...key.direction));
    sum.addScaledVector(new Vector3(...key.radiance), discCosine(cosine, Math.sin(key.angularRadius)));
  }
  return sum;
}
