import { CaseError } from "./zip";

/** A file and what is to be done where it is wrong. */
export interface JsonFile {
  name: string;
  remedy: string;
}

const kMetaFile: JsonFile = { name: "meta.json", remedy: "build the case again" };

/**
 * Reads one object of a file: every value is checked as it is asked for, and what is missing or out of range is called by
 * its full name. Throws CaseError.
 */
export class JsonReader {
  readonly #object: Record<string, unknown>;
  readonly #name: string;
  readonly #file: JsonFile;

  /** `name` is what errors call the object. */
  constructor(object: unknown, name: string, file = kMetaFile) {
    this.#name = name;
    this.#file = file;
    if (typeof object !== "object" || object === null || Array.isArray(object)) {
      throw new CaseError(`${file.name}: ${name} is not an object; ${file.remedy}`);
    }
    this.#object = object as Record<string, unknown>;
  }

  fail(key: string): never {
    this.refuse(key, "is missing or out of range");
  }

  /** Throws CaseError that says what is wrong. */
  refuse(key: string, why: string): never {
    const { name, remedy } = this.#file;
    throw new CaseError(`${name}: ${this.#name}.${key} ${why}; ${remedy}`);
  }

  has(key: string): boolean {
    return Object.hasOwn(this.#object, key);
  }

  value(key: string): unknown {
    return this.has(key) ? this.#object[key] : this.fail(key);
  }

  child(key: string): JsonReader {
    return new JsonReader(this.value(key), `${this.#name}.${key}`, this.#file);
  }

  /** The elements of a list of objects, at most `most` of them. */
  children(key: string, most: number): JsonReader[] {
    const list = this.value(key);
    if (!Array.isArray(list) || list.length > most) {
      this.fail(key);
    }
    return list.map((one, i) => new JsonReader(one, `${this.#name}.${key}[${i}]`, this.#file));
  }

  /** Exactly `count` finite numbers in [least, most]. */
  numbers(key: string, count: number, least = -Infinity, most = Infinity): number[] {
    const list = this.value(key);
    const fits = (v: unknown) => Number.isFinite(v) && (v as number) >= least && (v as number) <= most;
    if (!Array.isArray(list) || list.length !== count || !list.every(fits)) {
      this.fail(key);
    }
    return list as number[];
  }

  number(key: string, least = -Infinity, most = Infinity): number {
    const value = this.value(key) as number;
    return Number.isFinite(value) && value >= least && value <= most ? value : this.fail(key);
  }

  integer(key: string, least: number, most: number): number {
    const value = this.number(key, least, most);
    return Number.isInteger(value) ? value : this.fail(key);
  }

  vector(key: string, least = -Infinity, most = Infinity): [number, number, number] {
    return this.numbers(key, 3, least, most) as [number, number, number];
  }

  text(key: string): string {
    const value = this.value(key);
    return typeof value === "string" ? value : this.fail(key);
  }
}
