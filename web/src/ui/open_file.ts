import type { Fail } from "../host";
import { CaseError } from "../sog/zip";
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

/** Whether a file is of a volume, of which a case can be made. */
export async function isVolume(file: File): Promise<boolean> {
  const kDicom = { at: 128, word: "DICM" };
  return (
    /\.(dcm|dicom|ima|nii|nii\.gz|nrrd|nhdr|mha|mhd)$/i.test(file.name) ||
    (await file.slice(kDicom.at, kDicom.at + kDicom.word.length).text()) === kDicom.word
  );
}

/** Whether a file holds views of a case, or, as others of its kind, marks. */
export async function isTour(file: File): Promise<boolean> {
  const kBeginning = 200;
  return (
    /\.tour\.json$/i.test(file.name) || (await file.slice(0, kBeginning).text()).includes('"clipgs_tour"')
  );
}

/** What is dropped, as far as it says before it is read. */
type Dropped = Pick<DataTransfer, "files"> & {
  items: ArrayLike<{ webkitGetAsEntry(): { isDirectory: boolean; name: string } | null }>;
};

/** The files that are dropped at once: a case or scene first, and marks or views of it. Throws CaseError for what cannot be opened. */
export function droppedFiles({ files, items }: Dropped): File[] {
  const folder = Array.from(items, (item) => item.webkitGetAsEntry()).find((entry) => entry?.isDirectory);
  if (folder) {
    throw new CaseError(texts().files.folder(folder.name));
  }
  const isBeside = ({ name }: File) => /\.json$/i.test(name);
  const all = [...files];
  const cases = all.filter((file) => !isBeside(file));
  if (cases.length > 1) {
    throw new CaseError(texts().files.several);
  }
  return [...cases, ...all.filter(isBeside)];
}

/**
 * Files that are dropped on `root` are opened, or `fail` is told why not; what is said there while one is over it.
 */
export function dropZone(
  root: HTMLElement,
  open: (files: readonly File[]) => void,
  fail: Fail,
  signal: AbortSignal,
): HTMLElement {
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
    try {
      open(droppedFiles(event.dataTransfer!));
    } catch (error) {
      fail((error as CaseError).message, null);
    }
  });
  return sign;
}
