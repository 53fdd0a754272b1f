import { Vector3 } from "three";

import type { JsonReader } from "../sog/json_reader";

/** How bright a cut face is by its plane's normal: the twin of FaceGain of src/splat/face_gain.h. */
export type FaceGain = readonly Vector3[]; // 16 coefficients of RGB; empty: none

const kCoefficients = 16;
const kLargest = 10; // one that could overflow a renderer is refused

/** Reads `face_gain` of a case. Throws CaseError. */
export function readFaceGain(reader: JsonReader): FaceGain {
  if (!reader.has("face_gain")) {
    return [];
  }
  const list = reader.value("face_gain");
  const fits = (row: unknown) =>
    Array.isArray(row) && row.length === 3 && row.every((v) => Math.abs(v as number) <= kLargest);
  if (!Array.isArray(list) || list.length !== kCoefficients || !list.every(fits)) {
    reader.fail("face_gain");
  }
  return (list as [number, number, number][]).map((row) => new Vector3(...row));
}

/** The real spherical harmonics of 3DGS up to degree 3 (shaders/spherical_harmonics.glsl). */
function shBasis({ x, y, z }: Vector3): number[] {
  const [xx, yy, zz] = [x * x, y * y, z * z];
  return [
    0.28209479177387814,
    -0.4886025119029199 * y,
    0.4886025119029199 * z,
    -0.4886025119029199 * x,
    1.0925484305920792 * x * y,
    -1.0925484305920792 * y * z,
    0.31539156525252005 * (2 * zz - xx - yy),
    -1.0925484305920792 * x * z,
    0.5462742152960396 * (xx - yy),
    -0.5900435899266435 * y * (3 * xx - yy),
    2.890611442640554 * x * y * z,
    -0.4570457994644658 * y * (4 * zz - xx - yy),
    0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
    -0.4570457994644658 * x * (4 * zz - xx - yy),
    1.445305721320277 * z * (xx - yy),
    -0.5900435899266435 * x * (xx - 3 * yy),
  ];
}

/** What multiplies the colour of splats at the face of a plane with this unit normal (RAS), RGB. */
export function gainAt(gain: FaceGain, normal: Vector3): Vector3 {
  const exponent = new Vector3();
  const basis = shBasis(normal);
  gain.forEach((coefficient, k) => exponent.addScaledVector(coefficient, basis[k]!));
  return new Vector3(Math.exp(exponent.x), Math.exp(exponent.y), Math.exp(exponent.z));
}
