import type { Viewer } from "../viewer";
import { lengthsOf, lengthText } from "../model/pins";
import { valueText } from "../model/values";
import { type FaceMarks, faceMarks } from "./face_overlay";

// Of what is drawn over the picture, CSS px.
const kMargin = 16;
const kPadding = 8;
const kBoxHeight = 24;
const kPinRadius = 5;

type Place = { x: number; y: number };

/** The colours of the page's panels. */
interface Colors {
  text: string;
  panel: string;
  halo: string;
}

/**
 * Saves what the viewer shows as a PNG, in the colours of `root`: its name is the case's. Rejects with CaseError where
 * that case is closed meanwhile.
 */
export async function savePicture(viewer: Viewer, title: string, root: HTMLElement): Promise<void> {
  const name = viewer.caseName ?? "clipgs";
  const picture = await viewer.snapshot((drawn) => drawCaption(drawn, viewer, title, root));
  const blob = await new Promise<Blob | null>((resolve) => picture.toBlob(resolve, "image/png"));
  if (blob) {
    download(blob, `${fileName(name)}.png`);
  }
}

function drawCaption(picture: HTMLCanvasElement, viewer: Viewer, title: string, root: HTMLElement): void {
  const styles = getComputedStyle(root);
  const color = (name: string) => styles.getPropertyValue(`--${name}`);
  const colors = { text: color("text"), panel: color("panel"), halo: color("halo") };
  new Caption(picture, viewer, colors, styles.fontFamily).draw(title);
}

/** What file systems take of a case's name. */
function fileName(name: string): string {
  return name.replace(/[^\p{L}\p{N}._ -]+/gu, "-");
}

function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** What stands over a case's picture: its title, what it is not for, pins, lengths and the marks of grey faces. */
class Caption {
  readonly #context: CanvasRenderingContext2D;
  readonly #viewer: Viewer;
  readonly #colors: Colors;
  readonly #font: string;

  constructor(picture: HTMLCanvasElement, viewer: Viewer, colors: Colors, font: string) {
    this.#context = picture.getContext("2d")!;
    this.#viewer = viewer;
    this.#colors = colors;
    this.#font = font;
    const { width, height } = viewer.camera.freeSize;
    this.#context.scale(picture.width / width, picture.height / height);
    this.#context.textBaseline = "middle";
  }

  draw(title: string): void {
    const { height } = this.#viewer.camera.freeSize;
    this.#drawLengths();
    this.#drawPins();
    const marks = faceMarks(this.#viewer);
    if (marks) {
      this.#drawMarks(marks);
    }
    this.#setFont(600);
    this.#box("Not for diagnosis", { x: kMargin, y: height - kMargin - 0.5 * kBoxHeight });
    if (title) {
      this.#box(title, { x: kMargin, y: kMargin + 0.5 * kBoxHeight });
    }
  }

  #drawPins(): void {
    const viewer = this.#viewer;
    const context = this.#context;
    this.#setFont(400);
    for (const pin of viewer.state.pins) {
      const at = viewer.camera.project(pin.point);
      if (at) {
        context.globalAlpha = viewer.picking.isSeen(pin.point) ? 1 : 0.35;
        this.#outlined(() => context.arc(at.x, at.y, kPinRadius, 0, 2 * Math.PI));
        this.#box(valueText(pin), { x: at.x + kPinRadius + 6, y: at.y });
        context.globalAlpha = 1;
      }
    }
  }

  #drawLengths(): void {
    const context = this.#context;
    this.#setFont(400);
    for (const length of lengthsOf(this.#viewer.state.pins)) {
      const [a, b] = [length.from, length.to].map((point) => this.#viewer.camera.project(point));
      if (a && b) {
        this.#outlined(() => {
          context.moveTo(a.x, a.y);
          context.lineTo(b.x, b.y);
        });
        const text = lengthText(length);
        const half = 0.5 * context.measureText(text).width + kPadding;
        this.#box(text, { x: 0.5 * (a.x + b.x) - half, y: 0.5 * (a.y + b.y) });
      }
    }
  }

  /** Letters at the edges, the window and the scale bar, where the overlay has them. */
  #drawMarks({ letters: [left, right, top, bottom], barMm, barWidth, window }: FaceMarks): void {
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
