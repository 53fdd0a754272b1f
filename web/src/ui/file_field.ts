import { h } from "./dom";

/** Lets a person choose a file once it is clicked; by itself it is not seen. */
export function fileField(accept: string, open: (file: File) => void): HTMLInputElement {
  const field: HTMLInputElement = h("input", {
    type: "file",
    accept,
    hidden: true,
    onchange: () => {
      const [file] = field.files ?? [];
      field.value = ""; // the same one may be chosen again
      if (file) {
        open(file);
      }
    },
  });
  return field;
}
