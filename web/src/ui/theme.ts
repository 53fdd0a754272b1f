/** How the page's colours are chosen: as the system says, or always one of both. */
export const kThemes = ["auto", "dark", "light"] as const;
export type Theme = (typeof kThemes)[number];

const kKey = "clipgs.theme";
const kChosen = "chosen";

/** A theme by its name; auto where there is none of that name. */
export function themeFrom(name: string | null): Theme {
  return kThemes.find((theme) => theme === name) ?? "auto";
}

/** What this browser's user chose, for all viewers of a page; remembered where the browser lets it be. */
class ThemeChoice extends EventTarget {
  #theme: Theme;

  constructor() {
    super();
    this.#theme = themeFrom(stored());
  }

  get theme(): Theme {
    return this.#theme;
  }

  /** Chooses the next one. */
  next(): void {
    this.#theme = kThemes[(kThemes.indexOf(this.#theme) + 1) % kThemes.length]!;
    try {
      localStorage.setItem(kKey, this.#theme);
    } catch {
      // Storage is barred: the choice holds for this page.
    }
    this.dispatchEvent(new Event(kChosen));
  }
}

function stored(): string | null {
  try {
    return localStorage.getItem(kKey);
  } catch {
    return null;
  }
}

const choice = new ThemeChoice();
const light = matchMedia("(prefers-color-scheme: light)");

/** The theme of one viewer: the user's choice, or what whoever embeds it says. */
export class ViewerTheme {
  readonly #changed: () => void;
  #fixed: Theme = "auto";

  /** `changed` is called for every change until `signal` ends it. */
  constructor(changed: () => void, signal: AbortSignal) {
    this.#changed = changed;
    choice.addEventListener(kChosen, changed, { signal });
    light.addEventListener("change", changed, { signal });
  }

  /** "auto": the user's choice. */
  fix(theme: Theme): void {
    this.#fixed = theme;
    this.#changed();
  }

  get isFixed(): boolean {
    return this.#fixed !== "auto";
  }

  get theme(): Theme {
    return this.isFixed ? this.#fixed : choice.theme;
  }

  /** What the viewer looks like now. */
  get shown(): "dark" | "light" {
    const { theme } = this;
    return theme === "auto" ? (light.matches ? "light" : "dark") : theme;
  }

  /** The user's next choice, unless it is not theirs. */
  next(): void {
    if (!this.isFixed) {
      choice.next();
    }
  }
}
