import { kNoAnswer } from "../model/case_list";
import { CaseError } from "../sog/zip";
import type { Plan } from "./plan";

const kSessions = "api/study/sessions";
const kRetryMs = 2000;
const kStored = "clipgs-study/";

/** A record without its number: `kind` and the fields that src/study/records.h lists. */
export type Entry = Readonly<Record<string, unknown> & { kind: string }>;

interface Summary {
  session: string;
  plan: string;
  records: number;
  ended: boolean;
}

/** Where the browser keeps what the server may not have yet. */
export type Store = Pick<Storage, "getItem" | "setItem" | "removeItem">;

/**
 * What a session has recorded. It is kept in the browser before it is sent, and sent until the server says that it is on
 * its disk: neither a lost network nor a power cut, here or there, loses or doubles a record.
 */
export class Journal {
  /** "p007-3f9c2a1b" */
  readonly session: string;
  /** What keeps a record from being stored, for the experimenter; null: nothing. */
  trouble: string | null = null;
  changed: () => void = () => {};
  readonly #store: Store;
  readonly #lines: string[];
  #sent: number; // of the lines, those that the server has
  #ended = new AbortController();

  private constructor(session: string, lines: string[], sent: number, store: Store) {
    this.session = session;
    this.#lines = lines;
    this.#sent = sent;
    this.#store = store;
  }

  /** Begins a participant's session, which nothing is recorded of yet. */
  static begin(participant: number, store: Store): Journal {
    const hash = crypto.getRandomValues(new Uint32Array(1))[0]!.toString(16).padStart(8, "0");
    return new Journal(`p${String(participant).padStart(3, "0")}-${hash}`, [], 0, store);
  }

  /**
   * Goes on with the participant's session that has not ended; null: there is none. Throws CaseError where the server
   * does not answer, one has ended, or it follows another text of the plan.
   */
  static async resume(plan: Plan, participant: number, store: Store): Promise<Journal | null> {
    const all = (await (await ask(`${kSessions}?participant=${participant}`)).json()) as Summary[];
    const sessions = all.filter((one) => one.plan === plan.name);
    if (sessions.some(({ ended }) => ended)) {
      throw new CaseError(`participant ${participant} has taken part already; choose another number`);
    }
    const last = sessions.at(-1);
    if (!last) {
      return null;
    }
    const there = linesOf(await (await ask(`${kSessions}/${last.session}`)).text());
    const here = linesOf(store.getItem(kStored + last.session) ?? "");
    const journal = new Journal(last.session, [...there, ...here.slice(there.length)], there.length, store);
    if (journal.entries[0]?.["digest"] !== plan.digest) {
      throw new CaseError(
        `participant ${participant} began with another text of ${plan.name}; put that plan back, or choose another number`,
      );
    }
    return journal;
  }

  get entries(): Entry[] {
    return this.#lines.map((line) => JSON.parse(line) as Entry);
  }

  /** All of it, a line a record. */
  get text(): string {
    return textOf(this.#lines);
  }

  /** Records something; resolves when it is on the server's disk, however long that takes. */
  async add(entry: Entry): Promise<void> {
    this.#lines.push(JSON.stringify({ seq: this.#lines.length, ...entry }));
    await this.send();
  }

  /** Sends what the server does not have, again and again; `trouble` says why it takes long. */
  async send(): Promise<void> {
    this.#keep();
    while (this.#sent < this.#lines.length && !this.#ended.signal.aborted) {
      const trouble = await this.#post();
      if (trouble !== this.trouble) {
        this.trouble = trouble;
        this.changed();
      }
      if (trouble) {
        await new Promise((resolve) => setTimeout(resolve, kRetryMs));
      }
    }
    if (!this.#ended.signal.aborted) {
      this.#store.removeItem(kStored + this.session);
    }
  }

  /** Sends no more. */
  dispose(): void {
    this.#ended.abort();
  }

  /** Returns what is wrong, or null. */
  async #post(): Promise<string | null> {
    const body = textOf(this.#lines.slice(this.#sent));
    const headers = { "Content-Type": "application/jsonl" };
    try {
      const { signal } = this.#ended;
      const response = await fetch(`${kSessions}/${this.session}`, { method: "POST", headers, body, signal });
      const text = await response.text();
      if (response.ok) {
        this.#sent = (JSON.parse(text) as { records: number }).records;
        return null;
      }
      return response.status === 409 ? (JSON.parse(text) as { error: string }).error : text.trim();
    } catch {
      return kNoAnswer;
    }
  }

  /** In the browser, where it can be. */
  #keep(): void {
    try {
      this.#store.setItem(kStored + this.session, this.text);
    } catch {
      // Full or forbidden: the server has it soon, or the trouble is said.
    }
  }
}

function textOf(lines: readonly string[]): string {
  return lines.map((line) => `${line}\n`).join("");
}

function linesOf(text: string): string[] {
  return text.split("\n").filter((line) => line !== "");
}

/** Throws CaseError, with the server's own words where it says why. */
async function ask(url: string): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(url);
  } catch {
    throw new CaseError(kNoAnswer);
  }
  if (!response.ok) {
    throw new CaseError((await response.text()).trim() || kNoAnswer);
  }
  return response;
}

/** Fetches a plan's text. Throws CaseError. */
export async function fetchPlan(name: string): Promise<string> {
  return (await ask(`study/${encodeURIComponent(name)}`)).text();
}
