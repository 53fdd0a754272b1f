import type { PerspectiveCamera } from "three";

/** A part of a picture, and what is drawn for it: more than it, since pixels look at their neighbours. px */
export interface Tile {
  x: number;
  y: number;
  width: number;
  height: number;
  /** Of what is drawn, around that. */
  drawn: { x: number; y: number; width: number; height: number };
}

/** So large a picture is drawn at once; blocks that splats tint by begin alike in all tiles. */
const kSide = 2048;
const kMargin = 64;

/** Parts that a picture is drawn in, where it is large. */
export function tilesOf(width: number, height: number, side = kSide, margin = kMargin): Tile[] {
  const along = (size: number) =>
    Array.from({ length: Math.ceil(size / side) }, (_, i) => {
      const from = i * side;
      const length = Math.min(side, size - from);
      const first = Math.max(0, from - margin);
      return { from, length, first, drawn: Math.min(size, from + length + margin) - first };
    });
  return along(height).flatMap((row) =>
    along(width).map((column) => ({
      x: column.from,
      y: row.from,
      width: column.length,
      height: row.length,
      drawn: { x: column.first, y: row.first, width: column.drawn, height: row.drawn },
    })),
  );
}

/** A camera that sees of what `camera` sees, in a picture of width × height px, what is drawn for a tile. */
export function tileCamera(
  camera: PerspectiveCamera,
  width: number,
  height: number,
  { drawn }: Tile,
): PerspectiveCamera {
  const part = camera.clone();
  part.setViewOffset(width, height, drawn.x, drawn.y, drawn.width, drawn.height);
  part.updateMatrixWorld();
  return part;
}
