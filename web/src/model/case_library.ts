import { language, texts } from "../text/text";
import { type CaseIndex, type CaseSummary, formatBytes } from "./case_list";
import { type CaseGroup, groupCases } from "./looks";

/** What cases can be sorted by. */
export const kCaseOrders = ["title", "date", "size", "region"] as const;
export type CaseOrder = (typeof kCaseOrders)[number];

/** What the server has, and what it makes that is not there yet; of that, what went wrong is the case's error. */
export function libraryCases({ cases, making }: CaseIndex): readonly CaseSummary[] {
  const there = new Set(cases.map(({ name }) => name));
  const coming = (making ?? []).filter(({ name }) => !there.has(name));
  return [...cases, ...coming.map(({ name, error }) => comingCase(name, error))];
}

function comingCase(name: string, error: string | null): CaseSummary {
  const nothing = { bytes: 0, version: "", trained: 0, preset: "", look: null, created: "", splats: 0 };
  return { ...nothing, name, title: name, file: "", thumbnail: null, error };
}

/** The region of the body in the reader's language; "" where it is not known. */
export function regionText(one: CaseSummary): string {
  const regions: Readonly<Record<string, string>> = texts().library.regions;
  return regions[one.look?.region ?? ""] ?? "";
}

let dates: { of: string; format: Intl.DateTimeFormat } | null = null;

/** The day on which a case was made, as its reader writes days; "" where it is not known. */
export function dateText({ created }: CaseSummary): string {
  const day = new Date(created);
  if (Number.isNaN(day.getTime())) {
    return "";
  }
  if (dates?.of !== language()) {
    // Making one takes as long as using it on hundreds of cases.
    const format = new Intl.DateTimeFormat(language(), { dateStyle: "medium", timeZone: "UTC" });
    dates = { of: language(), format };
  }
  return dates.format.format(day);
}

/** Region, size and date, as far as they are known. */
export function detailText(one: CaseSummary): string {
  const size = one.bytes > 0 ? formatBytes(one.bytes) : "";
  const parts = [regionText(one), size, dateText(one)].filter((text) => text !== "");
  return parts.map((text) => text.replaceAll(" ", "\u00a0")).join(" · "); // lines break between them
}

/** Without capitals and marks on letters: what looks alike is alike. */
function folded(text: string): string {
  // Up and down again, so that ß and ẞ are ss.
  return text.normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase().toUpperCase().toLowerCase();
}

const kept = new WeakMap<CaseSummary, { of: string; text: string }>();

/** All that a case is found by. */
function searchText(one: CaseSummary): string {
  const before = kept.get(one);
  if (before?.of === language()) {
    return before.text;
  }
  const { title, name, preset, look } = one;
  const words = [title, `${name}.sog`, regionText(one), look?.region, look?.modality, look?.title, preset];
  const text = folded(words.join("\n"));
  kept.set(one, { of: language(), text });
  return text;
}

/** Those in whose title, file name, region, modality or look all words of the search are, whatever their capitals and accents. */
export function searchCases(cases: readonly CaseSummary[], search: string): readonly CaseSummary[] {
  const words = folded(search).split(/\s+/).filter(Boolean);
  return words.length === 0
    ? cases
    : cases.filter((one) => words.every((word) => searchText(one).includes(word)));
}

/** The newest or largest first, titles and regions by the alphabet; what is not known last, and what is alike by title. */
export function sortCases(cases: readonly CaseSummary[], order: CaseOrder): CaseSummary[] {
  const { compare } = new Intl.Collator(language(), { numeric: true, sensitivity: "base" });
  const byTitle = (a: CaseSummary, b: CaseSummary) => compare(a.title, b.title) || compare(a.name, b.name);
  const orders: Record<CaseOrder, (a: CaseSummary, b: CaseSummary) => number> = {
    title: () => 0,
    date: (a, b) => (a.created < b.created ? 1 : a.created > b.created ? -1 : 0),
    size: (a, b) => b.bytes - a.bytes,
    region: (a, b) => {
      const [first, second] = [regionText(a), regionText(b)];
      return Number(first === "") - Number(second === "") || compare(first, second);
    },
  };
  return [...cases].sort((a, b) => orders[order](a, b) || byTitle(a, b));
}

/** What is found, in that order; looks of a volume stand where the first of them does. */
export function findCases(cases: readonly CaseSummary[], search: string, order: CaseOrder): CaseGroup[] {
  return groupCases(sortCases(searchCases(cases, search), order));
}

/** A part of a list that is shown page by page: `page` from 0, or the last one where there are fewer. */
export function pageOf<T>(
  items: readonly T[],
  page: number,
  size: number,
): { items: readonly T[]; page: number; pages: number } {
  const pages = Math.max(1, Math.ceil(items.length / size));
  const shown = Math.min(Math.max(0, page), pages - 1);
  return { items: items.slice(shown * size, (shown + 1) * size), page: shown, pages };
}
