import { Vector3 } from "three";

import type { Triple } from "../model/geometry";
import { shades, type Window } from "../model/grey";
import { indexFromPicture, type SliceFrame } from "../model/slice";
import { kCodes, type Section } from "../sog/section";

/** Where a row of pixels is in the volume: in voxels, and how far from pixel to pixel. */
interface Row {
  from: Vector3;
  step: Vector3;
}

/** Rounding, voxels: what lies on the volume's side is within it. */
const kRounding = 1e-3;

/**
 * Draws a slice of a section, from voxel to voxel linear as what is read of it (readSection), through a window of grey
 * values, or photographs in their colours. What is outside the volume stays as it is. `pixels` is RGBA, row by row.
 */
export function drawSlice(
  section: Section,
  window: Window | null,
  frame: SliceFrame,
  pixels: Uint8ClampedArray,
): void {
  const matrix = indexFromPicture(section, frame);
  const step = new Vector3().setFromMatrixColumn(matrix, 0);
  const draw = section.channels === 3 ? colorRow(section, pixels) : greyRow(section, window, pixels);
  for (let y = 0; y < frame.height; ++y) {
    const from = new Vector3(0.5, y + 0.5, 0).applyMatrix4(matrix);
    const [first, last] = inside({ from, step }, section.dims, frame.width);
    from.addScaledVector(step, first);
    draw({ from, step }, y * frame.width + first, last - first);
  }
}

/** The pixels of a row that lie within the volume: from, to. */
function inside({ from, step }: Row, dims: readonly number[], width: number): [number, number] {
  let [first, last] = [0, width];
  for (let k = 0; k < 3; ++k) {
    const [at, by] = [from.getComponent(k), step.getComponent(k)];
    const [low, high] = [-kRounding, dims[k]! - 1 + kRounding];
    if (Math.abs(by) < 1e-9) {
      if (at < low || at > high) {
        return [0, 0];
      }
    } else {
      const [one, other] = [(low - at) / by, (high - at) / by];
      first = Math.max(first, Math.ceil(Math.min(one, other)));
      last = Math.min(last, Math.floor(Math.max(one, other)) + 1);
    }
  }
  return first < last ? [first, last] : [0, 0];
}

type DrawRow = (row: Row, at: number, count: number) => void;

/** Along each axis: the last voxel that has one after it, and how far that is in memory. */
function strides({ dims: [nx, ny, nz], channels }: Section): { lasts: Triple; next: Triple } {
  const apart: Triple = [channels, channels * nx, channels * nx * ny];
  const dims: Triple = [nx, ny, nz];
  return {
    lasts: dims.map((n) => Math.max(0, n - 2)) as Triple,
    next: dims.map((n, k) => (n > 1 ? apart[k]! : 0)) as Triple,
  };
}

// Plain loops over numbers, and nothing made in them: a picture has some hundred thousand pixels.

function greyRow(section: Section, window: Window | null, pixels: Uint8ClampedArray): DrawRow {
  const { voxels, curve } = section;
  const [nx, ny] = section.dims;
  const [lx, ly, lz] = strides(section).lasts;
  const [dx, dy, dz] = strides(section).next;
  const all = { center: 0.5 * (curve[0]! + curve[kCodes - 1]!), width: curve[kCodes - 1]! - curve[0]! };
  const shade = Float32Array.from(shades(window ?? all, curve), (share) => 255 * share);
  const words = new Uint32Array(pixels.buffer, pixels.byteOffset, pixels.length >> 2);
  return ({ from, step }, at, count) => {
    let { x, y, z } = from;
    const { x: sx, y: sy, z: sz } = step;
    for (let end = at + count; at < end; ++at, x += sx, y += sy, z += sz) {
      let ix = x | 0;
      let iy = y | 0;
      let iz = z | 0;
      if (ix > lx) ix = lx;
      if (iy > ly) iy = ly;
      if (iz > lz) iz = lz;
      const fx = x - ix;
      const fy = y - iy;
      const i = ix + nx * (iy + ny * iz);
      const a = shade[voxels[i]!]!;
      const b = shade[voxels[i + dy]!]!;
      const c = shade[voxels[i + dz]!]!;
      const d = shade[voxels[i + dy + dz]!]!;
      const ax = a + fx * (shade[voxels[i + dx]!]! - a);
      const bx = b + fx * (shade[voxels[i + dx + dy]!]! - b);
      const cx = c + fx * (shade[voxels[i + dx + dz]!]! - c);
      const ex = d + fx * (shade[voxels[i + dx + dy + dz]!]! - d);
      const near = ax + fy * (bx - ax);
      const value = near + (z - iz) * (cx + fy * (ex - cx) - near) + 0.5;
      const grey = value <= 0 ? 0 : value >= 255 ? 255 : value | 0;
      words[at] = 0xff000000 | (grey * 0x010101);
    }
  };
}

function colorRow(section: Section, pixels: Uint8ClampedArray): DrawRow {
  const { voxels } = section;
  const [nx, ny] = section.dims;
  const [lx, ly, lz] = strides(section).lasts;
  const [dx, dy, dz] = strides(section).next;
  return ({ from, step }, at, count) => {
    let { x, y, z } = from;
    const { x: sx, y: sy, z: sz } = step;
    for (let to = 4 * at, end = 4 * (at + count); to < end; to += 4, x += sx, y += sy, z += sz) {
      let ix = x | 0;
      let iy = y | 0;
      let iz = z | 0;
      if (ix > lx) ix = lx;
      if (iy > ly) iy = ly;
      if (iz > lz) iz = lz;
      const fx = x - ix;
      const gx = 1 - fx;
      const b = (y - iy) * (1 - z + iz);
      const c = (1 - y + iy) * (z - iz);
      const d = (y - iy) * (z - iz);
      const a = 1 - b - c - d;
      let i = 3 * (ix + nx * (iy + ny * iz));
      for (let channel = 0; channel < 3; ++channel, ++i) {
        pixels[to + channel] =
          a * (gx * voxels[i]! + fx * voxels[i + dx]!) +
          b * (gx * voxels[i + dy]! + fx * voxels[i + dx + dy]!) +
          c * (gx * voxels[i + dz]! + fx * voxels[i + dx + dz]!) +
          d * (gx * voxels[i + dy + dz]! + fx * voxels[i + dx + dy + dz]!);
      }
      pixels[to + 3] = 255;
    }
  };
}
