import { Vector3 } from "three";

import type { Follow } from "../model/follower";
import type { Triple } from "../model/geometry";
import { cameraAxes, viewDirection } from "../model/view";
import { texts } from "../text/text";
import type { Viewer } from "../viewer";
import { follow, h, svg } from "./dom";

/** At the pad's rim, degrees from the camera: the lamp shines nearly from behind the case. */
const kRim = 150;
const kRadius = 38; // px
const kStep = 5; // degrees, of an arrow key
/** Where a lamp is at first: beside the camera and above it, as a reader's. */
const kFirst = { x: -0.25, y: 0.3 };

/** A place of the pad: right and up, 1 at its rim. */
interface Place {
  x: number;
  y: number;
}

/** Where a lamp in hand shines from: the middle of the pad is the camera, its rim nearly behind the case. */
export class LampPad {
  readonly element: HTMLElement;
  readonly #viewer: Viewer;
  readonly #knob = svg("circle", { r: "7", class: "knob" });

  constructor(viewer: Viewer, live: Follow) {
    const t = texts().light;
    this.#viewer = viewer;
    const place = live(() => this.#place);
    const size = String(2 * kRadius + 4);
    const box = `${-kRadius - 2} ${-kRadius - 2} ${size} ${size}`;
    const rim = svg("circle", { r: String(kRadius), class: "rim" });
    const front = svg("circle", { r: String((kRadius * 90) / kRim), class: "front" });
    this.element = h(
      "div",
      {
        class: "lamp-pad",
        role: "slider",
        tabindex: "0",
        "aria-label": t.pad,
        title: t.padHint,
        "aria-valuemin": "0",
        "aria-valuemax": String(kRim),
        "aria-valuenow": live(() => String(angleOf(place.value))),
        "aria-valuetext": live(() => placeText(place.value)),
        onpointerdown: (event) => this.#grab(event as PointerEvent),
        onpointermove: (event) => this.#drag(event as PointerEvent),
        onkeydown: (event) => this.#key(event as KeyboardEvent),
      },
      svg("svg", { viewBox: box, width: size, height: size, "aria-hidden": "true" }, rim, front, this.#knob),
    );
    follow(() => {
      const { x, y } = place.value;
      this.#knob.setAttribute("cx", (kRadius * x).toFixed(1));
      this.#knob.setAttribute("cy", (-kRadius * y).toFixed(1));
    });
  }

  /** Lights a lamp. */
  begin(): void {
    this.#put(kFirst);
  }

  /** Right, up and towards the camera, RAS. */
  get #axes(): [Vector3, Vector3, Vector3] {
    const { azimuth, elevation } = this.#viewer.state.view;
    const back = viewDirection(azimuth, elevation);
    const { right, down } = cameraAxes(back.clone().negate());
    return [right, down.negate(), back];
  }

  get #place(): Place {
    const lamp = new Vector3(...(this.#viewer.state.lamp ?? [0, 0, 1]));
    const [x, y, z] = this.#axes.map((axis) => axis.dot(lamp)) as Triple;
    const across = Math.hypot(x, y);
    const radius = Math.min(1, (Math.atan2(across, z) * 180) / Math.PI / kRim);
    return across > 0 ? { x: (radius * x) / across, y: (radius * y) / across } : { x: 0, y: 0 };
  }

  #put({ x, y }: Place): void {
    const radius = Math.hypot(x, y);
    const angle = (Math.min(1, radius) * kRim * Math.PI) / 180;
    const [right, up, back] = this.#axes;
    const across = radius > 0 ? Math.sin(angle) / radius : 0;
    const from = back.multiplyScalar(Math.cos(angle));
    from.addScaledVector(right, across * x).addScaledVector(up, across * y);
    this.#viewer.store.setLamp(from.toArray());
  }

  #grab(event: PointerEvent): void {
    event.preventDefault();
    this.element.focus();
    this.element.setPointerCapture(event.pointerId);
    this.#drag(event);
  }

  #drag(event: PointerEvent): void {
    if (this.element.hasPointerCapture(event.pointerId)) {
      const { left, top, width, height } = this.element.getBoundingClientRect();
      const x = (event.clientX - left - 0.5 * width) / kRadius;
      const y = (0.5 * height - (event.clientY - top)) / kRadius;
      this.#put({ x, y });
    }
  }

  #key(event: KeyboardEvent): void {
    const steps: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const step = steps[event.key];
    if (step) {
      event.preventDefault();
      event.stopPropagation();
      const { x, y } = this.#place;
      this.#put({ x: x + (step[0] * kStep) / kRim, y: y + (step[1] * kStep) / kRim });
    }
  }
}

/** From the camera, degrees. */
function angleOf({ x, y }: Place): number {
  return Math.round(kRim * Math.hypot(x, y));
}

function placeText(place: Place): string {
  const { x, y } = place;
  const across = Math.abs(x) < 0.05 ? "" : x < 0 ? "left" : "right";
  const along = Math.abs(y) < 0.05 ? "" : y < 0 ? "below" : "above";
  return texts().light.place(angleOf(place), across, along);
}
