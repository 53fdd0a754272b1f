import { texts } from "../text/text";
import type { CaseSummary } from "./case_list";

/** A case that the server makes while it serves it; `seconds` where it knows how many there are left. */
export interface CaseInMaking {
  name: string;
  quality: string;
  seconds: number | null;
  error: string | null;
}

/** About how long. */
function leftText(seconds: number): string {
  if (seconds < 90) {
    return `${Math.max(10, 10 * Math.round(seconds / 10))} s`;
  }
  return seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${Math.round(seconds / 3600)} h`;
}

function makingText({ quality: asked, seconds, error }: CaseInMaking): string {
  const qualities: Readonly<Record<string, string>> = texts().news.qualities;
  const quality = qualities[asked] ?? asked;
  if (error !== null) {
    return texts().news.stopped(quality, error);
  }
  const { follows, in: soon } = texts().news;
  return seconds === null ? follows(quality) : soon(quality, leftText(seconds));
}

/** What a case is that is not finished, and when there will be a better one: "Instant · standard in 6 min"; or nothing. */
export function newsText(
  shown: CaseSummary | undefined,
  making: readonly CaseInMaking[],
  name: string | null,
): string {
  const t = texts().news;
  const trained = shown?.trained ?? 1;
  const is = !shown || trained === 1 ? "" : trained === 0 ? t.instant : t.trained(Math.round(100 * trained));
  const next = making.find((one) => one.name === name);
  return [is, ...(next ? [makingText(next)] : [])].filter((text) => text !== "").join(" · ");
}
