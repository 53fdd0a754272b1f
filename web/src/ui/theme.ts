import { computed, signal } from "@preact/signals-core";

import { Preference } from "./preference";

/** How the page's colours are chosen: as the system says, or always one of both. */
export const kThemes = ["auto", "dark", "light"] as const;
export type Theme = (typeof kThemes)[number];

/** A theme by its name; auto where there is none of that name. */
export function themeFrom(name: string | null): Theme {
  return kThemes.find((theme) => theme === name) ?? "auto";
}

const choice = new Preference("clipgs.theme", kThemes);
const bright = matchMedia("(prefers-color-scheme: light)");
const isBright = signal(bright.matches);
bright.addEventListener("change", () => (isBright.value = bright.matches));

/** The theme of one viewer: the user's choice, or what whoever embeds it says. */
export class ViewerTheme {
  readonly #fixed = signal<Theme>("auto");
  /** Whether it is not the user's to choose. */
  readonly isFixed = computed(() => this.#fixed.value !== "auto");
  readonly theme = computed(() => (this.isFixed.value ? this.#fixed.value : choice.value));
  /** What the viewer looks like now. */
  readonly shown = computed(() => {
    const theme = this.theme.value;
    return theme === "auto" ? (isBright.value ? "light" : "dark") : theme;
  });

  /** "auto": the user's choice. */
  fix(theme: Theme): void {
    this.#fixed.value = theme;
  }

  /** The user's next choice, unless it is not theirs. */
  next(): void {
    if (!this.isFixed.value) {
      choice.value = kThemes[(kThemes.indexOf(choice.value) + 1) % kThemes.length]!;
    }
  }
}
