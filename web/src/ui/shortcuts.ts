import type { Actions } from "../actions";
import type { Host } from "../host";
import type { Marking } from "../model/marking";
import type { Viewer } from "../viewer";
import type { Views } from "../views";
import type { FullScreen } from "./full_screen";
import type { MarksOverlay } from "./marks_overlay";
import type { Pictures } from "./pictures";
import type { ViewerTheme } from "./theme";
import type { TopBar } from "./top_bar";
import { ViewKeys } from "./view_keys";

/** Fields that keys are typed into. */
const kTypedInto: readonly string[] = ["number", "text", "search"];

/** What keys do something with. */
export interface ShortcutParts {
  readonly root: HTMLElement;
  readonly host: Host;
  readonly viewer: Viewer;
  readonly actions: Actions;
  readonly marking: Marking;
  readonly marks: MarksOverlay;
  readonly views: Views;
  readonly pictures: Pictures;
  readonly theme: ViewerTheme;
  readonly fullScreen: FullScreen;
  readonly bar: TopBar;
  /** Whether keys do nothing. */
  areOff(): boolean;
  /** Lets a person choose a case to be beside this one, or none is any more. */
  toggleBeside(): void;
  dismissMessage(): void;
  showPictureSizes(): void;
  showHelp(): void;
}

/** Does what the help says that keys do. */
export class Shortcuts {
  readonly #parts: ShortcutParts;
  readonly #viewKeys: ViewKeys;

  constructor(parts: ShortcutParts) {
    this.#parts = parts;
    this.#viewKeys = new ViewKeys(parts.viewer);
  }

  press(event: KeyboardEvent): void {
    const { root, viewer, actions } = this.#parts;
    const [target] = event.composedPath();
    const input = target instanceof HTMLInputElement ? target : null;
    const types = input ? kTypedInto.includes(input.type) : target instanceof HTMLTextAreaElement;
    if (this.#parts.areOff() || types || root.querySelector("dialog[open]")) {
      return;
    }
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
      event.preventDefault();
      if (event.shiftKey) {
        actions.redo();
      } else {
        actions.undo();
      }
      return;
    }
    if (target === viewer.canvas && this.#viewKeys.press(event)) {
      event.preventDefault();
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    const action = this.#actionOf(event, target);
    if (action) {
      event.preventDefault();
      action();
    }
  }

  #actionOf({ key, shiftKey }: KeyboardEvent, target: EventTarget | undefined): (() => unknown) | undefined {
    const { host, viewer, actions, marking, marks, views, pictures, bar, ...parts } = this.#parts;
    const { store } = viewer;
    const step = shiftKey ? 10 : 1;
    const isButton = target instanceof HTMLButtonElement;
    const keys: Record<string, () => unknown> = {
      a: () => actions.orient("axial"),
      c: () => actions.orient("coronal"),
      s: () => actions.orient("sagittal"),
      f: () => actions.flip(),
      p: () => actions.toggle(),
      u: () => actions.toggleMode(),
      n: () => actions.add(),
      e: () => actions.activate(),
      x: () => actions.remove(),
      b: () => actions.toggleSlab(),
      q: () => viewer.section && actions.toggleSlices(),
      y: () => parts.toggleBeside(),
      g: () => actions.toggleGrey(),
      w: () => actions.nextWindow(),
      i: () => marks.mark("point"),
      l: () => marks.mark("length"),
      escape: () => this.#escape(),
      h: () => store.setHandle(!viewer.state.handle),
      o: () => store.setLayers({ body: !viewer.state.layers.body }),
      r: () => actions.reset(),
      m: () => host.choose?.(),
      k: () => bar.chooseLook(),
      d: () => (shiftKey ? parts.showPictureSizes() : void pictures.save()),
      j: () => views.save(),
      "0": () => void views.player.toggle(),
      ",": () => void views.player.step(-1),
      ".": () => void views.player.step(1),
      t: () => parts.theme.next(),
      z: () => parts.fullScreen.toggle(),
      v: () => bar.enterHeadset(),
      "?": () => parts.showHelp(),
      "1": () => store.setClip("hard"),
      "2": () => store.setClip("soft"),
      "3": () => store.setClip("exact"),
      "4": () => viewer.hasLayers && store.setClip("layers"),
      ...(marks.chosen.value ? { delete: () => marks.removeChosen() } : {}),
      ...(marking.kind === "outline" && !isButton ? { enter: () => marking.finish() } : {}),
      ...(target instanceof HTMLInputElement
        ? {}
        : { arrowup: () => actions.step(step), arrowdown: () => actions.step(-step) }),
    };
    return keys[key.toLowerCase()];
  }

  /** What is begun, chosen or said is gone. */
  #escape(): void {
    const { marks, views } = this.#parts;
    marks.escape();
    this.#parts.dismissMessage();
    views.player.leave();
  }
}
