import type { ReadonlySignal } from "@preact/signals-core";

import type { Fail, Host } from "./host";
import { BrowserPlace, Keeper, volumeOf } from "./model/keeper";
import { textOf } from "./model/kept_file";
import type { Mark } from "./model/marks";
import { formatMarks, kMarksFile, mergedMarks, parseMarks } from "./model/marks_file";
import { download } from "./ui/download";
import type { MarksFiles } from "./ui/marks_panel";
import type { Viewer } from "./viewer";

/** The marks of a volume: where they are kept, and files of them. */
export class KeptMarks implements MarksFiles {
  readonly #viewer: Viewer;
  readonly #host: Host;
  readonly #fail: Fail;
  readonly #keeper = new Keeper(kMarksFile);

  constructor(viewer: Viewer, host: Host, fail: Fail) {
    this.#viewer = viewer;
    this.#host = host;
    this.#fail = fail;
  }

  /** Why they are not kept; null: they are. */
  get trouble(): ReadonlySignal<string | null> {
    return this.#keeper.trouble;
  }

  /**
   * What was marked before of the case of this name, which is shown now, unless a link says what is; of a person's own
   * file, in this browser alone.
   */
  async bring(name: string, isOwn: boolean): Promise<void> {
    const { store } = this.#viewer;
    const { volume } = this.#viewer.info!;
    const place =
      (!isOwn && this.#host.marksPlace?.(name, volume)) || new BrowserPlace(kMarksFile, volume, name);
    const kept = await this.#keeper.open(place, volumeOf(this.#viewer));
    const marks = store.state.marks.length > 0 ? store.state.marks : kept;
    this.#keeper.adopt(marks);
    store.setMarks(marks);
  }

  /** These are shown because a link says so. */
  adopt(marks: readonly Mark[]): void {
    this.#keeper.adopt(marks);
  }

  /** After every change of the viewer's state. */
  observe(): void {
    this.#keeper.observe(this.#viewer.store.state.marks, volumeOf(this.#viewer));
  }

  /** What is to be kept is kept at once. */
  flush(): void {
    this.#keeper.flush();
  }

  save(): void {
    const { caseName, info, state } = this.#viewer;
    const text = formatMarks(state.marks, info?.volume ?? "");
    download(new Blob([text], { type: "application/json" }), `${caseName ?? "case"}.marks.json`);
  }

  open(file: File): void {
    void this.#open(file).catch((error: Error) => this.#fail(error.message, () => this.open(file)));
  }

  /** A file's marks come to those that are there. */
  async #open(file: File): Promise<void> {
    const text = await textOf(file);
    const { info, state, store } = this.#viewer;
    const marks = parseMarks(text, file.name, info?.volume ?? "");
    store.setMarks(mergedMarks(state.marks, marks, file.name));
  }
}
