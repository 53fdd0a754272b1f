import { computed } from "@preact/signals-core";

import type { Surroundings } from "../api";
import type { Fail, Host } from "../host";
import { texts } from "../text/text";
import { offeredSurroundings } from "../xr/headset";
import { follow, h, icon, kIcons } from "./dom";
import type { ViewerTheme } from "./theme";

/** What the buttons of the bar do; `slices` and `fullScreen` are such buttons. */
export interface BarParts {
  readonly host: Host;
  readonly theme: ViewerTheme;
  readonly slices: HTMLElement;
  readonly fullScreen: HTMLElement;
  enterHeadset(surroundings: Surroundings): void;
  /** It is likely to be entered. */
  prepareHeadset(): void;
  savePicture(): void;
  showHelp(): void;
  readonly fail: Fail;
}

/** The bar above the case: what is shown, and what can be done with it. */
export class TopBar {
  readonly element: HTMLElement;
  readonly #parts: BarParts;
  readonly #title = h("span", { class: "title" }, texts().page.loading);
  readonly #lookName = h("span", { class: "look-name" });
  readonly #look: HTMLElement;
  readonly #headset = h("span", { class: "group" });

  /** Belongs to whoever makes it, as owned() says. */
  constructor(parts: BarParts) {
    this.#parts = parts;
    const { host } = parts;
    this.#look = h(
      "button",
      { class: "look-button", title: texts().page.looks, hidden: true, onclick: () => host.chooseLook?.() },
      icon(kIcons.looks),
      this.#lookName,
    );
    this.element = h(
      "header",
      { class: "bar", part: "bar" },
      this.#caseTitle(host),
      this.#look,
      this.#buttons(parts),
    );
  }

  /** What the case is called; "": there is none. */
  showTitle(title: string): void {
    this.#title.textContent = title || texts().page.noCase;
  }

  /** Which of the looks of the volume is shown; null: there are no others. */
  showLook(name: string | null): void {
    this.#look.hidden = name === null;
    this.#lookName.textContent = name ?? "";
    this.#look.ariaLabel = texts().page.look(this.#lookName.textContent);
  }

  /** Lets a person choose another look, where there are others. */
  chooseLook(): void {
    if (!this.#look.hidden) {
      this.#parts.host.chooseLook?.();
    }
  }

  /** Puts the case into a headset, where there is one. */
  enterHeadset(): void {
    this.#headset.querySelector("button")?.click();
  }

  get offersHeadset(): boolean {
    return this.#headset.hasChildNodes();
  }

  /** Looks which headsets there are. */
  async offerHeadset(): Promise<void> {
    const offered = await offeredSurroundings();
    const { headset, room } = texts().page;
    this.#headset.replaceChildren(
      ...offered.map((one) => {
        const [title, paths] =
          one === "immersive-vr" ? [headset, kIcons.headset] : [room, kIcons.passthrough];
        const button = plain(title, paths, () => this.#parts.enterHeadset(one));
        button.onpointerenter = button.onfocus = () => this.#parts.prepareHeadset();
        return button;
      }),
    );
  }

  /** What is shown, by its title: to choose another, where there are others. */
  #caseTitle(host: Host): HTMLElement {
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

  #buttons(parts: BarParts): HTMLElement {
    const { host, slices, fullScreen, theme } = parts;
    const t = texts().page;
    const link = plain(t.link, kIcons.link, () => void this.#copyLink(link));
    return h(
      "span",
      { class: "buttons" },
      this.#headset,
      slices,
      fullScreen,
      plain(t.picture, kIcons.camera, () => parts.savePicture()),
      host.address ? link : null,
      themeButton(theme, "wide"),
      plain(t.help, kIcons.help, () => parts.showHelp()),
    );
  }

  async #copyLink(button: HTMLElement): Promise<void> {
    const { host, fail } = this.#parts;
    const address = host.address!();
    if (address === null) {
      fail(texts().files.noLink, null);
      return;
    }
    try {
      await navigator.clipboard.writeText(address);
      button.classList.add("done");
      setTimeout(() => button.classList.remove("done"), 900);
    } catch {
      fail(texts().page.linkBarred(address), null);
    }
  }
}

function plain(title: string, paths: string, press: () => void): HTMLElement {
  return h("button", { class: "plain", title, onclick: press }, icon(paths));
}

/** Goes from theme to theme; `where` says on which pages. */
export function themeButton(viewerTheme: ViewerTheme, where: "wide" | "narrow"): HTMLElement {
  const { isFixed, theme, shown } = viewerTheme;
  const button = h("button", {
    class: `plain ${where}`,
    hidden: isFixed,
    title: computed(() => texts().page.themes[theme.value]),
    onclick: () => viewerTheme.next(),
  });
  follow(() => button.replaceChildren(icon(kIcons[shown.value])));
  return button;
}
