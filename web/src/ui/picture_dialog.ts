import { computed, signal } from "@preact/signals-core";

import { inOwnWords, texts } from "../text/text";
import type { Viewer } from "../viewer";
import { sheetDialog } from "./sheet_dialog";
import { h } from "./dom";
import type { WantedPicture } from "./pictures";
import { choices } from "./segments";

type Size = "once" | "twice" | "fourK" | "own";

/** The longer side of a picture of 4K. */
const kFourK = 3840;

/** Asks for the size of a picture and what it is to have; `save` rejects with a line for a person. */
export function pictureDialog(
  viewer: Viewer,
  save: (wanted: WantedPicture) => Promise<void>,
): { element: HTMLDialogElement; show: () => void } {
  const t = texts().picture;
  const size = signal<Size>("once");
  const busy = signal(false);
  const problem = signal("");
  const number = (text: string) =>
    h("input", {
      type: "number",
      min: "16",
      step: "1",
      "aria-label": text,
      oninput: () => (size.value = "own"),
    });
  const [width, height] = [number(t.width), number(t.height)];
  const transparent = h("input", { type: "checkbox" });
  const labels = h("input", { type: "checkbox", checked: true });
  /** As large as the case is seen, in pixels of the screen. */
  const seen = () => {
    const { width: w, height: h } = viewer.camera.freeSize;
    return [devicePixelRatio * w, devicePixelRatio * h] as const;
  };
  const take = (one: Size): void => {
    size.value = one;
    const [w, h] = seen();
    const factor = { once: 1, twice: 2, fourK: kFourK / Math.max(w, h), own: 0 }[one];
    if (factor > 0) {
      width.value = String(Math.round(factor * w));
      height.value = String(Math.round(factor * h));
    }
  };
  const press = async (): Promise<void> => {
    problem.value = "";
    busy.value = true;
    try {
      await save({
        width: width.valueAsNumber,
        height: height.valueAsNumber,
        transparent: transparent.checked,
        labels: labels.checked,
      });
      element.close();
    } catch (error) {
      problem.value = inOwnWords((error as Error).message);
    } finally {
      busy.value = false;
    }
  };
  const element = sheetDialog(
    "sheet picture-sheet",
    t.title,
    t.title,
    choices<Size>(t.size, t.sizes, (one) => computed(() => size.value === one), take),
    h("div", { class: "row" }, h("label", {}, t.width, width), h("label", {}, t.height, height)),
    h("label", { class: "check" }, transparent, t.transparent),
    h("label", { class: "check" }, labels, t.labels),
    h("p", { class: "hint", role: "alert", hidden: computed(() => problem.value === "") }, problem),
    h(
      "button",
      { class: "solid", disabled: busy, onclick: () => void press() },
      computed(() => (busy.value ? t.drawing : t.save)),
    ),
  );
  return {
    element,
    show: () => {
      take(size.value);
      element.showModal();
    },
  };
}
