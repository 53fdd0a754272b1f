import type { PointerEvent } from "@pmndrs/pointer-events";
import {
  BoxGeometry,
  CanvasTexture,
  Mesh,
  MeshBasicMaterial,
  type Quaternion,
  SRGBColorSpace,
  Vector3,
} from "three";

import { handOf } from "../hand";

/** Of an edge, m. */
const kSize = 0.036;
/** Of a side's picture, px. */
const kPicture = 96;
const kPlain = "#ffffff";
const kPointedAt = "#7fd8f2";
/** In RAS, in the order of a box's sides in the viewer's world: x, −x, y, −y, z, −z. */
const kSides: [string, Vector3][] = [
  ["left", new Vector3(-1, 0, 0)],
  ["right", new Vector3(1, 0, 0)],
  ["superior", new Vector3(0, 0, 1)],
  ["inferior", new Vector3(0, 0, -1)],
  ["anterior", new Vector3(0, 1, 0)],
  ["posterior", new Vector3(0, -1, 0)],
];

function letterPicture(letter: string): CanvasTexture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = kPicture;
  const context = canvas.getContext("2d")!;
  context.fillStyle = "#98a0ac";
  context.fillRect(0, 0, kPicture, kPicture);
  context.fillStyle = "#2a2f38";
  context.fillRect(3, 3, kPicture - 6, kPicture - 6);
  context.fillStyle = "#ffffff";
  context.font = `600 ${0.6 * kPicture}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(letter, 0.5 * kPicture, 0.54 * kPicture);
  const picture = new CanvasTexture(canvas);
  picture.colorSpace = SRGBColorSpace;
  return picture;
}

/** The side of the box that an event is at. */
function sideAt({ localPoint }: PointerEvent): number {
  const sizes = localPoint.toArray().map(Math.abs);
  const axis = sizes.indexOf(Math.max(...sizes));
  return 2 * axis + (localPoint.getComponent(axis) < 0 ? 1 : 0);
}

/** A cube lettered R L A P S I that is turned as the patient is in the room; `look` is told the side that is pressed. */
export class OrientationCube {
  readonly object: Mesh<BoxGeometry, MeshBasicMaterial[]>;

  constructor(look: (side: Vector3) => void, pointerEventsOrder: number) {
    const materials = kSides.map(
      ([name]) => new MeshBasicMaterial({ map: letterPicture(name[0]!.toUpperCase()) }),
    );
    this.object = new Mesh(new BoxGeometry(kSize, kSize, kSize), materials);
    this.object.pointerEventsOrder = pointerEventsOrder;
    this.object.addEventListener("pointermove", (event) => this.#light(sideAt(event)));
    this.object.addEventListener("pointerout", () => this.#light(null));
    this.object.addEventListener("click", (event) => {
      handOf(event)?.pulse(0.3, 10);
      look(kSides[sideAt(event)]![1]);
    });
  }

  /** Before a frame: where it stands, and how the viewer's world is turned in the room. */
  place(position: Vector3, quaternion: Quaternion): void {
    this.object.position.copy(position);
    this.object.quaternion.copy(quaternion);
  }

  /** Where the middle of a side is, by its name, in the room; null: there is no such side. */
  find(side: string): Vector3 | null {
    const index = kSides.findIndex(([name]) => name === side);
    if (index < 0) {
      return null;
    }
    const middle = new Vector3().setComponent(index >> 1, (index % 2 === 0 ? 0.5 : -0.5) * kSize);
    return this.object.localToWorld(middle);
  }

  dispose(): void {
    this.object.geometry.dispose();
    for (const material of this.object.material) {
      material.map?.dispose();
      material.dispose();
    }
  }

  #light(side: number | null): void {
    this.object.material.forEach((material, i) => material.color.set(i === side ? kPointedAt : kPlain));
  }
}
