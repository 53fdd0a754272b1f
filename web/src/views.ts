import type { Actions } from "./actions";
import type { Fail, Host } from "./host";
import { BrowserPlace, Keeper, volumeOf } from "./model/keeper";
import { textOf } from "./model/kept_file";
import { formatLink, type Link } from "./model/link";
import {
  formatTour,
  kMostStops,
  kTourFile,
  makeStop,
  parseTour,
  type Stop,
  withChange,
  withStop,
} from "./model/tour";
import type { ViewerStore } from "./model/viewer_state";
import { texts } from "./text/text";
import { TourPlayer } from "./tour_player";
import { download } from "./ui/download";
import { LookVeil } from "./ui/look_veil";
import type { ViewsDesk } from "./ui/views_panel";
import type { Viewer } from "./viewer";

/** The views that are saved of a volume: where they are kept, and the tour of them. */
export class Views implements ViewsDesk {
  readonly player: TourPlayer;
  /** Over the canvas, while a tour goes from look to look. */
  readonly veil: LookVeil;
  readonly #viewer: Viewer;
  readonly #host: Host;
  readonly #link: () => Link;
  readonly #fail: Fail;
  readonly #keeper = new Keeper(kTourFile);
  #waking = 0;

  /** `link` says what is shown, `fail` what went wrong, and offers to do it again. */
  constructor(viewer: Viewer, actions: Actions, host: Host, link: () => Link, fail: Fail) {
    this.#viewer = viewer;
    this.#host = host;
    this.#link = link;
    this.#fail = fail;
    const veil = (this.veil = new LookVeil(viewer));
    this.player = new TourPlayer({
      store: viewer.store,
      get caseName() {
        return viewer.caseName;
      },
      get window() {
        return viewer.window;
      },
      openLook: (name) => {
        veil.expect();
        return host.openLook(name);
      },
      expectLook: (name) => host.expectLook(name),
      get isVeiled() {
        return veil.isUp;
      },
      veil: (share) => veil.set(share),
      isStill: () => matchMedia("(prefers-reduced-motion: reduce)").matches,
      takeHold: (holder) => actions.takeHold(holder),
      letGo: (holder) => actions.letGo(holder),
      wake: () => (this.#waking ||= requestAnimationFrame(() => this.tick())),
    });
  }

  get store(): ViewerStore {
    return this.#viewer.store;
  }

  get trouble(): ViewsDesk["trouble"] {
    return this.#keeper.trouble;
  }

  /** Before a frame. */
  tick(): void {
    cancelAnimationFrame(this.#waking);
    this.#waking = 0;
    this.player.tick(performance.now());
  }

  /** Those of the case of this name, which is shown now, in place of those before; of a person's own file, in this browser. */
  async bring(name: string, isOwn = false): Promise<void> {
    this.player.leave();
    const { volume } = this.#viewer.info!;
    const place =
      (!isOwn && this.#host.tourPlace?.(name, volume)) || new BrowserPlace(kTourFile, volume, name);
    const stops = await this.#keeper.open(place, volumeOf(this.#viewer));
    this.#keeper.adopt(stops);
    this.store.setStops(stops);
  }

  /** After every change of the viewer's state. */
  observe(): void {
    this.#keeper.observe(this.store.state.stops, volumeOf(this.#viewer));
  }

  /** Saves what is shown, after the view that is shown or else at the end; null where there are too many. */
  save(name = texts().views.first(this.player.stops.length + 1), text = ""): Stop | null {
    if (!this.#viewer.info) {
      return null;
    }
    const stop = makeStop(this.#words, name, text);
    const stops = withStop(this.player.stops, stop, this.player.stop.peek()?.id);
    if (!stops) {
      this.#fail(texts().views.tooMany(kMostStops), () => this.save(name, text));
      return null;
    }
    this.store.setStops(stops);
    return stop;
  }

  update(id: string): void {
    this.store.setStops(withChange(this.player.stops, id, { show: this.#words }));
  }

  saveFile(): void {
    const { caseName, info } = this.#viewer;
    const text = formatTour(this.player.stops, info?.volume ?? "");
    download(new Blob([text], { type: "application/json" }), `${caseName ?? "case"}.tour.json`);
  }

  openFile(file: File): void {
    void this.#open(file).catch((error: Error) => this.#fail(error.message, () => this.openFile(file)));
  }

  /** What is to be kept is kept at once. */
  flush(): void {
    this.#keeper.flush();
  }

  dispose(): void {
    this.player.leave();
    cancelAnimationFrame(this.#waking);
    this.flush();
  }

  /** A file's views come in place of those that are there; undo brings these back. */
  async #open(file: File): Promise<void> {
    const stops = parseTour(await textOf(file), file.name, this.#viewer.info?.volume ?? "");
    this.player.leave();
    this.store.setStops(stops);
  }

  /** What is shown, in the words of an address. */
  get #words(): string {
    return formatLink({ ...this.#link(), beside: undefined }).slice(1);
  }
}
