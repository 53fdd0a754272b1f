import { abortableEffect, Container, type ContainerProperties, Image, Text } from "@pmndrs/uikit";
import { computed, type ReadonlySignal, untracked } from "@preact/signals-core";
import type { PointerEvent } from "@pmndrs/pointer-events";
import { type Texture, Vector3 } from "three";

import { handOf } from "../hand";

/** What changes by itself as the viewer's state does. */
export type Live<T> = ReadonlySignal<T>;

const kText = "#e4e7ec";
const kQuiet = "#98a0ac";
const kDetail = "#c5ccd6"; // to be read on kOn, too
const kAccent = "#7fd8f2";
const kField = "#2a2f38";
const kFieldHover = "#3a414d";
const kOn = "#2f6f86";
const kOnHover = "#38809a";
/** px */
const kRadius = 9;
const kButtonHeight = 44;
const kFontSize = 17;
/** Of what says more, px: capitals of 0.7° on the panel, and none is smaller. */
export const kSmallFont = 16;
const kPicture = 60;
const kLargePicture = 96;

export function row(...children: Container[]): Container {
  const element = new Container({ flexDirection: "row", gap: 6, flexShrink: 0 });
  children.forEach((child) => element.add(child));
  return element;
}

export function column(properties: ContainerProperties, ...children: (Container | Text)[]): Container {
  const element = new Container({ flexDirection: "column", gap: 8, ...properties });
  children.forEach((child) => element.add(child));
  return element;
}

export function label(
  text: string | Live<string>,
  properties: { quiet?: boolean; size?: number; color?: string } = {},
): Text {
  return new Text({
    text,
    color: properties.color ?? (properties.quiet ? kQuiet : kText),
    fontSize: properties.size ?? kFontSize,
    flexShrink: 1,
  });
}

interface ButtonOptions {
  pressed?: Live<boolean>;
  enabled?: Live<boolean>;
  picture?: Texture;
  /** Below its text, all of it below the picture. */
  detail?: string;
  /** px */
  height?: number;
  /** Of its text, px. */
  size?: number;
}

/** Something to press: it ticks in the hand that does. */
export function button(
  text: string | Live<string>,
  press: () => void,
  { pressed, enabled, picture, detail, height = kButtonHeight, size }: ButtonOptions = {},
): Container {
  const isEnabled = () => enabled?.value ?? true;
  const element = new Container({
    flexGrow: 1,
    flexBasis: 0,
    minHeight: height,
    paddingX: 5,
    paddingY: 6,
    gap: 10,
    borderRadius: kRadius,
    flexDirection: detail ? "column" : "row",
    alignItems: "center",
    justifyContent: picture ? "flex-start" : "center",
    backgroundColor: computed(() => (pressed?.value ? kOn : kField)),
    opacity: computed(() => (isEnabled() ? 1 : 0.35)),
    hover: { backgroundColor: computed(() => (pressed?.value ? kOnHover : kFieldHover)) },
    onClick: (event: PointerEvent) => {
      if (isEnabled()) {
        handOf(event)?.pulse(0.3, 10);
        press();
      }
    },
  });
  if (picture) {
    element.add(
      new Image({
        src: picture,
        width: detail ? kLargePicture : kPicture,
        height: detail ? kLargePicture : kPicture,
        flexShrink: 0,
        borderRadius: 6,
        pointerEvents: "none",
      }),
    );
  }
  const caption = label(text, { size });
  caption.setProperties({ pointerEvents: "none" }); // pressed at its text and let go beside it is pressed
  caption.userData["enabled"] = isEnabled;
  element.add(detail ? withDetail(caption, detail) : caption);
  return element;
}

function withDetail(caption: Text, detail: string): Container {
  return column(
    { gap: 2, width: "100%", pointerEvents: "none" },
    caption,
    label(detail, { color: kDetail, size: kSmallFont }),
  );
}

/** Shows an element where this holds. */
export function when<T extends Container | Text>(shown: Live<boolean>, element: T): T {
  element.setProperties({ display: computed(() => (shown.value ? "flex" : "none")) });
  return element;
}

/** Shows in `parent` what `make` makes of this, anew whenever it is another. */
export function each<T>(parent: Container, of: Live<T>, make: (of: T) => (Container | Text)[]): Container {
  abortableEffect(() => {
    const now = of.value;
    untracked(() => replaceChildren(parent, make(now)));
  }, parent.abortSignal);
  return parent;
}

/** As high as it may be; the rest is scrolled to. */
export function scrolled(content: Container): Container {
  return new Container({ maxHeight: 420, overflow: "scroll", flexDirection: "column" }).add(content);
}

/** As wide as a button, where a row would have one. */
export function space(): Container {
  return new Container({ flexGrow: 1, flexBasis: 0 });
}

/** One of several: buttons side by side. */
export function choice<T extends string>(
  options: Record<T, string>,
  chosen: Live<T | null>,
  choose: (option: T) => void,
  enabled?: Live<boolean>,
): Container {
  return row(
    ...(Object.entries(options) as [T, string][]).map(([option, text]) =>
      button(text, () => choose(option), { pressed: computed(() => chosen.value === option), enabled }),
    ),
  );
}

interface Range {
  min: number;
  max: number;
  value: number;
}

/** A bar to point at or drag along. */
export function slider(range: Live<Range>, set: (value: number) => void): Container {
  const local = new Vector3();
  const share = computed(() => {
    const { min, max, value } = range.value;
    return max > min ? Math.min(1, Math.max(0, (value - min) / (max - min))) : 0;
  });
  let held: number | null = null; // the pointer that drags
  const element = new Container({
    height: kButtonHeight,
    flexShrink: 0,
    borderRadius: kRadius,
    backgroundColor: kField,
    hover: { backgroundColor: kFieldHover },
    alignItems: "stretch",
    overflow: "hidden",
  });
  const follow = ({ point }: PointerEvent) => {
    const { min, max } = range.value;
    const x = element.worldToLocal(local.copy(point)).x + 0.5;
    set(min + (max - min) * Math.min(1, Math.max(0, x)));
  };
  const letGo = (event: PointerEvent) => {
    held = event.pointerId === held ? null : held;
  };
  element.setProperties({
    onPointerDown: (event: PointerEvent) => {
      held = event.pointerId;
      element.setPointerCapture(event.pointerId);
      handOf(event)?.pulse(0.3, 10);
      follow(event);
    },
    onPointerMove: (event: PointerEvent) => {
      if (event.pointerId === held) {
        follow(event);
      }
    },
    onPointerUp: letGo,
    onPointerCancel: letGo,
  });
  return element.add(
    new Container({
      width: computed(() => `${100 * share.value}%` as const),
      backgroundColor: kOn,
      borderRightWidth: 3,
      borderColor: kAccent,
      pointerEvents: "none",
    }),
  );
}

/** How much of something is there, 0 … 1. */
export function progressBar(share: Live<number>): Container {
  const bar = new Container({ height: 8, borderRadius: 4, backgroundColor: kField, overflow: "hidden" });
  return bar.add(
    new Container({
      width: computed(() => `${100 * share.value}%` as const),
      backgroundColor: kAccent,
      borderRadius: 4,
    }),
  );
}

/** Where this text is shown in `root`, in the room; null: it is not, or on a button that cannot be pressed. */
export function findText(root: Container, text: string): Vector3 | null {
  let found: Vector3 | null = null;
  root.traverse((object) => {
    const isEnabled = (object.userData["enabled"] as (() => boolean) | undefined) ?? (() => true);
    if (
      object instanceof Text &&
      object.isVisible.value &&
      (object.properties.value as { text?: unknown }).text === text &&
      isEnabled()
    ) {
      object.updateWorldMatrix(true, false);
      found = new Vector3().setFromMatrixPosition(object.matrixWorld);
    }
  });
  return found;
}

export function replaceChildren(parent: Container, children: (Container | Text)[]): void {
  for (const child of [...parent.children]) {
    parent.remove(child);
    (child as Container).dispose();
  }
  children.forEach((child) => parent.add(child));
}
