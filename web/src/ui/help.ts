import { texts } from "../text/text";
import { sheetDialog } from "./sheet_dialog";
import { h } from "./dom";

/** What is done with fingers, where those are what there is, or with a mouse and keys. */
export function helpDialog(): HTMLDialogElement {
  const t = texts().help;
  const list = (lines: readonly [string, string][]) =>
    h("dl", {}, ...lines.flatMap(([key, meaning]) => [h("dt", {}, key), h("dd", {}, meaning)]));
  return sheetDialog(
    "sheet help",
    t.name,
    t.title,
    h("div", { class: "for-fingers" }, list(t.fingers)),
    h("div", { class: "for-mouse" }, list([...t.mouse, ...t.keys])),
    h("div", { class: "for-mouse for-experts" }, list(t.expertKeys)),
  );
}
