import { texts } from "../text/text";
import { h } from "./dom";
import { fileField } from "./file_field";

const kEndings = ".sog,.ply,.spz";

/** A button that lets a person choose a file of their own. */
export function openFileButton(open: (file: File) => void): HTMLElement {
  const field = fileField(kEndings, open);
  const button = h(
    "button",
    { class: "solid quiet open-file", title: texts().files.openHint, onclick: () => field.click() },
    texts().files.open,
    field,
  );
  return button;
}

/** Files that are dropped on `root` are opened; what is said there while one is over it. */
export function dropZone(root: HTMLElement, open: (file: File) => void, signal: AbortSignal): HTMLElement {
  const sign = h("div", { class: "drop", hidden: true }, h("p", {}, texts().files.drop));
  const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") ?? false;
  const listen = (
    type: "dragenter" | "dragover" | "dragleave" | "drop",
    hear: (event: DragEvent) => void,
  ): void => root.addEventListener(type, (event) => hasFiles(event) && hear(event), { signal });
  const welcome = (event: DragEvent): void => {
    event.preventDefault(); // it may be dropped here
    event.dataTransfer!.dropEffect = "copy";
    sign.hidden = false;
  };
  listen("dragenter", welcome);
  listen("dragover", welcome);
  listen("dragleave", ({ relatedTarget }) => {
    sign.hidden = !(relatedTarget instanceof Node && root.contains(relatedTarget));
  });
  listen("drop", (event) => {
    event.preventDefault();
    sign.hidden = true;
    const [file] = event.dataTransfer!.files;
    if (file) {
      open(file);
    }
  });
  return sign;
}
