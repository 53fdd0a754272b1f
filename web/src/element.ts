import type { ClipgsApi } from "./api";
import { App } from "./app";
import type { Host, OpenedCase } from "./host";
import { BrowserPlace, type Place } from "./model/keeper";
import { formatLink, type Link, parseLink } from "./model/link";
import { kTourFile, parseTour, type Stop } from "./model/tour";
import { makeApi } from "./script_api";
import { CaseError } from "./sog/zip";
import { german } from "./text/de";
import { english, type Texts } from "./text/en";
import { type Language, languageOf, speak } from "./text/text";
import { h } from "./ui/dom";
import hostStyle from "./ui/element.css?inline";
import { themeFrom } from "./ui/theme";
import viewerStyle from "./ui/viewer.css?inline";

const kTexts: Readonly<Record<Language, Texts>> = { en: english, de: german };
const kAttributes = ["src", "link", "tour", "beside", "panel", "theme"] as const;

/** One for all elements of a page. */
let styles: CSSStyleSheet[] | undefined;

function makeStyles(): CSSStyleSheet[] {
  return [viewerStyle, hostStyle].map((text) => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(text);
    return sheet;
  });
}

/** The name of the case in a file: "head" of "cases/head.sog?v=2". */
function caseName(src: string): string {
  const file = new URL(src, document.baseURI).pathname.split("/").pop()!;
  return decodeURIComponent(file).replace(/\.sog$/i, "");
}

/** `<clipgs-viewer src="case.sog">`: a case in another page. It holds a GPU context and a worker while it is there. */
export class ClipgsViewerElement extends HTMLElement {
  static readonly observedAttributes = kAttributes;
  readonly #root = h("div", { lang: "en" });
  readonly #host: Host = {
    keys: this.#root, // hear keys while the focus is in the element
    takesWheel: () => this.#root.matches(":focus-within, :fullscreen"),
    changed: () => this.#tellOfChange(),
    cases: async () => [],
    looks: () => [],
    open: (src) => this.#openOther(src),
    openFile: (file) => this.#openOwn(file),
    openLook: (name) => this.#openLook(name),
    expectLook: (name) => this.#app?.viewer.prefetch(this.#lookFile(name)),
    tourPlace: (name, volume) => this.#tourPlace(name, volume),
  };
  #app: App | null = null;
  #api: ClipgsApi | null = null;
  #ready: Promise<void> = Promise.reject(new Error("the element is not in a page, or has no src"));
  #opening = 0;
  #stale = new Set<string>(); // attributes that are not followed yet
  #changeFrame = 0;

  constructor() {
    super();
    this.#ready.catch(() => {});
    const shadow = this.attachShadow({ mode: "open", delegatesFocus: true });
    shadow.adoptedStyleSheets = styles ??= makeStyles();
    shadow.append(this.#root);
  }

  /** The viewer for scripts; null while the element is in no page. */
  get clipgs(): ClipgsApi | null {
    return this.#api;
  }

  /** The address of the case. */
  get src(): string {
    return this.getAttribute("src") ?? "";
  }

  set src(src: string) {
    this.setAttribute("src", src);
  }

  /** What is shown of the case, in the words of the viewer's address. */
  get link(): string {
    return this.#app
      ? formatLink({ ...this.#app.link, case: undefined, beside: undefined })
      : (this.getAttribute("link") ?? "");
  }

  set link(link: string) {
    this.setAttribute("link", link);
  }

  connectedCallback(): void {
    if (this.#app) {
      return; // it was moved
    }
    const language = languageOf([this.closest<HTMLElement>("[lang]")?.lang, navigator.language]);
    speak(language, kTexts[language]);
    this.#root.lang = language;
    try {
      this.#app = new App(this.#root, this.#host);
    } catch (error) {
      const { message } = error as Error;
      this.#root.replaceChildren(h("div", { class: "message", role: "alert" }, h("p", {}, message)));
      this.dispatchEvent(new ErrorEvent("error", { message }));
      return;
    }
    this.#takeOver("src");
    this.#takeOver("link");
    this.#api = makeApi(this.#app, () => this.#drawn());
    kAttributes.forEach((name) => this.attributeChangedCallback(name));
  }

  disconnectedCallback(): void {
    // Not where it is only being moved.
    queueMicrotask(() => {
      if (!this.isConnected) {
        ++this.#opening;
        cancelAnimationFrame(this.#changeFrame);
        this.#changeFrame = 0;
        this.#app?.dispose();
        this.#app = this.#api = null;
      }
    });
  }

  attributeChangedCallback(name: string): void {
    if (this.#stale.size === 0) {
      queueMicrotask(() => this.#follow());
    }
    this.#stale.add(name);
  }

  /** A property that was set before this class was known hides the one of the class. */
  #takeOver(name: "src" | "link"): void {
    if (Object.hasOwn(this, name)) {
      const value = this[name];
      delete (this as Partial<Record<typeof name, string>>)[name];
      this[name] = value;
    }
  }

  /** In place of what `src` says, until that says something else. */
  async #openOwn(file: File): Promise<void> {
    const app = this.#app!;
    const again = (): void => void app.openFile(file);
    this.#ready = this.#open(app, { name: file.name, file, error: null }, null, again);
    await this.#ready;
  }

  async #openOther(src: string): Promise<void> {
    this.src = src;
    await this.#drawn();
  }

  /** The address of the case of that name, which lies beside the one that is shown. */
  #lookFile(name: string): string {
    return new URL(`${encodeURIComponent(name)}.sog`, new URL(this.src, document.baseURI)).href;
  }

  /** Of the case that lies beside the one that is shown. What fails is said by who asked for it. */
  async #openLook(name: string): Promise<void> {
    const app = this.#app!;
    const file = this.#lookFile(name);
    try {
      await app.opening.open({ name, file, error: null }, {}, () => {});
    } catch (error) {
      app.message.dismiss();
      throw error;
    }
    this.src = file;
    this.#stale.delete("src"); // it is shown already
  }

  /** The tour that the page names, which nobody's changes are kept of, or else this browser's. */
  #tourPlace(name: string, volume: string): Place<Stop> {
    const tour = this.getAttribute("tour");
    if (tour === null) {
      return new BrowserPlace(kTourFile, volume, name);
    }
    return { load: () => this.#loadTour(tour, volume), change: () => Promise.resolve() };
  }

  /** None where it cannot be had, which is said. */
  async #loadTour(address: string, volume: string): Promise<Stop[]> {
    const url = new URL(address, document.baseURI);
    const file = decodeURIComponent(url.pathname.split("/").pop()!);
    try {
      const response = await fetch(url).catch(() => null);
      if (!response?.ok) {
        throw new CaseError(`${file}: the tour cannot be fetched (${response?.status ?? "no answer"})`);
      }
      return parseTour(await response.text(), file, volume);
    } catch (error) {
      const { message } = error as CaseError;
      this.#app?.message.say(message, () => this.attributeChangedCallback("tour"));
      this.dispatchEvent(new ErrorEvent("error", { message }));
      return [];
    }
  }

  /** As ClipgsApi.ready says. */
  async #drawn(): Promise<void> {
    await Promise.resolve(); // until attributes are followed
    await this.#ready;
  }

  /** Once a frame is enough. */
  #tellOfChange(): void {
    this.#changeFrame ||= requestAnimationFrame(() => {
      this.#changeFrame = 0;
      this.dispatchEvent(new Event("change"));
    });
  }

  /** Does what attributes say that were set since. */
  #follow(): void {
    const stale = this.#stale;
    this.#stale = new Set();
    const app = this.#app;
    if (!app) {
      return;
    }
    app.setPanel(this.getAttribute("panel") !== "none");
    app.setTheme(themeFrom(this.getAttribute("theme")));
    if (stale.has("beside")) {
      this.#showBeside(app);
    }
    const linked = stale.has("link") && this.hasAttribute("link");
    const link = parseLink(linked ? this.getAttribute("link")! : "");
    if (stale.has("src") && this.src) {
      const { src } = this;
      const again = (): void => this.attributeChangedCallback("src");
      const shown = { name: caseName(src), file: src, error: null };
      this.#ready = this.#open(app, shown, linked ? link : null, again);
      this.#ready.catch(() => {}); // said in the element; who waits for it hears it too
    } else {
      if (linked) {
        void this.#ready.then(() => app.follow(link)).catch(() => {});
      }
      if (stale.has("tour")) {
        void this.#ready.then(() => app.views.bring(app.viewer.caseName!)).catch(() => {});
      }
    }
  }

  /** The other case that the page names, once there is one that it is beside of; or none. */
  #showBeside(app: App): void {
    const file = this.getAttribute("beside");
    const one = file ? { name: caseName(file), file, error: null } : null;
    queueMicrotask(() => {
      const shown = this.#ready.then(() => app.showBeside(one));
      shown.then(
        (message) => message && this.dispatchEvent(new ErrorEvent("error", { message })),
        () => {}, // there is no case that it would be beside of, which is told of already
      );
    });
  }

  /** Shows a case; the view and planes stay unless `link` is another. Tells listeners how that ended. */
  async #open(app: App, shown: OpenedCase, link: Link | null, again: () => void): Promise<void> {
    const opening = ++this.#opening;
    try {
      await app.opening.open(shown, link ?? {}, again);
    } catch (error) {
      if (opening === this.#opening) {
        this.dispatchEvent(new ErrorEvent("error", { message: (error as Error).message }));
      }
      throw error;
    }
    if (link) {
      app.follow(link);
    }
    this.dispatchEvent(new Event("ready"));
  }
}
