import { texts } from "../text/text";
import { h, icon, kIcons } from "./dom";

/** A sheet with a heading and a button that closes it; a press beside it does, too. */
export function sheetDialog(
  classes: string,
  name: string,
  heading: string,
  ...content: HTMLElement[]
): HTMLDialogElement {
  const dialog: HTMLDialogElement = h(
    "dialog",
    { class: classes, "aria-label": name, autofocus: true },
    h(
      "header",
      {},
      h("h2", {}, heading),
      closeButton(() => dialog.close()),
    ),
    ...content,
  );
  closeOnBackdrop(dialog);
  return dialog;
}

function closeButton(close: () => void): HTMLElement {
  return h("button", { class: "plain", "aria-label": texts().close, onclick: close }, icon(kIcons.close));
}

function closeOnBackdrop(dialog: HTMLDialogElement): void {
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) {
      dialog.close();
    }
  });
}
