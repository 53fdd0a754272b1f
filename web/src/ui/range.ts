import type { ReadonlySignal } from "@preact/signals-core";

import type { Position } from "../actions";
import { follow, h } from "./dom";

type Attributes = Parameters<typeof h>[1];

/** A slider. Its ends and its value are set together: browsers keep a value within the ends that it meets. */
export function range(
  attributes: Attributes,
  position: ReadonlySignal<Position | null>,
  moved: (value: number) => void,
): HTMLInputElement {
  const slider = h("input", { ...attributes, type: "range", oninput: () => moved(slider.valueAsNumber) });
  follow(() => {
    const at = position.value;
    if (at) {
      slider.min = String(at.min);
      slider.max = String(at.max);
      slider.step = String(at.step);
      slider.value = String(at.value);
    }
  });
  return slider;
}
