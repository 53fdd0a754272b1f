import type { Triple } from "./geometry";

/** What lies behind a case: two colours, display sRGB in [0, 1], with an even gradient from top to bottom. */
export interface Backdrop {
  title: string; // for people
  top: Triple;
  bottom: Triple;
  isBright: boolean; // whether dark text is read on it
}

function ofBytes(r: number, g: number, b: number): Triple {
  return [r / 255, g / 255, b / 255];
}

/** By the names that `clipgs render --background` knows: the twins of named_backgrounds() in src/core/background.cpp. */
export const kBackdrops: ReadonlyMap<string, Backdrop> = new Map([
  ["black", { title: "Black", top: [0, 0, 0], bottom: [0, 0, 0], isBright: false }],
  ["white", { title: "White", top: [1, 1, 1], bottom: [1, 1, 1], isBright: true }],
  [
    "studio",
    {
      title: "Studio",
      top: ofBytes(0x2e, 0x36, 0x42),
      bottom: ofBytes(0x0a, 0x0c, 0x10),
      isBright: false,
    },
  ],
  [
    "paper",
    {
      title: "Paper",
      top: ofBytes(0xfb, 0xfa, 0xf7),
      bottom: ofBytes(0xe2, 0xdf, 0xd8),
      isBright: true,
    },
  ],
]);
