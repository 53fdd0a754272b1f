import { readFileSync } from "node:fs";

import { framingDistance, kFieldOfView } from "../src/model/view";

const kAlphaMin = 1 / 255;
const kBlurVariance = 0.1; // px²

/**
 * Fragments a pixel that Gaussians (as `clipgs export` writes them) of a case whose sphere has `radius` (their unit) cost
 * an uncut picture of size × size px that frames it: areas of the ellipses within which they are drawn, by the picture's.
 * All Gaussians are as far away as the sphere's middle and seen along each of their axes for a third.
 */
export function fragmentsPerPixel(ply: string, radius: number, size: number): number {
  const file = readFileSync(ply);
  const end = "end_header\n";
  const body = file.indexOf(end) + end.length;
  const header = file.subarray(0, body).toString("latin1").split("\n");
  const names = header.filter((line) => line.startsWith("property")).map((line) => line.split(" ")[2]!);
  const values = new Float32Array(file.buffer.slice(file.byteOffset + body, file.byteOffset + file.length));
  const [opacity, ...scales] = ["opacity", "scale_0", "scale_1", "scale_2"].map((name) =>
    names.indexOf(name),
  );
  const pxPerUnit = (0.5 * size) / Math.tan(0.5 * kFieldOfView) / framingDistance(radius);
  let area = 0;
  for (let at = 0; at < values.length; at += names.length) {
    const alpha = 1 / (1 + Math.exp(-values[at + opacity!]!));
    const reach2 = Math.max(0, 2 * Math.log(alpha / kAlphaMin));
    const [x, y, z] = scales.map((i) =>
      Math.hypot(Math.exp(values[at + i]!) * pxPerUnit, Math.sqrt(kBlurVariance)),
    );
    area += (Math.PI * reach2 * (x! * y! + y! * z! + z! * x!)) / 3;
  }
  return area / size ** 2;
}
