import { english, type Texts } from "../text/en";
import { texts } from "../text/text";
import type { CaseLook } from "./case_list";

/** What is known of a case that says how it is called. */
interface Named {
  title: string;
  /** Its preset's name. */
  preset: string;
  look: Pick<CaseLook, "title" | "region" | "modality"> | null;
}

/** Letters and figures alone: "Skin and bone" is the title of skin-and-bone. */
const bare = (text: string) => text.toLowerCase().replace(/[^\p{L}\p{N}]/gu, "");

/**
 * The title that its maker gave, or else what is shown of it and how, in the language of the page: "Head, skin and bone".
 * Cases that were made before that was told have the look's name alone.
 */
export function shownTitle(one: Named): string {
  const { title, preset, look } = one;
  const isLook = [preset, look?.title].some((name) => name && bare(name) === bare(title));
  const isUsual = isLook || title.trim() === "" || title === usualTitle(one, english);
  return isUsual ? usualTitle({ ...one, look: spokenLook(look, preset) }, texts()) : title;
}

/** What files tell of a look in English, in the language of the page where it is of a preset that is known here. */
export function spokenLook<T extends { title: string; description?: string } | null>(
  look: T,
  preset: string,
): T {
  const [known, title, description] = texts().looks[preset] ?? [];
  return look && look.title === known ? { ...look, title, description } : look;
}

/** The begin of a title that is longer than there is room for where no style can cut it. */
export function inShort(title: string, most = 72): string {
  const letters = [...title];
  if (letters.length <= most) {
    return title;
  }
  const begin = letters.slice(0, most - 1).join("");
  return `${begin.trimEnd()}…`;
}

/** In English the twin of usual_title() in src/core/volume_look.cpp. */
function usualTitle({ title, preset, look }: Named, { usualTitles: words, library }: Texts): string {
  const own = title === preset ? "" : title.trim();
  const shown = words.within(look?.title || own || preset.replaceAll("-", " "));
  const regions: Readonly<Record<string, string>> = library.regions;
  const modality = look?.modality === "photographs" ? words.photographs : look?.modality;
  const subject = (look?.region && (regions[look.region] ?? look.region)) || modality || words.volume;
  const begin = subject[0]!.toUpperCase() + subject.slice(1);
  if (shown === "") {
    return begin;
  }
  if (shown.toLowerCase().startsWith(subject.toLowerCase())) {
    return subject === words.photographs
      ? words.photographic
      : words.whole(begin) + shown.slice(subject.length);
  }
  return `${begin}, ${shown}`;
}
