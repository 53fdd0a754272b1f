import { effect, type ReadonlySignal, Signal, untracked } from "@preact/signals-core";

/** A value, or one that follows what is shown. */
export type Live<T> = T | ReadonlySignal<T>;
type Attribute = Live<string | boolean | null> | ((event: Event) => void);
type Child = Node | null | Live<string>;

let owner: (() => void)[] | null = null;

/** What `make` makes, and what ends its following of signals. */
export function owned<T>(make: () => T): [made: T, end: () => void] {
  const before = owner;
  const ends: (() => void)[] = [];
  owner = ends;
  try {
    return [make(), () => ends.splice(0).forEach((end) => end())];
  } finally {
    owner = before;
  }
}

/** Does `work` now, and again whenever what it reads is another, until its owner ends. */
export function follow(work: () => void): void {
  if (!owner) {
    throw new Error("what follows signals belongs to somebody who ends it: see owned()");
  }
  owner.push(effect(work));
}

/** Attributes of ARIA say "false"; others are left out for it, and all for null. What a field holds is its property. */
function set(element: Element, name: string, value: string | boolean | null): void {
  if (name === "value") {
    const field = element as HTMLInputElement;
    if (field.value !== value) {
      field.value = String(value ?? "");
    }
  } else if (value === null || (value === false && !name.startsWith("aria-"))) {
    element.removeAttribute(name);
  } else {
    element.setAttribute(name, value === true && !name.startsWith("aria-") ? "" : String(value));
  }
}

function isSignal<T>(value: Live<T> | ((event: Event) => void)): value is ReadonlySignal<T> {
  return value instanceof Signal;
}

function node(child: Exclude<Child, null>): Node | string {
  if (child instanceof Node || !isSignal(child)) {
    return child;
  }
  const text = document.createTextNode("");
  follow(() => (text.data = child.value));
  return text;
}

/** An element: attributes by name, listeners as onclick and the like; attributes and texts follow signals. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, Attribute> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  element.append(...children.filter((child) => child !== null).map(node));
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") {
      element.addEventListener(name.slice(2), value);
    } else if (isSignal(value)) {
      follow(() => set(element, name, value.value));
    } else {
      set(element, name, value);
    }
  }
  return element;
}

/** Shows a child for each item, in their order; it is made anew only for another item. */
export function each<T>(
  parent: Element,
  items: ReadonlySignal<readonly T[]>,
  make: (item: T) => Element,
): void {
  let shown = new Map<T, [element: Element, end: () => void]>();
  follow(() => {
    const before = shown;
    shown = new Map(
      items.value.map((item) => [item, before.get(item) ?? owned(() => untracked(() => make(item)))]),
    );
    for (const [item, [, end]] of before) {
      if (!shown.has(item)) {
        end();
      }
    }
    parent.replaceChildren(...[...shown.values()].map(([element]) => element));
  });
  owner!.push(() => shown.forEach(([, end]) => end()));
}

/** An element of a drawing. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: Node[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) {
    element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** A drawing of the icon set: paths in a 24 × 24 box, stroked in the text's colour. */
export function icon(paths: string): SVGSVGElement {
  const lines = paths.split("|").map((d) => svg("path", { d }));
  return svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true", class: "icon" }, ...lines);
}

export const kIcons = {
  axial: "M4 12h16|M12 4c4 0 6 3.6 6 8s-2 8-6 8-6-3.6-6-8 2-8 6-8z",
  coronal: "M12 4c4 0 6 3.6 6 8s-2 8-6 8-6-3.6-6-8 2-8 6-8z|M7 6.500l10 11|M17 6.500l-10 11",
  sagittal: "M12 4c4 0 6 3.6 6 8s-2 8-6 8-6-3.600-6-8 2-8 6-8z|M12 2.500v19",
  flip: "M4 12h16|M8 8l4-4 4 4|M8 16l4 4 4-4",
  reset: "M4.500 12a7.500 7.500 0 1 0 2.300-5.400|M4.500 4.500v3.500h3.500",
  undo: "M8.500 5l-4 4 4 4|M4.500 9h9a5.500 5.500 0 0 1 0 11h-4",
  redo: "M15.500 5l4 4-4 4|M19.500 9h-9a5.500 5.500 0 0 0 0 11h4",
  eye: "M2.500 12s3.500-6.500 9.500-6.500 9.500 6.500 9.500 6.500-3.500 6.500-9.500 6.500-9.500-6.500-9.500-6.500z|M12 9.200a2.800 2.800 0 1 0 0 5.600 2.800 2.800 0 0 0 0-5.600z",
  point:
    "M12 21s-6.500-6.200-6.500-11a6.500 6.500 0 0 1 13 0c0 4.800-6.500 11-6.500 11z|M12 7.800a2.200 2.200 0 1 0 0 4.400 2.200 2.200 0 0 0 0-4.400z",
  length: "M5 4v16|M19 4v16|M5 12h14|M8 9l-3 3 3 3|M16 9l3 3-3 3",
  angle: "M4 19h16|M4 19L17 6|M11 19a7 7 0 0 0-2-5",
  region: "M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16z|M12 12v.2",
  outline: "M5 8l8-3.500 6 5-2 9-9 1z",
  close: "M6 6l12 12|M18 6L6 18",
  slab: "M3 9l9-4 9 4-9 4z|M3 15l9 4 9-4",
  plus: "M12 5v14|M5 12h14",
  minus: "M5 12h14",
  power: "M12 3.500v8|M6.800 6.800a7.500 7.500 0 1 0 10.400 0",
  chevron: "M7 10l5 5 5-5",
  link: "M10 14a4 4 0 0 0 5.700 0l3-3a4 4 0 0 0-5.700-5.700l-1 1|M14 10a4 4 0 0 0-5.700 0l-3 3a4 4 0 0 0 5.700 5.700l1-1",
  help: "M9.200 9.300a2.800 2.800 0 1 1 4.200 2.500c-.9.500-1.400 1-1.400 2|M12 17v.2",
  headset:
    "M3.500 8.500h17a1 1 0 0 1 1 1v6a2 2 0 0 1-2 2h-3.500l-2.500-3h-3l-2.500 3h-3.500a2 2 0 0 1-2-2v-6a1 1 0 0 1 1-1z|M7 8.500c.800-2 2.600-3 5-3s4.200 1 5 3",
  passthrough:
    "M4 10.500l8-6.500 8 6.500v9h-16z|M8.500 13h7a1 1 0 0 1 1 1v1.500a1.500 1.500 0 0 1-1.500 1.500h-1l-1.200-1.500h-1.600l-1.200 1.500h-1a1.500 1.500 0 0 1-1.500-1.500v-1.500a1 1 0 0 1 1-1z",
  expert: "M4 7h9|M17 7h3|M15 4.500v5|M4 17h3|M11 17h9|M9 14.500v5",
  camera:
    "M4 8h3.500l1.500-2.500h6l1.500 2.500h3.500v11h-16z|M12 10.300a3.200 3.200 0 1 0 0 6.400 3.200 3.200 0 0 0 0-6.400z",
  fullScreen: "M4.500 9v-4.500h4.500|M15 4.500h4.500v4.500|M19.500 15v4.500h-4.500|M9 19.500h-4.500v-4.500",
  looks:
    "M4 4.500h6.500v6.500h-6.500z|M13.500 4.500h6.500v6.500h-6.500z|M4 14h6.500v6.500h-6.500z|M13.500 14h6.500v6.500h-6.500z",
  dark: "M19.500 14.500a8 8 0 1 1-10-10 6.500 6.500 0 0 0 10 10z",
  light:
    "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8z|M12 2.500v2|M12 19.500v2|M2.500 12h2|M19.500 12h2|M5.300 5.300l1.400 1.400|M17.300 17.300l1.400 1.400|M5.300 18.700l1.400-1.400|M17.300 6.700l1.400-1.400",
  slices: "M4 4.500h16v15h-16z|M12 4.500v15|M12 12h8",
  play: "M7.500 5l11 7-11 7z",
  pause: "M8 5v14|M16 5v14",
  previous: "M17.500 5.500l-9 6.500 9 6.500z|M6 5.500v13",
  next: "M6.500 5.500l9 6.500-9 6.500z|M18 5.500v13",
  up: "M6.500 14.500l5.500-5.500 5.500 5.500",
  edit: "M4.500 19.500l1-4 10.500-10.500 3 3-10.500 10.500z",
  warning: "M12 4l9 16h-18z|M12 10v4.500|M12 17.200v.2",
} as const;
