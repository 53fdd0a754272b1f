import type { JsonReader } from "../sog/json_reader";
import type { KeptKind } from "./keeper";
import { type FileKind, formatKept, readKept, wordsOf } from "./kept_file";
import { kLongestName, kLongestNote } from "./marks";

// Tours of a case, and the files that hold them: docs/format.md. The twin of src/tour/tour_file.cpp.

/** A view that was saved, with what is said of it. */
export interface Stop {
  id: string;
  name: string;
  text: string;
  /** What is shown, in the words of the viewer's address (link.ts). */
  show: string;
  /** Seconds of the flight there, and of the stay. */
  fly: number;
  stay: number;
}

export const kMostStops = 100;
export const kLongestFlight = 60; // s
export const kLongestStay = 600;
const kFlight = 3;
const kStay = 5;
const kLongestId = 40;
/** Characters: words with as many marks as a case may have, without notes. */
const kLongestShow = 40_000;
const kFile: FileKind = {
  name: "tour",
  list: "stops",
  most: kMostStops,
  isNone: "not a tour",
  all: "a tour",
};

/** A stop at what is shown. */
export function makeStop(show: string, name: string, text = ""): Stop {
  const id = `${Date.now().toString(36)}${Math.random().toString(36).slice(2, 8)}`;
  return shortened({ id, name, text, show, fly: kFlight, stay: kStay });
}

/** With one more, after the one of that id, or else at the end; null: there are too many. */
export function withStop(stops: readonly Stop[], stop: Stop, after: string | null = null): Stop[] | null {
  const at = 1 + stops.findIndex(({ id }) => id === after) || stops.length;
  return stops.length < kMostStops ? [...stops.slice(0, at), stop, ...stops.slice(at)] : null;
}

export function withoutStop(stops: readonly Stop[], id: string): Stop[] {
  return stops.filter((stop) => stop.id !== id);
}

export function withChange(stops: readonly Stop[], id: string, change: Partial<Omit<Stop, "id">>): Stop[] {
  return stops.map((stop) => (stop.id === id ? shortened({ ...stop, ...change }) : stop));
}

/** As files hold it. */
function shortened(stop: Stop): Stop {
  return { ...stop, name: stop.name.slice(0, kLongestName), text: stop.text.slice(0, kLongestNote) };
}

/** Two of one id, as people who write files have them, are two. */
function withOwnIds(stops: readonly Stop[]): Stop[] {
  const ids = new Set<string>();
  return stops.map((stop) => {
    let { id } = stop;
    for (let i = 2; ids.has(id); ++i) {
      id = `${stop.id.slice(0, kLongestId - 4)}-${i}`;
    }
    ids.add(id);
    return { ...stop, id };
  });
}

/** One place earlier (−1) or later (1), where there is one. */
export function withMove(stops: readonly Stop[], id: string, by: -1 | 1): readonly Stop[] {
  const from = stops.findIndex((stop) => stop.id === id);
  const to = from + by;
  if (from < 0 || to < 0 || to >= stops.length) {
    return stops;
  }
  const moved = withoutStop(stops, id);
  moved.splice(to, 0, stops[from]!);
  return moved;
}

/** What a file holds of a tour of a volume; "": that is not known. */
export function formatTour(stops: readonly Stop[], volume: string): string {
  const all = stops.map(({ id, name, text, show, fly, stay }) => ({
    id,
    ...(name ? { name } : {}),
    ...(text ? { text } : {}),
    show,
    fly,
    stay,
  }));
  return formatKept(kFile, volume, all);
}

function readStop(reader: JsonReader): Stop {
  const show = reader.text("show");
  return {
    id: reader.text("id").slice(0, kLongestId),
    name: wordsOf(reader, "name", kLongestName),
    text: wordsOf(reader, "text", kLongestNote),
    show: show.length <= kLongestShow ? show.replace(/^#/, "") : reader.fail("show"),
    fly: reader.has("fly") ? reader.number("fly", 0, kLongestFlight) : kFlight,
    stay: reader.has("stay") ? reader.number("stay", 0, kLongestStay) : kStay,
  };
}

/**
 * Reads a tour of `volume`; `name` is what errors call the file. Throws CaseError where it is not one, is of a newer
 * version or of another volume, or has too many stops.
 */
export function parseTour(text: string, name: string, volume: string): Stop[] {
  return withOwnIds(readKept(text, name, volume, kFile).map(readStop));
}

export const kTourFile: KeptKind<Stop> = {
  name: "tour",
  most: kMostStops,
  ordered: true,
  format: formatTour,
  parse: parseTour,
};
