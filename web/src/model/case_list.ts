import { CaseError } from "../sog/zip";
import { texts } from "../text/text";
import type { CaseInMaking } from "./case_news";
import { shownTitle, spokenLook } from "./case_title";

/** Which volume a case shows, and how (docs/format.md). */
export interface CaseLook {
  volume: string;
  title: string;
  description: string;
  /** "CT", "MR", …; absent where it is not known. */
  modality?: string;
  /** Of the body; absent where it is not known. */
  region?: string;
}

/** One case of the server's index; a broken one has an error instead of a file. */
export interface CaseSummary {
  name: string;
  bytes: number;
  /** Another one, whenever the file is another. */
  version: string;
  /** Of the training that it is to have, 0 … 1. */
  trained: number;
  title: string;
  preset: string;
  look: CaseLook | null;
  /** ISO 8601; "": not known. */
  created: string;
  splats: number;
  /** "": it is being made, and not there yet. */
  file: string;
  thumbnail: string | null;
  error: string | null;
}

/** A case on its way: so much of it is there, 0 … 1. */
export type LoadingCase = Pick<CaseSummary, "title" | "thumbnail" | "bytes"> & { share: number };

/** What the server has. */
export interface CaseIndex {
  cases: CaseSummary[];
  /** What it makes meanwhile; null: it makes none, and does not want to know who looks. */
  making: CaseInMaking[] | null;
  /** Whether marks of its cases may be changed. */
  keepsMarks: boolean;
  /** Whether their tours may be. */
  keepsTours: boolean;
}

/** Where the server has the case of this name, or what lies beside it: `cardiology/head` is in a folder below the served one. */
export function caseFile(name: string, ending = "sog"): string {
  return `cases/${name.split("/").map(encodeURIComponent).join("/")}.${ending}`;
}

export const kNoAnswer = "the server does not answer; is clipgs serve still running?";

/**
 * Asks the server what cases there are, and tells it who asks, if anybody wants to be counted. Throws CaseError, with the
 * server's own words where it says why.
 */
export async function fetchIndex(page = ""): Promise<CaseIndex> {
  let refusal: string | undefined;
  let index: {
    cases: Partial<CaseSummary>[];
    making?: Partial<CaseInMaking>[];
    keeps_marks?: boolean;
    keeps_tours?: boolean;
  };
  try {
    const response = await fetch(page ? `api/cases?page=${page}` : "api/cases");
    if (!response.ok) {
      const said = response.headers.get("Content-Type")?.startsWith("text/plain");
      refusal = said ? (await response.text()).trim() : undefined;
      throw new Error(String(response.status));
    }
    index = (await response.json()) as typeof index;
  } catch {
    throw new CaseError(refusal || kNoAnswer);
  }
  const cases = index.cases.map((one) => ({
    name: one.name ?? "",
    bytes: one.bytes ?? 0,
    version: one.version ?? "",
    trained: one.trained ?? 1,
    title: one.error ? (one.name ?? "") : shownTitle({ title: "", preset: "", look: null, ...one }),
    preset: one.preset ?? "",
    look: spokenLook(one.look ?? null, one.preset ?? ""),
    created: one.created ?? "",
    splats: one.splats ?? 0,
    file: one.file ?? caseFile(one.name ?? ""),
    thumbnail: one.thumbnail ?? null,
    error: one.error ?? null,
  }));
  const making = index.making?.map((one) => ({
    name: one.name ?? "",
    quality: one.quality ?? "",
    seconds: one.seconds ?? null,
    error: one.error ?? null,
  }));
  return {
    cases,
    making: making ?? null,
    keepsMarks: index.keeps_marks ?? false,
    keepsTours: index.keeps_tours ?? false,
  };
}

/** Tells the server that the page of this name is closed. */
export function sayGoodbye(page: string): void {
  void fetch(`api/cases?page=${page}&left`, { keepalive: true }).catch(() => {});
}

/** Why the case of this name could not be opened, in a line that names it. */
export function failureText(name: string, error: unknown): string {
  const text = error instanceof Error ? error.message : String(error);
  return text.startsWith(name) ? text : `${name}: ${text}`;
}

/** 4.2 MB. */
export function formatBytes(bytes: number): string {
  return bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1e3))} KB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

/** "2.1 of 3.9 MB"; of 0 bytes, which nobody knows, "2.1 MB". */
export function amountText(loaded: number, total: number): string {
  if (total <= 0) {
    return formatBytes(loaded);
  }
  const unit = total < 1e6 ? 1e3 : 1e6;
  return texts().loading.amount((loaded / unit).toFixed(total < 1e6 ? 0 : 1), formatBytes(total));
}

/** 83 412: thousands apart. */
export function formatCount(count: number): string {
  return String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");
}
