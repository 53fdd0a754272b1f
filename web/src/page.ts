import type { ClipgsApi } from "./api";
import { App } from "./app";
import type { Host } from "./host";
import {
  caseFile,
  type CaseIndex,
  type CaseSummary,
  fetchIndex,
  kNoAnswer,
  sayGoodbye,
} from "./model/case_list";
import { newsText } from "./model/case_news";
import { type Look, looksOf } from "./model/looks";
import { type Place, servedPlace } from "./model/keeper";
import { formatLink, type Link, parseLink } from "./model/link";
import type { Mark } from "./model/marks";
import { kMarksFile } from "./model/marks_file";
import { kTourFile, type Stop } from "./model/tour";
import { makeApi } from "./script_api";
import { CaseError } from "./sog/zip";
import { texts } from "./text/text";
import type { CaseLibrary } from "./ui/case_library";
import type { LoadingCard } from "./ui/loading_card";
import { LooksMenu } from "./ui/looks_menu";
import type { CaseClient } from "./worker/case_client";

const kLinkDelayMs = 300;
/** How often it is asked what there is, where a server makes cases while it serves them, and where others may. */
const kMakingMs = 2000;
const kUnfinishedMs = 5000;

/** Makes the page in `root`; its first case and the `index` may be on their way already. */
export function startPage(
  root: HTMLElement,
  client: CaseClient,
  index: Promise<CaseIndex>,
  loading: LoadingCard,
): ClipgsApi {
  const page = new Page(root, client, loading);
  const ready = page.start(index);
  ready.catch(() => {}); // said on the page; who waits for it hears it too
  return makeApi(page.app, () => ready);
}

/** The page of `clipgs serve`: the server's cases, and the address that says what is shown. */
class Page implements Host {
  readonly keys = window;
  readonly app: App;
  readonly #root: HTMLElement;
  #library: CaseLibrary | null = null; // loaded when it is opened first
  readonly #looksMenu = new LooksMenu((name) => void this.open(name).catch(() => {}));
  readonly #name = crypto.randomUUID?.() ?? String(Math.random()).slice(2); // that the server knows it by
  #index: CaseIndex = { cases: [], making: null, keepsMarks: false, keepsTours: false };
  #version = ""; // of the case that is shown, or was tried to be
  #newsTimer = 0;
  #opening: { name: string; opened: Promise<void> } | null = null; // what was asked for last
  #own: File | null = null; // what is shown, where it is no case of the server's
  #size: Link["size"];
  #linkTimer = 0;

  constructor(root: HTMLElement, client: CaseClient, loading: LoadingCard) {
    this.app = new App(root, this, client, loading);
    this.#root = root;
    root.append(this.#looksMenu.element);
    // By now the address may have been written over.
    addEventListener("hashchange", (event) => void this.#follow(new URL(event.newURL).hash).catch(() => {}));
  }

  /** Shows what the address names, or else the first case, when it is there. Rejects with CaseError. */
  async start(index: Promise<CaseIndex>): Promise<void> {
    try {
      this.#index = await index;
      addEventListener("pagehide", () => this.#index.making && sayGoodbye(this.#name));
      await this.#firstCase();
    } catch (error) {
      this.app.opening.end();
      this.app.message.say((error as CaseError).message, () => location.reload());
      throw error;
    }
    const study = new URLSearchParams(location.search).get("study");
    await (study ? this.#study(study) : this.#follow(location.hash));
    this.#watch();
  }

  get #cases(): CaseSummary[] {
    return this.#index.cases;
  }

  /** Until the case that the address names, or any, is made. Rejects with CaseError. */
  async #firstCase(): Promise<void> {
    for (;;) {
      const linked = parseLink(location.hash).case;
      const coming = this.#index.making?.filter(
        (one) => one.error === null && (!linked || one.name === linked),
      );
      const failed = this.#index.making?.find((one) => one.error !== null && one.name === linked);
      if (failed && !this.#cases.some((one) => one.name === linked)) {
        throw new CaseError(failed.error!);
      }
      if (!coming?.length || this.#cases.some((one) => !linked || one.name === linked)) {
        return;
      }
      this.app.tell(texts().news.coming(coming[0]!.quality));
      this.app.loading.say(this.app.news);
      await new Promise((resolve) => setTimeout(resolve, kMakingMs / 4));
      this.#index = await fetchIndex(this.#name);
    }
  }

  /** Looks for better cases as long as there may be some. */
  #watch(): void {
    clearTimeout(this.#newsTimer);
    this.#tellNews();
    const { making } = this.#index;
    const unfinished = this.#cases.some((one) => one.trained < 1 && one.name === this.app.viewer.caseName);
    if (making || unfinished) {
      const look = () => void this.#takeNews().then(() => this.#watch());
      this.#newsTimer = window.setTimeout(look, making ? kMakingMs : kUnfinishedMs);
    }
  }

  /** Takes what is new; what cannot be had now may be had later. */
  async #takeNews(): Promise<void> {
    try {
      this.#index = await fetchIndex(this.#name);
    } catch {
      return;
    }
    this.#library?.update(this.#index);
    const { viewer } = this.app;
    const shown = this.#cases.find((one) => one.name === viewer.caseName);
    const isNew = shown && !shown.error && this.#version !== "" && shown.version !== this.#version;
    if (isNew && !this.#opening && !this.app.isInStudy) {
      this.#version = shown.version; // one that cannot be shown is not tried again
      await this.app.opening.renew(shown);
    }
  }

  #tellNews(): void {
    if (this.#own) {
      return;
    }
    const name = this.app.viewer.caseName;
    const shown = this.#cases.find((one) => one.name === name);
    this.app.tell(newsText(shown, this.#index.making ?? [], name));
  }

  /** Leads people through a study by the plan of this name. Rejects with CaseError. */
  async #study(name: string): Promise<void> {
    try {
      const { beginStudy, loadPlan } = await import("./study/begin");
      const plan = await loadPlan(name);
      if (!this.#cases.some((one) => one.name === plan.case)) {
        throw new CaseError(
          `${name}: its case "${plan.case}" is not served; put ${plan.case}.sog into the folder`,
        );
      }
      await this.open(plan.case);
      await beginStudy(plan, this.app);
    } catch (error) {
      this.app.opening.end();
      this.app.message.say((error as CaseError).message, () => location.reload());
      throw error;
    }
  }

  async cases(): Promise<CaseSummary[]> {
    this.#index = await fetchIndex(this.#name);
    this.app.offerLooks();
    return this.#cases;
  }

  looks(): readonly Look[] {
    return looksOf(this.#cases, this.app.viewer.caseName);
  }

  chooseLook(): void {
    this.#looksMenu.show(this.looks(), this.app.viewer.caseName);
  }

  /** Shows a case by its name. Rejects with CaseError, after saying so on the page. */
  async open(name: string): Promise<void> {
    await this.#follows(name, this.#open(name));
  }

  async openFile(file: File): Promise<void> {
    await this.#follows(file.name, this.#openOwn(file));
  }

  /** A case is asked for, until it is opened. */
  async #follows(name: string, opened: Promise<void>): Promise<void> {
    const opening = { name, opened };
    this.#opening = opening;
    try {
      await opening.opened;
    } finally {
      if (this.#opening === opening) {
        this.#opening = null;
      }
    }
  }

  async #open(name: string): Promise<void> {
    const known = this.#cases.find((one) => one.name === name);
    const again = () => void this.open(name).catch(() => {});
    await this.app.opening.open(
      known ?? { name, file: caseFile(name), error: null },
      parseLink(location.hash),
      again,
    );
    this.#own = null;
    this.#version = known?.version ?? "";
    document.title = `${this.app.viewer.title} · clipgs`;
    this.#prefetchAfter(name);
    this.#watch();
  }

  /** The address cannot say what is shown then. */
  async #openOwn(file: File): Promise<void> {
    const { name } = file;
    await this.app.opening.open({ name, file, error: null }, {}, () => void this.app.openFile(file));
    this.#own = file;
    this.#version = "";
    clearTimeout(this.#linkTimer);
    history.replaceState(null, "", location.pathname + location.search);
    document.title = `${this.app.viewer.title} · clipgs`;
  }

  marksPlace(name: string, volume: string): Promise<Place<Mark>> {
    return servedPlace(kMarksFile, name, volume, this.#index.keepsMarks);
  }

  tourPlace(name: string, volume: string): Promise<Place<Stop>> {
    return servedPlace(kTourFile, name, volume, this.#index.keepsTours);
  }

  /** Of the same volume, where it is known which those are. */
  async openLook(name: string): Promise<void> {
    const look = this.#cases.find((one) => one.name === name);
    const shown = this.#cases.find((one) => one.name === this.app.viewer.caseName);
    if (!look) {
      throw new CaseError(texts().views.noLook(name));
    }
    if (look.look?.volume !== shown?.look?.volume) {
      throw new CaseError(texts().views.otherVolume(name));
    }
    await this.open(name);
  }

  expectLook(name: string): void {
    const look = this.#cases.find((one) => one.name === name);
    if (look && !look.error) {
      this.app.viewer.prefetch(look.file);
    }
  }

  news(): string {
    return this.app.news;
  }

  takesWheel(): boolean {
    return true;
  }

  choose(): void {
    void this.#showLibrary();
  }

  chooseBeside(): void {
    void this.#showLibrary(true);
  }

  address(): string | null {
    return this.#own ? null : new URL(this.#link(), location.href).href;
  }

  changed(): void {
    clearTimeout(this.#linkTimer);
    this.#linkTimer = window.setTimeout(() => this.#writeLink(), kLinkDelayMs);
  }

  /** The case after this one in the menu, so that going through them takes no time. */
  #prefetchAfter(name: string): void {
    const good = this.#cases.filter((one) => !one.error);
    const next = good[(good.findIndex((one) => one.name === name) + 1) % good.length];
    if (next && next.name !== name) {
      this.app.viewer.prefetch(next.file);
    }
  }

  /** Takes over what the address says. */
  async #follow(hash: string): Promise<void> {
    const { app } = this;
    const link = parseLink(hash);
    this.#size = link.size;
    app.setSize(link.size);
    const wanted = this.#opening?.name ?? app.viewer.caseName;
    const name = link.case ?? wanted ?? this.#cases.find((one) => !one.error)?.name;
    if (name === undefined) {
      app.opening.end();
      await this.#showLibrary();
      return;
    }
    if (name === wanted) {
      await this.#opening?.opened;
    } else {
      await this.open(name);
    }
    app.follow(link);
    if ((link.beside ?? null) !== app.besideName) {
      this.#showBeside(link.beside ?? null);
    }
  }

  #showBeside(name: string | null): void {
    const known = this.#cases.find((one) => one.name === name);
    void this.app.showBeside(name === null ? null : (known ?? { name, file: caseFile(name), error: null }));
  }

  #link(): string {
    return formatLink({ ...this.app.link, size: this.#size });
  }

  #writeLink(): void {
    if (this.app.viewer.caseName !== null && !this.#own) {
      history.replaceState(null, "", this.#link());
    }
  }

  async #showLibrary(beside = false): Promise<void> {
    try {
      const [library] = await Promise.all([this.#loadLibrary(), this.cases()]);
      library.show(this.#index, this.app.viewer.caseName, beside);
    } catch (error) {
      this.app.message.say((error as CaseError).message, () => void this.#showLibrary(beside));
    }
  }

  async #loadLibrary(): Promise<CaseLibrary> {
    const { CaseLibrary } = await import("./ui/case_library").catch(() => {
      throw new CaseError(kNoAnswer);
    });
    if (!this.#library) {
      this.#library = new CaseLibrary(
        (name, beside) => (beside ? this.#showBeside(name) : void this.open(name).catch(() => {})),
        (file) => void this.app.openFile(file),
      );
      this.#root.append(this.#library.element);
    }
    return this.#library;
  }
}
