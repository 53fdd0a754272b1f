import type { ReadonlySignal } from "@preact/signals-core";

import { h, icon, type Live } from "./dom";

/** A button of several that stand together. */
export interface Segment {
  text: Live<string>;
  hint?: Live<string | null>;
  icon?: string;
  pressed?: ReadonlySignal<boolean>;
  disabled?: Live<boolean>;
  hidden?: Live<boolean>;
  press: () => void;
}

/** Buttons that stand together; `classes` are further ones. */
export function segments(name: string, parts: readonly Segment[], classes = ""): HTMLElement {
  return h(
    "div",
    { class: `segments ${classes}`.trim(), role: "group", "aria-label": name },
    ...parts.map(segment),
  );
}

export function segment({
  text,
  hint,
  icon: drawing,
  pressed,
  disabled,
  hidden,
  press,
}: Segment): HTMLElement {
  return h(
    "button",
    {
      title: hint ?? null,
      "aria-pressed": pressed ?? null,
      disabled: disabled ?? false,
      hidden: hidden ?? false,
      onclick: press,
    },
    drawing ? icon(drawing) : null,
    text,
  );
}

/** One choice of several, by its name. */
export function choices<T extends string>(
  name: string,
  texts: Readonly<Record<T, string>>,
  chosen: (one: T) => ReadonlySignal<boolean>,
  choose: (one: T) => void,
  more: (one: T) => Partial<Segment> = () => ({}),
): HTMLElement {
  return segments(
    name,
    (Object.keys(texts) as T[]).map((one) => ({
      text: texts[one],
      pressed: chosen(one),
      press: () => choose(one),
      ...more(one),
    })),
  );
}
