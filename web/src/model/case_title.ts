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
 * The title that its maker gave, or else what is shown of it and how: "Head, skin and bone", the twin of usual_title() in
 * src/core/volume_look.cpp. Cases that were made before that was told have the look's name alone.
 */
export function shownTitle(one: Named): string {
  const { title, preset, look } = one;
  const isLook = [preset, look?.title].some((name) => name && bare(name) === bare(title));
  return title.trim() !== "" && !isLook ? title : usualTitle(one);
}

function usualTitle({ title, preset, look }: Named): string {
  const own = title === preset ? "" : title.trim();
  const shown = withinTitle(look?.title || own || preset.replaceAll("-", " "));
  const subject = look?.region || look?.modality || "volume";
  const begin = subject[0]!.toUpperCase() + subject.slice(1);
  if (shown === "") {
    return begin;
  }
  if (shown.startsWith(subject)) {
    const isPhoto = subject === "photographs";
    return isPhoto ? "Photographic volume" : `${begin} volume${shown.slice(subject.length)}`;
  }
  return `${begin}, ${shown}`;
}

/** "MR" and "X-ray" stay as they are. */
function withinTitle(text: string): string {
  return /^.\p{Ll}/u.test(text) ? text[0]!.toLowerCase() + text.slice(1) : text;
}
