import { sheetDialog } from "./case_menu";
import { h } from "./dom";

const kHelp: [string, string][] = [
  ["Drag", "turn"],
  ["Right drag, Shift + drag, two fingers", "move"],
  ["Right drag on a grey face", "window: wider to the right, higher upwards"],
  ["Wheel, pinch", "zoom"],
  ["Drag the arrow", "slide the plane"],
  ["Drag the rim (Shift: snap)", "tilt the plane"],
  ["Ctrl or Alt + wheel, ↑ ↓", "slide the plane, or from state to state (Shift: faster)"],
  ["U", "uniaxial or arbitrary plane"],
  ["A  C  S", "axial, coronal, sagittal plane"],
  ["F", "flip the plane"],
  ["P", "cut or uncut"],
  ["N  E  X", "new plane, next plane, remove plane"],
  ["B", "slab: a second face behind the plane"],
  ["G", "faces cinematic or grey"],
  ["W", "next window of grey values"],
  ["I", "pin the value under the pointer; a click on it removes it"],
  ["L", "measure from the point under the pointer to the next one"],
  ["H", "show or hide the handle"],
  ["O", "show or hide the body: cut faces alone"],
  ["1  2  3  4", "hard, soft, exact cut, by layers"],
  ["R", "reset"],
  ["Ctrl + Z, Ctrl + Shift + Z", "undo and redo what was done to the cut"],
  ["D", "save a picture of what is seen (PNG)"],
  ["Z", "full screen"],
  ["T", "colours: as the system, dark, light"],
  ["M", "cases"],
  ["K", "looks of the volume, where it has several"],
  ["V", "show the case in a headset, where there is one"],
  ["?", "this help"],
];

export function helpDialog(): HTMLDialogElement {
  return sheetDialog(
    "sheet help",
    "Help",
    "Controls",
    h("dl", {}, ...kHelp.flatMap(([key, meaning]) => [h("dt", {}, key), h("dd", {}, meaning)])),
  );
}
