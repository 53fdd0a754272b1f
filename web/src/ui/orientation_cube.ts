import type { Texts } from "../text/en";
import { texts } from "../text/text";
import { cameraAxes, viewDirection, type View } from "../model/view";
import { h } from "./dom";

interface Face {
  letter: string;
  name: keyof Texts["sides"];
  azimuth: number;
  elevation: number;
  transform: string;
}

// The cube's own frame is CSS's (x right, y down, z towards the reader) with the patient upright and facing the reader.
const kFaces: Face[] = [
  { letter: "A", name: "anterior", azimuth: 0, elevation: 0, transform: "" },
  { letter: "L", name: "left", azimuth: 90, elevation: 0, transform: "rotateY(90deg)" },
  { letter: "P", name: "posterior", azimuth: 180, elevation: 0, transform: "rotateY(180deg)" },
  { letter: "R", name: "right", azimuth: -90, elevation: 0, transform: "rotateY(-90deg)" },
  { letter: "S", name: "superior", azimuth: 0, elevation: 89.9, transform: "rotateX(90deg)" },
  { letter: "I", name: "inferior", azimuth: 0, elevation: -89.9, transform: "rotateX(-90deg)" },
];

/** A cube lettered R L A P S I that turns with the patient; a click on a face looks at it. */
export class OrientationCube {
  readonly element: HTMLElement;
  readonly #cube: HTMLElement;

  constructor(look: (azimuth: number, elevation: number) => void) {
    this.#cube = h(
      "div",
      { class: "cube" },
      ...kFaces.map((face) =>
        h(
          "button",
          {
            class: "face",
            style: `transform: ${face.transform} translateZ(var(--half))`,
            "aria-label": texts().page.lookFrom(texts().sides[face.name]),
            title: texts().page.lookFrom(texts().sides[face.name]),
            onclick: () => look(face.azimuth, face.elevation),
          },
          face.letter,
        ),
      ),
    );
    this.element = h(
      "div",
      { class: "cube-stage", part: "cube", role: "group", "aria-label": texts().page.orientation },
      this.#cube,
    );
  }

  update(view: View): void {
    const forward = viewDirection(view.azimuth, view.elevation).negate();
    const { right, down } = cameraAxes(forward);
    // Columns: where the cube's x (patient's left), y (inferior) and z (anterior) go on the screen.
    const columns = [-1, -1, 1].map((sign, i) => {
      const axis = [0, 2, 1][i]!;
      return [right, down, forward].map((v, row) => sign * (row === 2 ? -1 : 1) * v.getComponent(axis));
    });
    this.#cube.style.transform = `matrix3d(${columns.map((c) => [...c, 0].map((v) => v.toFixed(5)).join()).join()},0,0,0,1)`;
  }
}
