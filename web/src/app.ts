import { computed, effect, untracked } from "@preact/signals-core";

import { Actions } from "./actions";
import type { Surroundings } from "./api";
import { kBackdrops } from "./model/backdrop";
import { isSameVolume } from "./model/case_info";
import { type CaseSummary, failureText, formatBytes, formatCount, type LoadingCase } from "./model/case_list";
import type { Link } from "./model/link";
import { linkedState, linkTo } from "./model/linked_state";
import type { Look } from "./model/looks";
import { Follower } from "./model/follower";
import { BrowserPlace, Keeper, type Place } from "./model/keeper";
import { Marking } from "./model/marking";
import { makeMark, type Mark } from "./model/marks";
import { formatMarks, kMarksFile, mergedMarks, parseMarks } from "./model/marks_file";
import type { Stop } from "./model/tour";
import { shownMarks } from "./model/viewer_state";
import { CaseError } from "./sog/zip";
import { texts } from "./text/text";
import type { Study } from "./study/study";
import { Announcer } from "./ui/announcer";
import { type BesideCase, BesidePart } from "./ui/beside";
import { follow, h, icon, kIcons, owned } from "./ui/dom";
import { FaceOverlay } from "./ui/face_overlay";
import { FullScreen } from "./ui/full_screen";
import { firstHint } from "./ui/first_hint";
import { helpDialog } from "./ui/help";
import { download } from "./ui/download";
import { LoadingCard } from "./ui/loading_card";
import { MarksOverlay } from "./ui/marks_overlay";
import { markCard, marksPanel } from "./ui/marks_panel";
import { dropZone } from "./ui/open_file";
import { OrientationCube } from "./ui/orientation_cube";
import { PointerControls } from "./ui/pointer";
import type { StudyCard } from "./ui/study_card";
import { pictureDialog } from "./ui/picture_dialog";
import { pictureOf, savePicture, type WantedPicture } from "./ui/save_picture";
import { level, sidePanel } from "./ui/side_panel";
import { slicesButton, SlicesPart } from "./ui/slices";
import { type Theme, ViewerTheme } from "./ui/theme";
import { tourCaption } from "./ui/tour_caption";
import { ViewKeys } from "./ui/view_keys";
import { type OpeningListener, Viewer } from "./viewer";
import { viewsPanel } from "./ui/views_panel";
import { Views, volumeOf } from "./views";
import { CaseClient } from "./worker/case_client";
import type { CaseSource } from "./worker/protocol";
import { Headset, offeredSurroundings } from "./xr/headset";

/** Fields that keys are typed into. */
const kTypedInto: readonly string[] = ["number", "text", "search"];
const kStatsIntervalMs = 250;
/** What a viewer stands in: the page of `clipgs serve`, or an element of another page. */
export interface Host {
  /** Whose keys are the viewer's. */
  readonly keys: EventTarget;
  /** Whether a wheel over the case is the viewer's, or scrolls what is around. */
  takesWheel(): boolean;
  /** What is shown has changed. */
  changed(): void;
  /** What can be opened. */
  cases(): Promise<CaseSummary[]>;
  /** Of the volume that is shown, as far as is known; none where it has one alone. */
  looks(): readonly Look[];
  open(name: string): Promise<void>;
  /** Shows a file of the person's own, which is not sent anywhere. */
  openFile(file: File): Promise<void>;
  /** Lets a person choose a case; absent where there is no choice. */
  choose?(): void;
  /** Lets a person choose a case to be beside this one; absent where there is no choice. */
  chooseBeside?(): void;
  /** Lets a person choose another look of the volume, where there are several. */
  chooseLook?(): void;
  /** What the case is where it is not finished, and when there will be a better one; "": it is. */
  news?(): string;
  /** Where marks of a case are kept, of a volume or, where that is not known, ""; absent: in the browser. */
  marksPlace?(name: string, volume: string): Promise<Place<Mark>>;
  /** The same of the tour. */
  tourPlace?(name: string, volume: string): Promise<Place<Stop>>;
  /** Shows another look of the volume, by the name of its case. Rejects with a line that says why it cannot be had. */
  openLook(name: string): Promise<void>;
  /** Fetches another look, which may be shown next. */
  expectLook(name: string): void;
  /** A link to what is shown, null where it is nobody else's; absent where no address says it. */
  address?(): string | null;
}

/** What is opened; more of it may be known before it is there. */
export type OpenedCase = Pick<CaseSummary, "name" | "error"> & { file: CaseSource } & Partial<
    Pick<CaseSummary, "title" | "thumbnail" | "bytes">
  >;

/** The viewer's canvas and the panels around it. */
export class App {
  readonly host: Host;
  readonly viewer: Viewer;
  readonly headset: Headset;
  readonly actions: Actions;
  /** What is seen while a case is on its way. */
  readonly loading: LoadingCard;
  readonly marking = new Marking(
    (shape) => this.viewer.hasValues(shape) && this.viewer.store.addMark(makeMark(shape)),
  );
  readonly #root: HTMLElement;
  readonly #panel: HTMLElement;
  readonly #picture: ReturnType<typeof pictureDialog>;
  readonly #overlay: FaceOverlay;
  readonly #marks: MarksOverlay;
  readonly #slices: SlicesPart;
  readonly #beside: BesidePart;
  readonly #keeper = new Keeper(kMarksFile);
  readonly views: Views;
  readonly #keys: ViewKeys;
  readonly #follower = new Follower(); // of the page, which nobody looks at while a headset is worn
  readonly #cube: OrientationCube;
  readonly #announcer: Announcer;
  readonly #help = helpDialog();
  readonly #title = h("span", { class: "title" }, texts().page.loading);
  readonly #lookName = h("span", { class: "look-name" });
  readonly #lookButton = h(
    "button",
    {
      class: "look-button",
      title: texts().page.looks,
      hidden: true,
      onclick: () => this.host.chooseLook?.(),
    },
    icon(kIcons.looks),
    this.#lookName,
  );
  readonly #stats = h("output", {
    class: "stats",
    "aria-label": texts().page.statistics,
    "aria-live": "off",
  });
  readonly #news = h("output", { class: "news", "aria-label": texts().page.quality, hidden: true });
  readonly #message = h("div", { class: "message", role: "alert", hidden: true });
  readonly #headsetButtons = h("span", { class: "group" });
  readonly #fullScreen: FullScreen;
  readonly #theme = new ViewerTheme();
  readonly #ended = new AbortController();
  readonly #resized = new ResizeObserver(() => this.#resize());
  #opening = 0;
  #again = (): void => {}; // opens the case that was asked for last
  #statsTimer = 0;
  #pictureOnly = false;
  readonly #unfollow: () => void;
  readonly #endParts: () => void;
  #study: Study | null = null;
  #card: StudyCard | null = null;

  /** Throws CaseError where the browser cannot draw. */
  constructor(root: HTMLElement, host: Host, client = new CaseClient(), loading = new LoadingCard()) {
    this.#root = root;
    this.host = host;
    this.loading = loading;
    const { signal } = this.#ended;
    const canvas = h("canvas", {
      class: "stage",
      tabindex: "0",
      "aria-label": texts().page.canvas,
    });
    root.classList.add("viewer");
    root.append(canvas);
    this.viewer = new Viewer(canvas, client);
    this.actions = new Actions(this.viewer);
    this.#keys = new ViewKeys(this.viewer);
    this.views = new Views(
      this.viewer,
      this.actions,
      host,
      () => this.link,
      (text, again) => this.fail(text, again),
    );
    this.headset = new Headset(this.viewer, this.actions, this.marking, this.views.player, host);
    this.headset.changed = () => {
      this.#study?.observe();
      this.#update();
    };
    this.#overlay = new FaceOverlay(this.viewer);
    const { live } = this.#follower;
    const [parts, endParts] = owned(() => {
      follow(() => root.classList.toggle("expert", level.value === "expert"));
      follow(() => this.#showTheme());
      const marks = new MarksOverlay(this.viewer, this.marking, live);
      const { chosen, texts: said } = marks;
      const files = { save: () => this.#saveMarks(), open: (file: File) => void this.#openMarks(file) };
      const listed = marksPanel(this.viewer, this.marking, live, chosen, said, files, this.#keeper.trouble);
      const context = { viewer: this.viewer, actions: this.actions, marking: this.marking, marks, live };
      const slices = new SlicesPart(context, (why) => this.fail(why, () => this.actions.toggleSlices()));
      return {
        marks,
        slices,
        slicesButton: slicesButton(this.viewer, this.actions, live, "wide"),
        panel: sidePanel(
          this.viewer,
          this.actions,
          live,
          listed,
          viewsPanel(this.views, live, () => this.#picture.show()),
        ),
        caption: tourCaption(this.views.player),
        picture: pictureDialog(this.viewer, (wanted) => this.#savePictureAs(wanted)),
        card: markCard(this.viewer, live, chosen, said),
        theme: this.#themeChoice(),
      };
    });
    this.#panel = parts.panel;
    this.#picture = parts.picture;
    this.#marks = parts.marks;
    this.#slices = parts.slices;
    const takesWheel = () => host.takesWheel();
    this.#beside = new BesidePart(this.viewer, this.actions, takesWheel, () => {
      this.#resize();
      host.changed();
    });
    this.#endParts = endParts;
    this.#cube = new OrientationCube((azimuth, elevation) =>
      this.viewer.store.setView({ azimuth, elevation }),
    );
    this.#announcer = new Announcer(this.viewer, this.actions);
    this.#fullScreen = new FullScreen(root);
    root.append(
      this.views.veil.element,
      this.#overlay.element,
      firstHint(root),
      this.#marks.element,
      this.#beside.element,
      parts.slices.element,
      parts.card,
      parts.caption,
      h(
        "header",
        { class: "bar", part: "bar" },
        this.#caseTitle(),
        this.#lookButton,
        this.#buttons(parts.theme, parts.slicesButton),
      ),
      this.#panel,
      this.#cube.element,
      h("footer", {}, h("strong", { class: "warning" }, texts().notForDiagnosis), this.#news, this.#stats),
      this.loading.element,
      this.#message,
      dropZone(root, (file) => void this.openFile(file), signal),
      this.#help,
      this.#picture.element,
      this.#announcer.element,
    );
    new PointerControls(this.viewer, (mm) => this.actions.step(mm), takesWheel);
    this.viewer.failed = (error) => {
      this.endLoading();
      this.offerLooks();
      this.fail(error.message, this.#again);
      this.headset.panel?.tell(error.message);
    };
    this.viewer.drawnFrame = () => {
      this.#overlay.update();
      this.#marks.update();
      this.#slices.update();
      this.#statsTimer ||= window.setTimeout(() => this.#updateStats(), kStatsIntervalMs);
    };
    const captured = { capture: true, signal };
    root.addEventListener("pointerdown", ({ pointerId }) => this.actions.takeHold(pointerId), captured);
    for (const type of ["pointerup", "pointercancel"] as const) {
      window.addEventListener(type, ({ pointerId }) => this.actions.letGo(pointerId), captured);
    }
    addEventListener("pagehide", () => this.#keeper.flush(), { signal });
    addEventListener("pagehide", () => this.views.flush(), { signal });
    this.#resized.observe(canvas);
    this.#resized.observe(this.#panel);
    this.#resized.observe(this.#slices.free);
    host.keys.addEventListener("keydown", (event) => this.#key(event as KeyboardEvent), { signal });
    navigator.xr?.addEventListener("devicechange", () => void this.#offerHeadset(), { signal });
    void this.#offerHeadset();
    this.#unfollow = effect(() => {
      void this.viewer.version;
      untracked(() => this.#follow());
    });
  }

  /** Ends everything that would go on without the page's elements, and removes these. */
  dispose(): void {
    ++this.#opening;
    this.#ended.abort();
    this.#keeper.flush();
    this.views.dispose();
    this.#study?.dispose();
    this.#beside.dispose();
    this.#resized.disconnect();
    clearTimeout(this.#statsTimer);
    this.#announcer.dispose();
    this.#unfollow();
    this.#endParts();
    this.viewer.drawnFrame = this.viewer.failed = this.headset.changed = () => {};
    this.headset.dispose();
    this.viewer.dispose();
    this.#root.replaceChildren();
  }

  /** Shows a case in a headset; says so here where that fails. */
  async enterHeadset(surroundings: Surroundings): Promise<void> {
    try {
      await this.headset.enter(surroundings);
    } catch (error) {
      this.fail((error as CaseError).message, () => void this.enterHeadset(surroundings));
    }
  }

  /**
   * Shows a case, in the view and cut that there are; the first one as it starts, unless `link` says more. Rejects with
   * CaseError, after saying so here and offering to do it `again`.
   */
  async open({ name, file, error, ...said }: OpenedCase, link: Link, again: () => void): Promise<void> {
    const opening = ++this.#opening;
    this.#again = again;
    this.#message.hidden = true;
    this.loading.begin(file, this.viewer.caseName !== null);
    const coming = {
      title: said.title ?? name,
      thumbnail: said.thumbnail ?? null,
      bytes: said.bytes ?? 0,
    };
    this.loading.name({ file, ...coming });
    this.headset.loading.value = { ...coming, share: 0 };
    try {
      if (error) {
        throw new CaseError(error);
      }
      const before = this.viewer.info;
      await this.viewer.open(name, file, this.#listener(coming, opening), () => {
        this.#title.textContent = this.title;
        if (before === null) {
          this.#begin(link);
        }
      });
      if (!isSameVolume(before, this.viewer.info!)) {
        const isOwn = file instanceof File;
        await Promise.all([this.#bringMarks(name, isOwn), this.views.bring(name, isOwn)]);
        this.actions.forget();
      }
    } catch (error) {
      if (opening === this.#opening) {
        this.endLoading();
        this.offerLooks();
        this.#update();
        this.fail(failureText(name, error), again);
      }
      throw error;
    } finally {
      if (opening === this.#opening) {
        this.loading.end();
        this.headset.loading.value = null;
      }
    }
    this.#title.textContent = this.title;
    this.offerLooks();
    this.#tellOfScale();
    this.#update();
    const { sectionProblem } = this.viewer;
    if (sectionProblem) {
      this.fail(sectionProblem, again);
      this.headset.panel?.tell(sectionProblem);
    }
  }

  /** Shows a file of the person's own: a case, splats, or marks of what is shown. Says so here where that fails. */
  async openFile(file: File): Promise<void> {
    if (this.isInStudy) {
      return;
    }
    if (/\.json$/i.test(file.name)) {
      await this.#openMarks(file);
    } else {
      await this.host.openFile(file).catch(() => {});
    }
  }

  /** What is not known of files of other programs. */
  #tellOfScale(): void {
    const { noScale } = texts().files;
    if (!this.viewer.hasWorld) {
      this.tell(noScale);
    } else if (this.news === noScale) {
      this.tell("");
    }
  }

  /** Puts a newer version of the case that is shown in its place; that stays where this fails. */
  async renew({ name, file }: Pick<CaseSummary, "name" | "file">): Promise<void> {
    try {
      if (await this.viewer.renew(file)) {
        this.#title.textContent = this.title;
        this.offerLooks();
        this.#update();
      }
    } catch (error) {
      console.warn(failureText(name, error));
    }
  }

  /** What is heard of a case on its way is said here, and in a headset. */
  #listener(coming: Omit<LoadingCase, "share">, opening: number): OpeningListener {
    const { loading, headset } = this;
    return {
      cover: (cover) => loading.cover(cover),
      pictured: () => loading.pictured(),
      progress: (loaded, total) => {
        loading.progress(loaded, total);
        const bytes = total || coming.bytes;
        if (opening === this.#opening) {
          headset.loading.value = { ...coming, bytes, share: bytes > 0 ? Math.min(1, loaded / bytes) : 0 };
        }
      },
    };
  }

  /** Nothing is on its way. */
  endLoading(): void {
    this.loading.end();
    this.#title.textContent = this.title || texts().page.noCase;
  }

  /** Shows another case beside this one, seen and cut alike; null: none. Says so where that fails. */
  async showBeside(one: BesideCase | null): Promise<void> {
    try {
      await this.#beside.show(one);
    } catch (error) {
      this.fail((error as Error).message, () => void this.showBeside(one));
    }
  }

  /** Of the case beside this one; null: none. */
  get besideName(): string | null {
    return this.#beside.name;
  }

  /** Says, beside the picture, what the case is and when there will be a better one. */
  tell(news: string): void {
    if (this.#news.textContent !== news) {
      this.#news.textContent = news;
      this.#news.hidden = news === "";
      this.headset.refresh();
    }
  }

  get news(): string {
    return this.#news.textContent;
  }

  /** Whether people are led through a study. */
  get isInStudy(): boolean {
    return this.#study !== null;
  }

  /** What the looks of the volume are, or which is shown, may be another. */
  offerLooks(): void {
    const shown = this.host.looks().find((look) => look.case.name === this.viewer.caseName);
    this.#lookButton.hidden = !shown;
    this.#lookName.textContent = shown?.name ?? "";
    this.#lookButton.ariaLabel = texts().page.look(this.#lookName.textContent);
    this.headset.refresh();
  }

  /** How the first case is shown at first. */
  #begin(link: Link): void {
    if (!link.view) {
      this.actions.reset();
    }
    this.follow(link);
  }

  /** Of the case that is shown. */
  get title(): string {
    return this.viewer.info?.title || (this.viewer.caseName ?? "");
  }

  /** Takes over what a link says of the case that is open. */
  follow(link: Link): void {
    const { store } = this.viewer;
    const { marks } = link;
    if (marks) {
      this.#keeper.adopt(marks);
    }
    store.restore({
      ...linkedState(link, store.state, store.states),
      ...(marks && { marks, tourMarks: null }),
    });
    store.showSlices(link.slices?.shown ?? null, link.slices);
    this.actions.forget();
    this.#update();
  }

  /** What was marked of it before, unless a link says what is; of a person's own file, in this browser alone. */
  async #bringMarks(name: string, isOwn: boolean): Promise<void> {
    const { store } = this.viewer;
    const { volume } = this.viewer.info!;
    const inBrowser = () => Promise.resolve(new BrowserPlace(kMarksFile, volume, name));
    const place = (!isOwn && this.host.marksPlace?.(name, volume)) || inBrowser();
    const kept = await this.#keeper.open(place, this.#marksOf);
    const marks = store.state.marks.length > 0 ? store.state.marks : kept;
    this.#keeper.adopt(marks);
    store.setMarks(marks);
  }

  /** Whose marks are shown. */
  get #marksOf(): string {
    return volumeOf(this.viewer);
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
    this.#root.classList.toggle("picture-only", this.#pictureOnly);
    this.viewer.canvas.style.width = size ? `${size.width}px` : "";
    this.viewer.canvas.style.height = size ? `${size.height}px` : "";
    this.#showTheme();
    this.#resize();
  }

  /** Whether the panel is there. */
  setPanel(shown: boolean): void {
    this.#root.classList.toggle("no-panel", !shown);
    this.#resize();
  }

  /** Leads people through a study: nothing else is there to be used. */
  setStudy(study: Study, card: StudyCard): void {
    this.#study = this.headset.study = study;
    this.#card = card;
    study.changed = () => (this.headset.worn ? this.headset.refresh() : this.#showCard(study, card));
    this.#root.classList.add("in-study");
    for (const part of this.#root.querySelectorAll<HTMLElement>(".bar, .mark-layer")) {
      part.inert = true; // neither the case nor a mark is to be changed
    }
    this.#root.append(card.element);
    this.headset.framed = (time, head, forward) => {
      study.measures?.frames.count(time);
      study.measures?.head(head, forward);
      study.measures?.holds(this.headset.stage.grip.holding !== null);
    };
    this.#countFrames(study);
    study.changed();
    this.#resize();
  }

  /** "auto": as the user or the system wants it. */
  setTheme(theme: Theme): void {
    this.#theme.fix(theme);
  }

  /** Says what went wrong, in a line, and offers what can be done. */
  fail(text: string, again: (() => void) | null): void {
    const { host } = this;
    this.#message.replaceChildren(
      h(
        "button",
        {
          class: "plain dismiss",
          "aria-label": texts().page.dismiss,
          onclick: () => this.dismiss(),
        },
        icon(kIcons.close),
      ),
      icon(kIcons.warning),
      h("p", {}, text),
      h(
        "div",
        { class: "row" },
        host.choose
          ? h("button", { class: "solid", onclick: () => host.choose?.() }, texts().page.chooseCase)
          : null,
        again &&
          h(
            "button",
            {
              class: "solid quiet",
              onclick: () => {
                this.dismiss();
                again();
              },
            },
            texts().page.again,
          ),
      ),
    );
    this.#message.hidden = false;
  }

  /** What went wrong is not said any more. */
  dismiss(): void {
    this.#message.hidden = true;
  }

  /** What is shown, by its title: to choose another, where there are others. */
  #caseTitle(): HTMLElement {
    const { host } = this;
    const brand = h("span", { class: "brand" }, "clipgs");
    return host.choose
      ? h(
          "button",
          { class: "case-button", title: texts().page.cases, onclick: () => host.choose?.() },
          brand,
          this.#title,
          icon(kIcons.chevron),
        )
      : h("span", { class: "case-title" }, brand, this.#title);
  }

  #buttons(theme: HTMLElement, slices: HTMLElement): HTMLElement {
    const { host } = this;
    const link = h(
      "button",
      { class: "plain", title: texts().page.link, onclick: () => void this.#copyLink(link) },
      icon(kIcons.link),
    );
    return h(
      "span",
      { class: "buttons" },
      this.#headsetButtons,
      slices,
      this.#fullScreen.button,
      h(
        "button",
        { class: "plain", title: texts().page.picture, onclick: () => void this.#savePicture() },
        icon(kIcons.camera),
      ),
      host.address ? link : null,
      theme,
      h(
        "button",
        { class: "plain", title: texts().page.help, onclick: () => this.#help.showModal() },
        icon(kIcons.help),
      ),
    );
  }

  /** Frames the case in what the panel leaves free: it stands at the right, or below on a narrow page. */
  #resize(): void {
    const { canvas } = this.viewer;
    const { clientWidth } = canvas;
    const stage = canvas.getBoundingClientRect();
    const box = this.#panel.getBoundingClientRect();
    const shown = box.width > 0;
    const below = box.width >= clientWidth;
    const card = this.#card?.isAside ? this.#card.element.getBoundingClientRect() : null;
    if (below && !this.#panel.classList.contains("open")) {
      this.#root.style.setProperty("--panel-height", `${box.height}px`);
    }
    const free = this.#slices.free.getBoundingClientRect();
    const sliced = free.width > 0;
    this.#root.classList.toggle("sliced", sliced);
    const inset = {
      right: sliced ? stage.right - free.right : shown && !below ? stage.right - box.left : 0,
      bottom: sliced
        ? stage.bottom - free.bottom
        : card
          ? stage.bottom - card.top
          : shown && below
            ? stage.bottom - box.top
            : 0,
    };
    const { width, height } = stage;
    const half = this.#beside.place(width - inset.right, height - inset.bottom);
    this.#root.classList.toggle("has-beside", half.right + half.bottom > 0);
    inset.right += half.right;
    inset.bottom += half.bottom;
    this.#root.style.setProperty("--free-right", `${inset.right}px`);
    this.#root.style.setProperty("--free-bottom", `${inset.bottom}px`);
    this.viewer.resize(inset);
  }

  /** A button that goes from theme to theme. */
  #themeChoice(): HTMLElement {
    const { isFixed, theme, shown } = this.#theme;
    const button = h("button", {
      class: "plain",
      hidden: isFixed,
      title: computed(() => texts().page.themes[theme.value]),
      onclick: () => this.#theme.next(),
    });
    follow(() => button.replaceChildren(icon(kIcons[shown.value])));
    return button;
  }

  #showTheme(): void {
    this.viewer.setGlow(this.#pictureOnly ? null : this.#theme.shown.value);
    this.#beside?.update();
    this.#showInk();
  }

  /** Text and panels are those that are read on what lies behind the case. */
  #showInk(): void {
    const backdrop = kBackdrops.get(this.viewer.state.backdrop ?? "");
    this.#root.classList.toggle("light", backdrop?.isBright ?? this.#theme.shown.value === "light");
  }

  /** The case is framed in what the card leaves free. */
  #showCard(study: Study, card: StudyCard): void {
    if (card.show(study.screen)) {
      this.#resize();
    }
  }

  /** Of the page, while a task is done there. */
  #countFrames(study: Study): void {
    const count = (time: number) => {
      if (!this.headset.worn) {
        study.measures?.frames.count(time);
      }
      if (!this.#ended.signal.aborted) {
        requestAnimationFrame(count);
      }
    };
    requestAnimationFrame(count);
  }

  /** What is shown, as a PNG of another size, transparent, or without labels. Rejects with CaseError. */
  picture(wanted: WantedPicture): Promise<Blob> {
    return pictureOf(this.viewer, this.title, this.#root, this.#marks.texts, wanted);
  }

  async #savePictureAs(wanted: WantedPicture): Promise<void> {
    download(await this.picture(wanted), `${this.viewer.caseName ?? "clipgs"}.png`);
  }

  async #savePicture(): Promise<void> {
    try {
      await savePicture(this.viewer, this.title, this.#root, this.#marks.texts);
    } catch (error) {
      this.fail((error as CaseError).message, () => void this.#savePicture());
    }
  }

  /** What is begun, chosen or said is gone. */
  #escape(): void {
    this.#marks.escape();
    this.dismiss();
    this.views.player.leave();
  }

  #removeChosen(): void {
    const { chosen } = this.#marks;
    if (chosen.value) {
      this.viewer.store.removeMark(chosen.value);
      chosen.value = null;
    }
  }

  #saveMarks(): void {
    const { viewer } = this;
    const text = formatMarks(viewer.state.marks, viewer.info?.volume ?? "");
    download(new Blob([text], { type: "application/json" }), `${viewer.caseName ?? "case"}.marks.json`);
  }

  /** Marks of a file come to those that are there. */
  async #openMarks(file: File): Promise<void> {
    const { viewer } = this;
    try {
      const marks = parseMarks(await file.text(), file.name, viewer.info?.volume ?? "");
      viewer.store.setMarks(mergedMarks(viewer.state.marks, marks));
    } catch (error) {
      this.fail((error as Error).message, () => void this.#openMarks(file));
    }
  }

  async #offerHeadset(): Promise<void> {
    const offered = await offeredSurroundings();
    this.#headsetButtons.replaceChildren(
      ...offered.map((one) =>
        h(
          "button",
          {
            class: "plain",
            title: one === "immersive-vr" ? texts().page.headset : texts().page.room,
            onclick: () => void this.enterHeadset(one),
          },
          icon(one === "immersive-vr" ? kIcons.headset : kIcons.passthrough),
        ),
      ),
    );
  }

  /** The viewer shows something else, or can. */
  #follow(): void {
    this.actions.observe();
    if (!this.#study) {
      this.#keeper.observe(this.viewer.store.state.marks, this.#marksOf);
      this.views.observe();
    }
    this.#study?.observe();
    this.#update();
  }

  /** Nobody looks at the page while a headset is worn. */
  #update(): void {
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

  #updateStats(): void {
    this.#statsTimer = 0;
    const { frameMs, sortMs, drawn, total, scale, sectionBytes, sectionMs } = this.viewer.stats;
    if (total === 0) {
      return;
    }
    const frame = frameMs > 0 ? `${frameMs.toFixed(1)} ms a frame · ` : "";
    const section =
      sectionBytes > 0
        ? ` · section ${formatBytes(sectionBytes)}, decoded in ${Math.round(sectionMs)} ms`
        : "";
    const reduced = scale < 0.99 ? ` · ${Math.round(100 * scale)} % resolution` : "";
    this.#stats.textContent = `${frame}sort ${sortMs.toFixed(1)} ms · ${formatCount(drawn)} of ${formatCount(total)} splats${section}${reduced}`;
  }

  async #copyLink(button: HTMLElement): Promise<void> {
    const address = this.host.address!();
    if (address === null) {
      this.fail(texts().files.noLink, null);
      return;
    }
    await navigator.clipboard.writeText(address);
    button.classList.add("done");
    setTimeout(() => button.classList.remove("done"), 900);
  }

  #key(event: KeyboardEvent): void {
    const [target] = event.composedPath();
    const input = target instanceof HTMLInputElement ? target : null;
    const types = input ? kTypedInto.includes(input.type) : target instanceof HTMLTextAreaElement;
    if (this.#study || types || this.#root.querySelector("dialog[open]")) {
      return;
    }
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
      event.preventDefault();
      if (event.shiftKey) {
        this.actions.redo();
      } else {
        this.actions.undo();
      }
      return;
    }
    if (target === this.viewer.canvas && this.#keys.press(event)) {
      event.preventDefault();
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    const step = event.shiftKey ? 10 : 1;
    const keys: Record<string, () => unknown> = {
      a: () => this.actions.orient("axial"),
      c: () => this.actions.orient("coronal"),
      s: () => this.actions.orient("sagittal"),
      f: () => this.actions.flip(),
      p: () => this.actions.toggle(),
      u: () => this.actions.toggleMode(),
      n: () => this.actions.add(),
      e: () => this.actions.activate(),
      x: () => this.actions.remove(),
      b: () => this.actions.toggleSlab(),
      q: () => this.viewer.section && this.actions.toggleSlices(),
      y: () => (this.besideName ? void this.showBeside(null) : this.host.chooseBeside?.()),
      g: () => this.actions.toggleGrey(),
      w: () => this.actions.nextWindow(),
      i: () => this.#marks.mark("point"),
      l: () => this.#marks.mark("length"),
      escape: () => this.#escape(),
      h: () => this.viewer.store.setHandle(!this.viewer.state.handle),
      o: () => this.viewer.store.setLayers({ body: !this.viewer.state.layers.body }),
      r: () => this.actions.reset(),
      m: () => this.host.choose?.(),
      k: () => !this.#lookButton.hidden && this.#lookButton.click(),
      d: () => (event.shiftKey ? this.#picture.show() : void this.#savePicture()),
      j: () => this.views.save(),
      "0": () => void this.views.player.toggle(),
      ",": () => void this.views.player.step(-1),
      ".": () => void this.views.player.step(1),
      t: () => this.#theme.next(),
      z: () => this.#fullScreen.toggle(),
      v: () => this.#headsetButtons.querySelector("button")?.click(),
      "?": () => this.#help.showModal(),
      "1": () => this.viewer.store.setClip("hard"),
      "2": () => this.viewer.store.setClip("soft"),
      "3": () => this.viewer.store.setClip("exact"),
      "4": () => this.viewer.hasLayers && this.viewer.store.setClip("layers"),
      ...(this.#marks.chosen.value ? { delete: () => this.#removeChosen() } : {}),
      ...(this.marking.kind === "outline" && !(target instanceof HTMLButtonElement)
        ? { enter: () => this.marking.finish() }
        : {}),
      ...(input ? {} : { arrowup: () => this.actions.step(step), arrowdown: () => this.actions.step(-step) }),
    };
    const action = keys[event.key.toLowerCase()];
    if (action) {
      event.preventDefault();
      action();
    }
  }
}
