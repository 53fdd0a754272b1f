import { Actions } from "./actions";
import { type CaseSummary, fetchCases, formatBytes, formatCount } from "./model/case_list";
import { formatLink, parseLink } from "./model/link";
import { Marking } from "./model/pins";
import { CaseError } from "./sog/zip";
import { CaseMenu } from "./ui/case_menu";
import { h, icon, kIcons } from "./ui/dom";
import { FaceOverlay } from "./ui/face_overlay";
import { FacePanel } from "./ui/face_panel";
import { helpDialog } from "./ui/help";
import { OrientationCube } from "./ui/orientation_cube";
import { PlanePanel } from "./ui/plane_panel";
import { PointerControls } from "./ui/pointer";
import { Viewer } from "./viewer";
import { Headset, offeredSurroundings, type Surroundings } from "./xr/headset";

const kLinkDelayMs = 300;
const kStatsIntervalMs = 250;

const kHeadsetTitles: Record<Surroundings, string> = {
  "immersive-vr": "Show it in the headset (V)",
  "immersive-ar": "Show it in the headset, in the room where one is",
};

/** The page: the viewer's canvas, the panels around it, and the address that says what is shown. */
export class App {
  readonly viewer: Viewer;
  readonly headset: Headset;
  readonly actions: Actions;
  readonly marking = new Marking((point, joined) => this.viewer.addPin(point, joined));
  readonly #panel: PlanePanel;
  readonly #overlay: FaceOverlay;
  readonly #facePanel: FacePanel;
  readonly #cube: OrientationCube;
  readonly #menu = new CaseMenu((name) => void this.open(name).catch(() => {}));
  readonly #help = helpDialog();
  readonly #title = h("span", { class: "title" }, "No case");
  readonly #stats = h("output", { class: "stats", "aria-label": "Statistics" });
  readonly #progress = h("div", { class: "progress", role: "progressbar", "aria-label": "Loading" });
  readonly #message = h("div", { class: "message", role: "alert", hidden: true });
  readonly #headsetButtons = h("span", { class: "buttons" });
  #cases: CaseSummary[] = [];
  #opening = 0;
  #linkTimer = 0;
  #statsTimer = 0;
  #fixedSize: { width: number; height: number } | undefined;

  constructor(root: HTMLElement) {
    const canvas = h("canvas", {
      class: "stage",
      tabindex: "0",
      "aria-label": "The case in three dimensions",
    });
    const link = h(
      "button",
      { class: "plain", title: "Copy a link to this view", onclick: () => void this.#copyLink(link) },
      icon(kIcons.link),
    );
    root.append(canvas);
    this.viewer = new Viewer(canvas);
    this.actions = new Actions(this.viewer);
    this.headset = new Headset(this.viewer, this.actions, this.marking, {
      cases: () => this.#fetchCases(),
      open: (name) => this.open(name),
    });
    this.headset.changed = () => this.#update();
    this.#overlay = new FaceOverlay(this.viewer, this.marking);
    this.#facePanel = new FacePanel(this.viewer, this.#overlay.buttons);
    this.#panel = new PlanePanel(this.viewer, this.actions, this.#facePanel.element);
    this.#cube = new OrientationCube((azimuth, elevation) => this.viewer.setView({ azimuth, elevation }));
    root.append(
      this.#overlay.element,
      h(
        "header",
        { class: "bar" },
        h(
          "button",
          { class: "case-button", title: "Cases (M)", onclick: () => void this.#showMenu() },
          h("span", { class: "brand" }, "clipgs"),
          this.#title,
          icon(kIcons.chevron),
        ),
        h(
          "span",
          { class: "buttons" },
          this.#headsetButtons,
          link,
          h(
            "button",
            { class: "plain", title: "Help (?)", onclick: () => this.#help.showModal() },
            icon(kIcons.help),
          ),
        ),
      ),
      this.#panel.element,
      this.#cube.element,
      h("footer", {}, h("strong", { class: "warning" }, "Not for diagnosis"), this.#stats),
      this.#progress,
      this.#message,
      this.#menu.element,
      this.#help,
    );
    new PointerControls(this.viewer, (mm) => this.actions.step(mm));
    this.viewer.changed = () => {
      this.actions.observe();
      this.#update();
    };
    this.viewer.drawnFrame = () => {
      this.#overlay.update();
      this.#statsTimer ||= window.setTimeout(() => this.#updateStats(), kStatsIntervalMs);
    };
    const resized = new ResizeObserver(() => this.#resize());
    resized.observe(canvas);
    resized.observe(this.#panel.element);
    addEventListener("keydown", (event) => this.#key(event));
    // By now the address may have been written over.
    addEventListener("hashchange", (event) => void this.#follow(new URL(event.newURL).hash).catch(() => {}));
    navigator.xr?.addEventListener("devicechange", () => void this.#offerHeadset());
    void this.#offerHeadset();
    this.#update();
  }

  /** Shows the case in a headset; says on the page where that fails. */
  async enterHeadset(surroundings: Surroundings): Promise<void> {
    try {
      await this.headset.enter(surroundings);
    } catch (error) {
      this.#fail((error as CaseError).message, () => void this.enterHeadset(surroundings));
    }
  }

  /** Shows what the address names, or else the first case. Rejects with CaseError. */
  async start(): Promise<void> {
    try {
      await this.#fetchCases();
    } catch (error) {
      this.#fail((error as CaseError).message, () => location.reload());
      throw error;
    }
    await this.#follow(location.hash);
  }

  /** Shows a case by its name. Rejects with CaseError, after saying so on the page. */
  async open(name: string): Promise<void> {
    const opening = ++this.#opening;
    this.#message.hidden = true;
    this.#setProgress(0.02);
    try {
      const known = this.#cases.find((one) => one.name === name);
      if (known?.error) {
        throw new CaseError(known.error);
      }
      const first = this.viewer.info === null && parseLink(location.hash).view === undefined;
      const file = known?.file ?? `cases/${encodeURIComponent(name)}.sog`;
      await this.viewer.open(
        name,
        file,
        (share) => opening === this.#opening && this.#setProgress(0.9 * share),
      );
      if (first) {
        this.actions.reset();
      }
      this.actions.forget();
    } catch (error) {
      if (opening === this.#opening) {
        const text = error instanceof Error ? error.message : String(error);
        this.#fail(
          text.startsWith(name) ? text : `${name}: ${text}`,
          () => void this.open(name).catch(() => {}),
        );
      }
      throw error;
    } finally {
      if (opening === this.#opening) {
        this.#setProgress(null);
      }
    }
    const title = this.viewer.info?.title || name;
    this.#title.textContent = title;
    document.title = `${title} · clipgs`;
    this.#update();
    this.#prefetchAfter(name);
  }

  /** The case after this one in the menu, so that going through them takes no time. */
  #prefetchAfter(name: string): void {
    const good = this.#cases.filter((one) => !one.error);
    const next = good[(good.findIndex((one) => one.name === name) + 1) % good.length];
    if (next && next.name !== name) {
      this.viewer.prefetch(next.file);
    }
  }

  /** Takes over what the address says. */
  async #follow(hash: string): Promise<void> {
    const link = parseLink(hash);
    this.#setSize(link.size);
    const name = link.case ?? this.viewer.caseName ?? this.#cases.find((one) => !one.error)?.name;
    if (name === undefined) {
      await this.#showMenu();
      return;
    }
    if (name !== this.viewer.caseName) {
      await this.open(name);
    }
    if (link.view) {
      this.viewer.setView(link.view);
    }
    if (link.state !== undefined) {
      this.viewer.setMode("uniaxial");
      if (link.state === null) {
        this.viewer.setCuts([]);
      } else {
        this.viewer.setPlaneState(Math.min(link.state, this.viewer.states!.count - 1));
      }
    } else if (link.cuts) {
      this.viewer.setMode("arbitrary");
      this.viewer.setCuts(link.cuts);
    }
    if (link.clip) {
      this.viewer.setClip(link.clip);
    }
    this.viewer.setSection(link.section ?? "volume");
    this.viewer.setGrey(link.grey ?? 0);
    this.viewer.setPins(link.pins ?? []);
    if (link.window) {
      this.viewer.setWindow(link.window);
    }
    this.actions.forget();
  }

  /** A fixed size leaves the picture alone on the page. */
  #setSize(size: { width: number; height: number } | undefined): void {
    this.#fixedSize = size;
    document.body.classList.toggle("picture-only", size !== undefined);
    this.viewer.background = size === undefined;
    this.viewer.canvas.style.width = size ? `${size.width}px` : "";
    this.viewer.canvas.style.height = size ? `${size.height}px` : "";
    this.#resize();
  }

  /** Frames the case in what the panel leaves free: it stands at the right, or below on a narrow page. */
  #resize(): void {
    const { clientWidth, clientHeight } = this.viewer.canvas;
    const box = this.#panel.element.getBoundingClientRect();
    const shown = box.width > 0;
    const below = box.width >= clientWidth;
    this.viewer.resize({
      right: shown && !below ? clientWidth - box.left : 0,
      bottom: shown && below ? clientHeight - box.top : 0,
    });
  }

  async #offerHeadset(): Promise<void> {
    const offered = await offeredSurroundings();
    this.#headsetButtons.replaceChildren(
      ...offered.map((one) =>
        h(
          "button",
          { class: "plain", title: kHeadsetTitles[one], onclick: () => void this.enterHeadset(one) },
          icon(one === "immersive-vr" ? kIcons.headset : kIcons.passthrough),
        ),
      ),
    );
  }

  /** Nobody looks at the page while a headset is worn. */
  #update(): void {
    if (this.headset.worn) {
      this.headset.refresh();
      return;
    }
    this.#panel.update();
    this.#facePanel.update();
    this.#cube.update(this.viewer.state.view);
    clearTimeout(this.#linkTimer);
    this.#linkTimer = window.setTimeout(() => this.#writeLink(), kLinkDelayMs);
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

  #link(): string {
    const { view, mode, cuts, clip, section, grey, window, pins } = this.viewer.state;
    const name = this.viewer.caseName ?? undefined;
    const cut = mode === "uniaxial" ? { state: this.viewer.planeState } : { cuts };
    const style = grey > 0 ? { grey, window: window ?? undefined } : {};
    return formatLink({ case: name, view, ...cut, clip, section, ...style, pins, size: this.#fixedSize });
  }

  #writeLink(): void {
    if (this.viewer.caseName !== null) {
      history.replaceState(null, "", this.#link());
    }
  }

  async #copyLink(button: HTMLElement): Promise<void> {
    await navigator.clipboard.writeText(new URL(this.#link(), location.href).href);
    button.classList.add("done");
    setTimeout(() => button.classList.remove("done"), 900);
  }

  async #fetchCases(): Promise<CaseSummary[]> {
    this.#cases = await fetchCases();
    return this.#cases;
  }

  async #showMenu(): Promise<void> {
    try {
      this.#menu.show(await this.#fetchCases(), this.viewer.caseName);
    } catch (error) {
      this.#fail((error as CaseError).message, () => void this.#showMenu());
    }
  }

  #setProgress(share: number | null): void {
    this.#progress.classList.toggle("shown", share !== null);
    this.#progress.style.setProperty("--share", String(share ?? 1));
    this.#progress.setAttribute("aria-valuenow", String(Math.round(100 * (share ?? 1))));
  }

  #fail(text: string, again: () => void): void {
    this.#message.replaceChildren(
      icon(kIcons.warning),
      h("p", {}, text),
      h(
        "div",
        { class: "row" },
        h("button", { class: "solid", onclick: () => void this.#showMenu() }, "Choose a case"),
        h(
          "button",
          {
            class: "solid quiet",
            onclick: () => {
              this.#message.hidden = true;
              again();
            },
          },
          "Try again",
        ),
      ),
    );
    this.#message.hidden = false;
  }

  #key(event: KeyboardEvent): void {
    const input = event.target instanceof HTMLInputElement ? event.target : null;
    if (input?.type === "number" || document.querySelector("dialog[open]")) {
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
    if (event.ctrlKey || event.metaKey || event.altKey) {
      return;
    }
    const step = event.shiftKey ? 10 : 1;
    const keys: Record<string, () => void> = {
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
      g: () => this.actions.toggleGrey(),
      w: () => this.actions.nextWindow(),
      i: () => this.#overlay.mark("pin"),
      l: () => this.#overlay.mark("length"),
      escape: () => this.marking.toggle(null),
      h: () => this.viewer.setHandle(!this.viewer.state.handle),
      r: () => this.actions.reset(),
      m: () => void this.#showMenu(),
      v: () => this.#headsetButtons.querySelector("button")?.click(),
      "?": () => this.#help.showModal(),
      "1": () => this.viewer.setClip("hard"),
      "2": () => this.viewer.setClip("soft"),
      "3": () => this.viewer.setClip("exact"),
      ...(input ? {} : { arrowup: () => this.actions.step(step), arrowdown: () => this.actions.step(-step) }),
    };
    const action = keys[event.key.toLowerCase()];
    if (action) {
      event.preventDefault();
      action();
    }
  }
}
