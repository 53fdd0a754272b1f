import type { FontFamilies } from "@pmndrs/uikit";
import {
  CylinderGeometry,
  Group,
  type Matrix4,
  Mesh,
  MeshBasicMaterial,
  SphereGeometry,
  Vector3,
} from "three";

import { type Length, lengthsOf, lengthText, type Pin } from "../../model/pins";
import { type Reading, valueText } from "../../model/values";
import type { Viewer } from "../../viewer";
import { kOverCase, Tag } from "./tag";

/** Of what they are seen at: as large from near as from afar. */
const kDot = 0.006;
const kLine = 0.0025;
const kFaded = 0.3;

/** Pins with their values, lengths between them, and the value where a hand points, in the room. */
export class RoomMarks {
  readonly object = new Group();
  readonly #viewer: Viewer;
  readonly #families: () => FontFamilies;
  readonly #dot = new SphereGeometry(kDot, 12, 8);
  readonly #line = new CylinderGeometry(kLine, kLine, 1, 8).rotateX(Math.PI / 2);
  readonly #seen = new MeshBasicMaterial({ color: 0xffffff, depthTest: false });
  readonly #faded = new MeshBasicMaterial({
    color: 0xffffff,
    depthTest: false,
    transparent: true,
    opacity: kFaded,
  });
  readonly #pointed = new MeshBasicMaterial({ color: 0xff8f7f, depthTest: false });
  readonly #placed = new Group(); // pins and lengths
  readonly #cursor: Tag;
  readonly #point = new Vector3(); // scratch
  readonly #end = new Vector3();
  #pins: readonly Pin[] = [];
  #lengths: readonly Length[] = [];
  #dots: Mesh[] = [];
  #lines: Mesh[] = [];
  #tags: Tag[] = []; // of pins, then of lengths

  constructor(viewer: Viewer, families: () => FontFamilies) {
    this.#viewer = viewer;
    this.#families = families;
    this.#cursor = new Tag(families(), "above");
    this.object.add(this.#placed, this.#cursor.object);
  }

  /** Before a frame: `reading` or `pointed` is pointed at, `eye` is where it is seen from, in the room. */
  update(
    reading: Reading | null,
    pointed: Pin | null,
    roomFromPatient: Matrix4,
    eye: Vector3,
    patientEye: Vector3,
    delta: number,
  ): void {
    const { pins, layers } = this.#viewer.state;
    this.#placed.visible = layers.marks;
    if (pins !== this.#pins) {
      this.#pins = pins;
      this.#build();
    }
    const inRoom = (point: Vector3, to: Vector3) => to.copy(point).applyMatrix4(roomFromPatient);
    pins.forEach((pin, i) => {
      const dot = this.#dots[i]!;
      inRoom(pin.point, dot.position);
      dot.scale.setScalar(dot.position.distanceTo(eye));
      const seen = this.#viewer.picking.isSeen(pin.point, patientEye);
      dot.material = pin === pointed ? this.#pointed : seen ? this.#seen : this.#faded;
      this.#tags[i]!.object.visible = seen;
      this.#tags[i]!.place(dot.position, eye, delta);
    });
    this.#lengths.forEach(({ from, to }, i) => {
      inRoom(from, this.#point);
      inRoom(to, this.#end);
      const line = this.#lines[i]!;
      line.position.lerpVectors(this.#point, this.#end, 0.5);
      const away = line.position.distanceTo(eye);
      line.scale.set(away, away, Math.max(1e-6, this.#point.distanceTo(this.#end)));
      line.lookAt(this.#end);
      this.#tags[pins.length + i]!.place(line.position, eye, delta);
    });
    this.#cursor.object.visible = reading !== null;
    if (reading) {
      this.#cursor.text.value = valueText(reading);
      this.#cursor.place(inRoom(reading.point, this.#point), eye, delta);
    }
  }

  /** Where this text stands, in the room; null: it is not shown. */
  find(text: string): Vector3 | null {
    const tags = [this.#cursor, ...(this.#placed.visible ? this.#tags : [])];
    const tag = tags.find((one) => one.object.visible && one.text.value === text);
    return tag?.object.position.clone() ?? null;
  }

  dispose(): void {
    this.#clear();
    this.#cursor.dispose();
    [this.#dot, this.#line, this.#seen, this.#faded, this.#pointed].forEach((one) => one.dispose());
  }

  #build(): void {
    this.#clear();
    this.#lengths = lengthsOf(this.#pins);
    this.#dots = this.#pins.map(() => new Mesh(this.#dot, this.#seen));
    this.#lines = this.#lengths.map(() => new Mesh(this.#line, this.#seen));
    const texts = [...this.#pins.map(valueText), ...this.#lengths.map(lengthText)];
    this.#tags = texts.map((text, i) => {
      const tag = new Tag(this.#families(), i < this.#pins.length ? "above" : "below");
      tag.text.value = text;
      return tag;
    });
    for (const mesh of [...this.#dots, ...this.#lines]) {
      mesh.renderOrder = kOverCase;
    }
    for (const object of [...this.#dots, ...this.#lines, ...this.#tags.map((tag) => tag.object)]) {
      this.#placed.add(object);
    }
  }

  #clear(): void {
    this.#placed.remove(...this.#dots, ...this.#lines);
    this.#tags.forEach((tag) => tag.dispose());
  }
}
