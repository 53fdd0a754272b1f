import { texts } from "../text/text";
import { h } from "./dom";
import { Preference } from "./preference";

const hint = new Preference("clipgs.hint", ["new", "seen"]);

/** What to do first: it goes with the first thing that is done anywhere in the viewer, and does not come again. */
export function firstHint(viewer: HTMLElement): HTMLElement {
  const t = texts().hint;
  const element = h(
    "p",
    { class: "first-hint", role: "note", hidden: hint.value === "seen" },
    h("span", { class: "for-mouse" }, t.mouse),
    h("span", { class: "for-fingers" }, t.fingers),
  );
  const go = (): void => {
    element.hidden = true;
    hint.value = "seen";
  };
  for (const type of ["pointerdown", "wheel", "keydown"] as const) {
    viewer.addEventListener(type, go, { once: true, passive: true, capture: true });
  }
  return element;
}
