import { BufferGeometry, Float32BufferAttribute, LineBasicMaterial, LineSegments } from "three";

import { kBehindSplats } from "../render/draw_order";

/** Of the lines, m. */
const kApart = 0.5;
const kReach = 3.5;
const kColor = 0x8fb3c9;
const kOpacity = 0.8;

/**
 * The floor of a room that is not seen: lines that fade away, for those who stand on it to know how they stand. It is lines
 * alone, as what fills much of the picture costs time.
 */
export class RoomFloor {
  readonly object: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor() {
    const count = Math.round(kReach / kApart);
    const positions: number[] = [];
    const colors: number[] = [];
    const put = (x: number, z: number) => {
      const fade = Math.max(0, 1 - Math.hypot(x, z) / kReach);
      positions.push(x, 0, z);
      colors.push(1, 1, 1, kOpacity * fade * fade);
    };
    for (let i = -count; i <= count; ++i) {
      for (let k = -count; k < count; ++k) {
        const [across, from, to] = [kApart * i, kApart * k, kApart * (k + 1)];
        put(across, from);
        put(across, to);
        put(from, across);
        put(to, across);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
    geometry.setAttribute("color", new Float32BufferAttribute(colors, 4));
    this.object = new LineSegments(
      geometry,
      new LineBasicMaterial({ color: kColor, vertexColors: true, transparent: true, depthWrite: false }),
    );
    this.object.renderOrder = kBehindSplats;
    this.object.pointerEvents = "none";
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
