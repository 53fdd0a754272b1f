import { kCodes, kFirstInside, type Section } from "../sog/section";
import { texts } from "../text/text";

/** Values from center − width/2 (black) to center + width/2 (white), as radiologists set it. */
export interface Window {
  center: number;
  width: number;
}

const kCtWindows = {
  softTissue: { center: 40, width: 400 },
  bone: { center: 400, width: 1800 },
  lung: { center: -600, width: 1500 },
  brain: { center: 40, width: 80 },
} as const satisfies Record<string, Window>;

function windowBetween(low: number, high: number): Window {
  return { center: 0.5 * (low + high), width: high - low };
}

/** From the 1st to the 99th percentile of what is not air around the body. */
function autoWindow({ counts, curve }: Section): Window {
  const total = counts.reduce((sum, n, code) => (code >= kFirstInside ? sum + n : sum), 0);
  const percentile = (share: number): number => {
    let below = 0;
    const code = counts.findIndex((n, i) => {
      below += i >= kFirstInside ? n : 0;
      return below >= share * total && i >= kFirstInside;
    });
    return curve[code]!;
  };
  const low = percentile(0.01);
  return windowBetween(low, Math.max(percentile(0.99), low + smallestWidth(curve)));
}

/** The windows that a section is usually seen through, by their names, the first of them at the start; none for photographs. */
export function windowPresets(section: Section): Map<string, Window> {
  if (section.channels === 3) {
    return new Map();
  }
  const t = texts().face.windows;
  if (section.modality === "CT") {
    return new Map(
      Object.entries(kCtWindows).map(([name, one]) => [t[name as keyof typeof kCtWindows], one]),
    );
  }
  const { curve } = section;
  return new Map([
    [t.auto, autoWindow(section)],
    [t.full, windowBetween(curve[kFirstInside]!, curve[kCodes - 1]!)],
  ]);
}

/** Narrower than this a window shows nothing. */
function smallestWidth(curve: readonly number[]): number {
  return (curve[kCodes - 1]! - curve[0]!) / 1000;
}

export function isSameWindow(a: Window, b: Window | null): boolean {
  return a.center === b?.center && a.width === b.width;
}

/** The window after a drag of (dx, dy) px: to the right wider, up to higher values. */
export function draggedWindow(
  { center, width }: Window,
  dx: number,
  dy: number,
  curve: readonly number[],
): Window {
  const least = smallestWidth(curve);
  const range = curve[kCodes - 1]! - curve[0]!;
  return {
    center: Math.min(curve[kCodes - 1]!, Math.max(curve[0]!, center - 0.003 * dy * width)),
    width: Math.min(2 * range, Math.max(least, width * Math.exp(0.005 * dx))),
  };
}

/** Where values of the codes lie in a window: 0 black, 1 white, beyond it outside. */
export function shades({ center, width }: Window, curve: readonly number[]): number[] {
  return curve.map((value) => (value - (center - 0.5 * width)) / width);
}
