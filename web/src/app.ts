import { effect, untracked } from "@preact/signals-core";

import { Actions } from "./actions";
import type { Surroundings } from "./api";
import type { Fail, Host } from "./host";
import { KeptMarks } from "./kept_marks";
import { kBackdrops } from "./model/backdrop";
import { Follower } from "./model/follower";
import type { Link } from "./model/link";
import { linkedState, linkTo } from "./model/linked_state";
import { Marking } from "./model/marking";
import { makeMark } from "./model/marks";
import { shownMarks } from "./model/viewer_state";
import { Opening } from "./opening";
import type { CaseError } from "./sog/zip";
import type { StudyGuide } from "./study/guide";
import { texts } from "./text/text";
import { Announcer } from "./ui/announcer";
import { type BesideCase, BesidePart } from "./ui/beside";
import { follow, h, owned } from "./ui/dom";
import { FaceOverlay } from "./ui/face_overlay";
import { firstHint } from "./ui/first_hint";
import { frameCase } from "./ui/framing";
import { FullScreen } from "./ui/full_screen";
import { helpDialog } from "./ui/help";
import { LoadingCard } from "./ui/loading_card";
import { MarksOverlay } from "./ui/marks_overlay";
import { markCard, marksPanel } from "./ui/marks_panel";
import { Message } from "./ui/message";
import { dropZone, isTour, isVolume } from "./ui/open_file";
import { OrientationCube } from "./ui/orientation_cube";
import { pictureDialog } from "./ui/picture_dialog";
import { Pictures } from "./ui/pictures";
import { PointerControls } from "./ui/pointer";
import { Shortcuts } from "./ui/shortcuts";
import { level, sidePanel } from "./ui/side_panel";
import { slicesButton, SlicesPart } from "./ui/slices";
import { Statistics } from "./ui/statistics";
import { type Theme, ViewerTheme } from "./ui/theme";
import { themeButton, TopBar } from "./ui/top_bar";
import { tourCaption } from "./ui/tour_caption";
import { viewsPanel } from "./ui/views_panel";
import { Viewer } from "./viewer";
import { Views } from "./views";
import { CaseClient } from "./worker/case_client";
import { Headset } from "./xr/headset";

/** The viewer's canvas and the panels around it. */
export class App {
  readonly root: HTMLElement;
  readonly host: Host;
  readonly viewer: Viewer;
  readonly headset: Headset;
  readonly actions: Actions;
  /** What is seen while a case is on its way. */
  readonly loading: LoadingCard;
  readonly opening: Opening;
  readonly marking = new Marking(
    (shape) => this.viewer.hasValues(shape) && this.viewer.store.addMark(makeMark(shape)),
  );
  readonly marks: KeptMarks;
  readonly views: Views;
  readonly pictures: Pictures;
  readonly bar: TopBar;
  readonly message: Message;
  readonly #panel: HTMLElement;
  readonly #face: FaceOverlay;
  readonly #slices: SlicesPart;
  readonly #beside: BesidePart;
  readonly #follower = new Follower(); // of the page, which nobody looks at while a headset is worn
  readonly #cube: OrientationCube;
  readonly #announcer: Announcer;
  readonly #statistics: Statistics;
  readonly #news = h("output", { class: "news", "aria-label": texts().page.quality, hidden: true });
  readonly #theme = new ViewerTheme();
  readonly #ended = new AbortController();
  readonly #resized = new ResizeObserver(() => this.frame());
  // In the next frame: what follows changes what is observed, which a browser calls an error within the same one.
  readonly #freed = new ResizeObserver(() =>
    requestAnimationFrame(() => this.#ended.signal.aborted || this.frame()),
  );
  #pictureOnly = false;
  readonly #unfollow: () => void;
  readonly #endParts: () => void;
  #guide: StudyGuide | null = null;

  /** Throws CaseError where the browser cannot draw. */
  constructor(root: HTMLElement, host: Host, client = new CaseClient(), loading = new LoadingCard()) {
    this.root = root;
    this.host = host;
    this.loading = loading;
    const { signal } = this.#ended;
    const canvas = h("canvas", { class: "stage", tabindex: "0", "aria-label": texts().page.canvas });
    root.classList.add("viewer");
    root.append(canvas);
    this.message = new Message(host);
    const fail: Fail = (text, again) => this.message.say(text, again);
    const viewer = (this.viewer = new Viewer(canvas, client));
    const actions = (this.actions = new Actions(viewer));
    this.marks = new KeptMarks(viewer, host, fail);
    this.views = new Views(viewer, actions, host, () => this.link, fail);
    this.headset = new Headset(viewer, actions, this.marking, this.views.player, this.message, host);
    this.headset.changed = () => {
      this.#guide?.observe();
      this.update();
    };
    const { live } = this.#follower;
    const help = helpDialog();
    const fullScreen = new FullScreen(root);
    const takesWheel = () => host.takesWheel();
    this.#beside = new BesidePart(viewer, actions, takesWheel, () => {
      this.frame();
      host.changed();
    });
    const [parts, endParts] = owned(() => {
      follow(() => root.classList.toggle("expert", level.value === "expert"));
      follow(() => this.#showTheme());
      const marks = new MarksOverlay(viewer, this.marking, live);
      const { chosen, texts: said } = marks;
      const pictures = new Pictures(viewer, root, said, fail);
      const sizes = pictureDialog(viewer, (wanted) => pictures.saveAs(wanted));
      const listed = marksPanel(viewer, this.marking, live, chosen, said, this.marks, this.marks.trouble);
      const saved = viewsPanel(this.views, live, () => sizes.show());
      const rest = [fullScreen.button("narrow"), themeButton(this.#theme, "narrow")];
      const context = { viewer, actions, marking: this.marking, marks, live };
      return {
        marks,
        pictures,
        sizes,
        slices: new SlicesPart(context, (why) => fail(why, () => actions.toggleSlices())),
        panel: sidePanel(viewer, actions, live, listed, saved, rest),
        caption: tourCaption(this.views.player),
        card: markCard(viewer, live, chosen, said),
        bar: new TopBar({
          host,
          theme: this.#theme,
          slices: slicesButton(viewer, actions, live, "wide"),
          fullScreen: fullScreen.button("wide"),
          enterHeadset: (surroundings) => void this.enterHeadset(surroundings),
          prepareHeadset: () => void this.headset.prepare().catch(() => {}), // it is told of when it is entered
          savePicture: () => void pictures.save(),
          showHelp: () => help.showModal(),
          fail,
        }),
      };
    });
    this.#endParts = endParts;
    const { marks, pictures, sizes, slices, panel, bar } = parts;
    this.pictures = pictures;
    this.#slices = slices;
    this.#panel = panel;
    this.bar = bar;
    this.#face = new FaceOverlay(viewer);
    this.#cube = new OrientationCube((azimuth, elevation) => viewer.store.setView({ azimuth, elevation }));
    this.#announcer = new Announcer(viewer, actions);
    this.#statistics = new Statistics(viewer);
    this.opening = new Opening(this);
    const warning = h("strong", { class: "warning" }, texts().notForDiagnosis);
    root.append(
      this.views.veil.element,
      this.#face.element,
      firstHint(root),
      marks.element,
      this.#beside.element,
      slices.element,
      parts.card,
      parts.caption,
      bar.element,
      panel,
      this.#cube.element,
      h("footer", {}, warning, this.#news, this.#statistics.element),
      loading.element,
      this.message.element,
      dropZone(root, (files) => void this.#openDropped(files), fail, signal),
      help,
      sizes.element,
      this.#announcer.element,
    );
    viewer.drawnFrame = () => {
      this.#face.update();
      marks.update();
      slices.update();
      this.#statistics.update();
    };
    new PointerControls(viewer, (mm) => actions.step(mm), takesWheel);
    const shortcuts = new Shortcuts({
      root,
      host,
      viewer,
      actions,
      marking: this.marking,
      marks,
      views: this.views,
      pictures,
      theme: this.#theme,
      fullScreen,
      bar,
      areOff: () => this.isInStudy,
      toggleBeside: () => (this.besideName ? void this.showBeside(null) : host.chooseBeside?.()),
      dismissMessage: () => this.message.dismiss(),
      showPictureSizes: () => sizes.show(),
      showHelp: () => help.showModal(),
    });
    host.keys.addEventListener("keydown", (event) => shortcuts.press(event as KeyboardEvent), { signal });
    this.#listen();
    this.#unfollow = effect(() => {
      void viewer.version;
      untracked(() => this.#follow());
    });
  }

  #listen(): void {
    const { signal } = this.#ended;
    const captured = { capture: true, signal };
    this.root.addEventListener("pointerdown", ({ pointerId }) => this.actions.takeHold(pointerId), captured);
    for (const type of ["pointerup", "pointercancel"] as const) {
      window.addEventListener(type, ({ pointerId }) => this.actions.letGo(pointerId), captured);
    }
    addEventListener("pagehide", () => this.marks.flush(), { signal });
    addEventListener("pagehide", () => this.views.flush(), { signal });
    this.#resized.observe(this.viewer.canvas);
    this.#resized.observe(this.#panel);
    this.#freed.observe(this.#slices.free);
    navigator.xr?.addEventListener("devicechange", () => void this.bar.offerHeadset(), { signal });
    void this.bar.offerHeadset();
  }

  /** Ends everything that would go on without the page's elements, and removes these. */
  dispose(): void {
    this.opening.dispose();
    this.#ended.abort();
    this.marks.flush();
    this.views.dispose();
    this.#guide?.dispose();
    this.#beside.dispose();
    this.#resized.disconnect();
    this.#freed.disconnect();
    this.#statistics.dispose();
    this.#announcer.dispose();
    this.#unfollow();
    this.#endParts();
    this.viewer.drawnFrame = this.viewer.failed = this.headset.changed = () => {};
    this.headset.dispose();
    this.viewer.dispose();
    this.root.replaceChildren();
  }

  /** Shows a case in a headset; says so here where that fails. */
  async enterHeadset(surroundings: Surroundings): Promise<void> {
    this.message.dismiss();
    try {
      await this.headset.enter(surroundings);
    } catch (error) {
      this.message.say((error as CaseError).message, () => void this.enterHeadset(surroundings));
    }
  }

  /** Shows a file of the person's own: a case, splats, or marks or views of what is shown. Says so here where that fails. */
  async openFile(file: File): Promise<void> {
    if (this.isInStudy) {
      return;
    }
    if (file.size === 0) {
      this.message.say(texts().files.empty(file.name), null);
    } else if (await isVolume(file).catch(() => false)) {
      this.message.say(texts().files.volume(file.name), null);
    } else if (!/\.json$/i.test(file.name)) {
      await this.host.openFile(file).catch(() => {});
    } else if (await isTour(file).catch(() => false)) {
      this.views.openFile(file);
    } else {
      this.marks.open(file);
    }
  }

  /** A case first, then what is marked in it; nothing more where one of them fails. */
  async #openDropped(files: readonly File[]): Promise<void> {
    this.message.dismiss();
    for (const file of files) {
      if (!this.message.isSaid) {
        await this.openFile(file);
      }
    }
  }

  /** Shows another case beside this one, seen and cut alike; null: none. Returns why it fails, which is said; "": it does not. */
  async showBeside(one: BesideCase | null): Promise<string> {
    try {
      await this.#beside.show(one);
      return "";
    } catch (error) {
      const { message } = error as Error;
      this.message.say(message, () => void this.showBeside(one));
      return message;
    }
  }

  /** Of the case beside this one; null: none. */
  get besideName(): string | null {
    return this.#beside.name;
  }

  /** Says, beside the picture, what the case is and when there will be a better one. */
  tell(news: string): void {
    if (this.news !== news) {
      this.#news.textContent = news;
      this.#news.hidden = news === "";
      this.headset.refresh();
    }
  }

  get news(): string {
    return this.#news.textContent;
  }

  /** What the looks of the volume are, or which is shown, may be another. */
  offerLooks(): void {
    const shown = this.host.looks().find((look) => look.case.name === this.viewer.caseName);
    this.bar.showLook(shown?.name ?? null);
    this.headset.refresh();
  }

  /** Takes over what a link says of the case that is open. */
  follow(link: Link): void {
    const { store } = this.viewer;
    const { marks } = link;
    if (marks) {
      this.marks.adopt(marks);
    }
    store.restore({
      ...linkedState(link, store.state, store.states),
      ...(marks && { marks, tourMarks: null }),
    });
    store.showSlices(link.slices?.shown ?? null, link.slices);
    this.actions.forget();
    this.update();
  }

  /** What is shown. */
  get link(): Link {
    const { caseName, state, store } = this.viewer;
    const link = linkTo(caseName ?? undefined, state, store.planeState, shownMarks(state));
    return { ...link, beside: this.besideName ?? undefined };
  }

  /** A fixed size leaves the picture alone, on black. */
  setSize(size: { width: number; height: number } | undefined): void {
    this.#pictureOnly = size !== undefined;
    this.root.classList.toggle("picture-only", this.#pictureOnly);
    this.viewer.canvas.style.width = size ? `${size.width}px` : "";
    this.viewer.canvas.style.height = size ? `${size.height}px` : "";
    this.#showTheme();
    this.frame();
  }

  /** Whether the panel is there. */
  setPanel(shown: boolean): void {
    this.root.classList.toggle("no-panel", !shown);
    this.frame();
  }

  /** "auto": as the user or the system wants it. */
  setTheme(theme: Theme): void {
    this.#theme.fix(theme);
  }

  /** Leads people through a study. */
  lead(guide: StudyGuide): void {
    this.#guide = guide;
    guide.begin();
  }

  /** Whether people are led through a study. */
  get isInStudy(): boolean {
    return this.#guide !== null;
  }

  /** Frames the case in what is left free of the page. */
  frame(): void {
    frameCase(this.viewer, {
      root: this.root,
      panel: this.#panel,
      free: this.#slices.free,
      beside: this.#beside,
      card: () => this.#guide?.cardAside ?? null,
    });
  }

  /** Shows what is shown now. Nobody looks at the page while a headset is worn. */
  update(): void {
    if (this.headset.worn) {
      this.headset.refresh();
      return;
    }
    this.#follower.refresh();
    this.#cube.update(this.viewer.state.view);
    this.#beside.update();
    this.#announcer.update();
    this.host.changed();
  }

  /** The viewer shows something else, or can. */
  #follow(): void {
    this.actions.observe();
    if (this.#guide) {
      this.#guide.observe();
    } else {
      this.marks.observe();
      this.views.observe();
    }
    this.update();
  }

  #showTheme(): void {
    const theme = this.#theme.shown.value;
    this.viewer.setGlow(this.#pictureOnly ? null : theme);
    this.#beside.update();
    // Text and panels are those that are read on what lies behind the case.
    const backdrop = kBackdrops.get(this.viewer.state.backdrop ?? "");
    this.root.classList.toggle("light", backdrop?.isBright ?? theme === "light");
  }
}
