import { layOut } from "../model/label_layout";
import { anchorOf, isLine, linesOf } from "../model/marks";
import { shownMarks } from "../model/viewer_state";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { type FaceMarks, faceMarks } from "./face_overlay";
import type { MarkTexts } from "./marks_overlay";

// Of what is drawn over the picture, CSS px.
const kMargin = 16;
const kPadding = 8;
const kBoxHeight = 24;
const kPinRadius = 5;

interface Place {
  x: number;
  y: number;
}

/** The colours of the page's panels. */
interface Colors {
  text: string;
  panel: string;
  halo: string;
}

/** Draws it over a picture of what the viewer shows, in the colours of `root`. */
export function drawCaption(
  picture: HTMLCanvasElement,
  viewer: Viewer,
  root: HTMLElement,
  said: MarkTexts,
): void {
  const styles = getComputedStyle(root);
  const color = (name: string) => styles.getPropertyValue(`--${name}`);
  const colors = { text: color("text"), panel: color("panel"), halo: color("halo") };
  new Caption(picture, viewer, colors, styles.fontFamily, said).draw();
}

/** What stands over a case's picture: its title, what it is not for, what is marked, and the directions of grey faces. */
class Caption {
  readonly #context: CanvasRenderingContext2D;
  readonly #viewer: Viewer;
  readonly #colors: Colors;
  readonly #font: string;
  readonly #said: MarkTexts;

  constructor(picture: HTMLCanvasElement, viewer: Viewer, colors: Colors, font: string, said: MarkTexts) {
    this.#context = picture.getContext("2d")!;
    this.#viewer = viewer;
    this.#colors = colors;
    this.#font = font;
    this.#said = said;
    const { width, height } = viewer.camera.freeSize;
    this.#context.scale(picture.width / width, picture.height / height);
    this.#context.textBaseline = "middle";
  }

  draw(): void {
    const { title } = this.#viewer;
    const { height } = this.#viewer.camera.freeSize;
    if (this.#viewer.state.layers.marks) {
      this.#drawMarks();
    }
    const marks = faceMarks(this.#viewer);
    if (marks) {
      this.#drawDirections(marks);
    }
    this.#setFont(600);
    this.#box(texts().notForDiagnosis, { x: kMargin, y: height - kMargin - 0.5 * kBoxHeight });
    if (title) {
      this.#box(title, { x: kMargin, y: kMargin + 0.5 * kBoxHeight });
    }
  }

  /** As the page has them: labels keep clear of each other. */
  #drawMarks(): void {
    const { camera, picking, state } = this.#viewer;
    const context = this.#context;
    this.#setFont(400);
    const drawn = shownMarks(state).flatMap((mark) => {
      const anchor = camera.project(anchorOf(mark));
      const width = context.measureText(this.#said.of(mark)).width + 2 * kPadding;
      const line = isLine(mark) ? mark.points.flatMap((point) => camera.project(point) ?? []) : [];
      return anchor ? [{ mark, label: { anchor, line, width, height: kBoxHeight } }] : [];
    });
    drawn.sort((a, b) => Number(a.mark.kind === "point") - Number(b.mark.kind === "point"));
    const laid = layOut(
      drawn.map(({ label }) => label),
      camera.freeSize,
    );
    drawn.forEach(({ mark }, i) => {
      context.globalAlpha = mark.points.some((point) => picking.isSeen(point)) ? 1 : 0.35;
      for (const line of linesOf(mark)) {
        this.#trace(line.map((point) => camera.project(point)));
      }
      for (const point of mark.points) {
        const at = camera.project(point);
        if (at) {
          this.#outlined(() => context.arc(at.x, at.y, kPinRadius, 0, 2 * Math.PI));
        }
      }
      const { x, y } = laid[i]!.at;
      this.#box(this.#said.of(mark), { x, y: y + 0.5 * kBoxHeight });
      context.globalAlpha = 1;
    });
  }

  #trace(line: readonly (Place | null)[]): void {
    if (line.every((place) => place !== null)) {
      this.#outlined(() =>
        line.forEach(({ x, y }, i) => (i === 0 ? this.#context.moveTo(x, y) : this.#context.lineTo(x, y))),
      );
    }
  }

  /** Letters at the edges, the window and the scale bar, where the overlay has them. */
  #drawDirections({ letters: [left, right, top, bottom], barMm, barWidth, window }: FaceMarks): void {
    const { width, height } = this.#viewer.camera.freeSize;
    const [x, y] = [0.5 * width, 0.5 * height];
    this.#setFont(600);
    this.#label(left, { x: kMargin, y }, "left");
    this.#label(right, { x: width - kMargin, y }, "right");
    this.#label(top, { x, y: 2 * kMargin }, "center");
    this.#label(bottom, { x, y: height - 3 * kMargin }, "center");
    const bar = height - 4 * kMargin;
    this.#label(window, { x: kMargin, y: bar - 36 }, "left");
    this.#label(`${barMm} mm`, { x: kMargin, y: bar - 18 }, "left");
    this.#outlined(() => {
      this.#context.moveTo(kMargin, bar - 6);
      this.#context.lineTo(kMargin, bar);
      this.#context.lineTo(kMargin + barWidth, bar);
      this.#context.lineTo(kMargin + barWidth, bar - 6);
    });
  }

  #setFont(weight: number): void {
    this.#context.font = `${weight} 12px ${this.#font}`;
  }

  /** Text in a box that begins at `x` and has its middle at `y`. */
  #box(text: string, { x, y }: Place): void {
    const context = this.#context;
    const width = context.measureText(text).width + 2 * kPadding;
    context.beginPath();
    context.roundRect(x, y - 0.5 * kBoxHeight, width, kBoxHeight, 8);
    context.fillStyle = this.#colors.panel;
    context.fill();
    context.textAlign = "left";
    context.fillStyle = this.#colors.text;
    context.fillText(text, x + kPadding, y);
  }

  #label(text: string, { x, y }: Place, align: CanvasTextAlign): void {
    const context = this.#context;
    context.textAlign = align;
    context.lineWidth = 3;
    context.strokeStyle = this.#colors.halo;
    context.strokeText(text, x, y);
    context.fillStyle = this.#colors.text;
    context.fillText(text, x, y);
  }

  /** White lines that are seen on white, too. */
  #outlined(path: () => void): void {
    const context = this.#context;
    context.beginPath();
    path();
    context.lineWidth = 4;
    context.strokeStyle = "#000b";
    context.stroke();
    context.lineWidth = 2;
    context.strokeStyle = "#fff";
    context.stroke();
  }
}
