import type { FontFamilies } from "@pmndrs/uikit";
import {
  CylinderGeometry,
  Group,
  InstancedMesh,
  type Matrix4,
  Mesh,
  MeshBasicMaterial,
  Object3D,
  SphereGeometry,
  Vector3,
} from "three";

import { anchorOf, linesOf, type Mark, markText, measure } from "../../model/marks";
import { type Reading, valueText } from "../../model/values";
import { shownMarks } from "../../model/viewer_state";
import type { Section } from "../../sog/section";
import type { Viewer } from "../../viewer";
import { kOverCase } from "../../render/draw_order";
import { Tag } from "./tag";

/** Of what they are seen at: as large from near as from afar. */
const kDot = 0.006;
const kLine = 0.0025;
const kFaded = 0.3;

/** A mark as it stands in the room. */
interface Standing {
  mark: Mark;
  dots: readonly Mesh[];
  lines: InstancedMesh; // a cylinder from point to point
  ends: readonly (readonly [Vector3, Vector3])[]; // of these, RAS mm
  tag: Tag;
}

/** Marks with what they measure, and the value where a hand points, in the room. */
export class RoomMarks {
  readonly object = new Group();
  readonly #viewer: Viewer;
  readonly #families: (text: string) => FontFamilies;
  readonly #dot = new SphereGeometry(kDot, 12, 8);
  readonly #line = new CylinderGeometry(kLine, kLine, 1, 8).rotateX(Math.PI / 2);
  readonly #seen = new MeshBasicMaterial({ color: 0xffffff, depthTest: false });
  readonly #faded = new MeshBasicMaterial({
    color: 0xffffff,
    depthTest: false,
    transparent: true,
    opacity: kFaded,
  });
  readonly #placed = new Group(); // all but the cursor
  readonly #cursor: Tag;
  readonly #point = new Vector3(); // scratch
  readonly #end = new Vector3();
  readonly #segment = new Object3D();
  #marks: readonly Mark[] = [];
  #section: WeakRef<Section> | null = null; // whose values the tags say; one that is gone is not held
  #standing: readonly Standing[] = [];

  /** `families` are those that a text is drawn with. */
  constructor(viewer: Viewer, families: (text: string) => FontFamilies) {
    this.#viewer = viewer;
    this.#families = families;
    this.#cursor = new Tag(families(""), "above");
    this.object.add(this.#placed, this.#cursor.object);
  }

  /** Before a frame: `reading` is pointed at, `eye` is where it is seen from, in the room. */
  update(
    reading: Reading | null,
    roomFromPatient: Matrix4,
    eye: Vector3,
    patientEye: Vector3,
    delta: number,
  ): void {
    const { state, section } = this.#viewer;
    this.#placed.visible = state.layers.marks;
    const marks = shownMarks(state);
    if (marks !== this.#marks || section !== (this.#section?.deref() ?? null)) {
      this.#marks = marks;
      this.#section = section && new WeakRef(section);
      this.#build();
    }
    const inRoom = (point: Vector3, to: Vector3) => to.copy(point).applyMatrix4(roomFromPatient);
    for (const { mark, dots, lines, ends, tag } of this.#standing) {
      const seen = mark.points.some((point) => this.#viewer.picking.isSeen(point, patientEye));
      const material = seen ? this.#seen : this.#faded;
      mark.points.forEach((point, i) => {
        const dot = dots[i]!;
        inRoom(point, dot.position);
        dot.scale.setScalar(dot.position.distanceTo(eye));
        dot.material = material;
      });
      ends.forEach(([from, to], i) => {
        inRoom(from, this.#point);
        inRoom(to, this.#end);
        const segment = this.#segment;
        segment.position.lerpVectors(this.#point, this.#end, 0.5);
        const away = segment.position.distanceTo(eye);
        segment.scale.set(away, away, Math.max(1e-6, this.#point.distanceTo(this.#end)));
        segment.lookAt(this.#end);
        segment.updateMatrix();
        lines.setMatrixAt(i, segment.matrix);
      });
      lines.instanceMatrix.needsUpdate = true;
      lines.material = material;
      tag.object.visible = seen || ends.length > 0;
      tag.place(inRoom(anchorOf(mark), this.#point), eye, delta);
    }
    this.#cursor.object.visible = reading !== null;
    if (reading) {
      this.#cursor.text.value = valueText(reading);
      this.#cursor.place(inRoom(reading.point, this.#point), eye, delta);
    }
  }

  /** Where this text stands, in the room; null: it is not shown. */
  find(text: string): Vector3 | null {
    const tags = [this.#cursor, ...(this.#placed.visible ? this.#standing.map(({ tag }) => tag) : [])];
    const tag = tags.find((one) => one.object.visible && one.text.value === text);
    return tag?.object.position.clone() ?? null;
  }

  dispose(): void {
    this.#clear();
    this.#cursor.dispose();
    [this.#dot, this.#line, this.#seen, this.#faded].forEach((one) => one.dispose());
  }

  #build(): void {
    this.#clear();
    this.#standing = this.#marks.map((mark) => this.#stand(mark));
    for (const { dots, lines, tag } of this.#standing) {
      for (const mesh of [...dots, lines]) {
        mesh.renderOrder = kOverCase;
      }
      this.#placed.add(...dots, lines, tag.object);
    }
  }

  #stand(mark: Mark): Standing {
    const ends = linesOf(mark).flatMap((line) =>
      line.slice(1).map((to, i): [Vector3, Vector3] => [line[i]!, to]),
    );
    const dots = mark.points.map(() => new Mesh(this.#dot, this.#seen));
    const lines = new InstancedMesh(this.#line, this.#seen, Math.max(1, ends.length));
    lines.visible = ends.length > 0;
    lines.frustumCulled = false; // its instances move
    const text = markText(mark, measure(mark, this.#viewer.section));
    const tag = new Tag(this.#families(text), ends.length > 0 ? "below" : "above");
    tag.text.value = text;
    return { mark, dots, lines, ends, tag };
  }

  #clear(): void {
    for (const { dots, lines, tag } of this.#standing) {
      this.#placed.remove(...dots, lines);
      lines.dispose();
      tag.dispose();
    }
    this.#standing = [];
  }
}
