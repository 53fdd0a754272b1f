import type { ClipgsApi } from "./api";
import { App, type Host } from "./app";
import { caseFile, type CaseSummary, fetchCases } from "./model/case_list";
import { type Look, looksOf } from "./model/looks";
import { formatLink, type Link, parseLink } from "./model/link";
import { makeApi } from "./script_api";
import { CaseError } from "./sog/zip";
import { CaseMenu } from "./ui/case_menu";
import { LooksMenu } from "./ui/looks_menu";
import type { CaseClient } from "./worker/case_client";

const kLinkDelayMs = 300;

/** Makes the page in `root`; its first case and the list of `cases` may be on their way already. */
export function startPage(root: HTMLElement, client: CaseClient, cases: Promise<CaseSummary[]>): ClipgsApi {
  const page = new Page(root, client);
  const ready = page.start(cases);
  ready.catch(() => {}); // said on the page; who waits for it hears it too
  return makeApi(page.app, () => ready);
}

/** The page of `clipgs serve`: the server's cases, and the address that says what is shown. */
class Page implements Host {
  readonly keys = window;
  readonly app: App;
  readonly #menu = new CaseMenu((name) => void this.open(name).catch(() => {}));
  readonly #looksMenu = new LooksMenu((name) => void this.open(name).catch(() => {}));
  #cases: CaseSummary[] = [];
  #opening: { name: string; opened: Promise<void> } | null = null; // what was asked for last
  #size: Link["size"];
  #linkTimer = 0;

  constructor(root: HTMLElement, client: CaseClient) {
    this.app = new App(root, this, client);
    root.append(this.#menu.element, this.#looksMenu.element);
    // By now the address may have been written over.
    addEventListener("hashchange", (event) => void this.#follow(new URL(event.newURL).hash).catch(() => {}));
  }

  /** Shows what the address names, or else the first case. Rejects with CaseError. */
  async start(cases: Promise<CaseSummary[]>): Promise<void> {
    try {
      this.#cases = await cases;
    } catch (error) {
      this.app.fail((error as CaseError).message, () => location.reload());
      throw error;
    }
    const study = new URLSearchParams(location.search).get("study");
    await (study ? this.#study(study) : this.#follow(location.hash));
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
      this.app.fail((error as CaseError).message, () => location.reload());
      throw error;
    }
  }

  async cases(): Promise<CaseSummary[]> {
    this.#cases = await fetchCases();
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
    const opening = { name, opened: this.#open(name) };
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
    await this.app.open(
      known ?? { name, file: caseFile(name), error: null },
      parseLink(location.hash),
      again,
    );
    document.title = `${this.app.title} · clipgs`;
    this.#prefetchAfter(name);
  }

  takesWheel(): boolean {
    return true;
  }

  choose(): void {
    void this.#showMenu();
  }

  address(): string {
    return new URL(this.#link(), location.href).href;
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
      await this.#showMenu();
      return;
    }
    if (name === wanted) {
      await this.#opening?.opened;
    } else {
      await this.open(name);
    }
    app.follow(link);
  }

  #link(): string {
    return formatLink({ ...this.app.link, size: this.#size });
  }

  #writeLink(): void {
    if (this.app.viewer.caseName !== null) {
      history.replaceState(null, "", this.#link());
    }
  }

  async #showMenu(): Promise<void> {
    try {
      this.#menu.show(await this.cases(), this.app.viewer.caseName);
    } catch (error) {
      this.app.fail((error as CaseError).message, () => void this.#showMenu());
    }
  }
}
