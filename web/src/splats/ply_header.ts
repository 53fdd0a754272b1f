import { CaseError } from "../sog/zip";

const kMostHeader = 1 << 16; // bytes

type Reader = (view: DataView, at: number) => number;

const kReaders: [names: string, size: number, read: Reader][] = [
  ["char int8", 1, (view, at) => view.getInt8(at)],
  ["uchar uint8", 1, (view, at) => view.getUint8(at)],
  ["short int16", 2, (view, at) => view.getInt16(at, true)],
  ["ushort uint16", 2, (view, at) => view.getUint16(at, true)],
  ["int int32", 4, (view, at) => view.getInt32(at, true)],
  ["uint uint32", 4, (view, at) => view.getUint32(at, true)],
  ["float float32", 4, (view, at) => view.getFloat32(at, true)],
  ["double float64", 8, (view, at) => view.getFloat64(at, true)],
];
const kTypes = new Map(
  kReaders.flatMap(([names, size, read]) => names.split(" ").map((name) => [name, { size, read }])),
);

/** Rows of one kind in a PLY file. */
export class PlyElement {
  readonly count: number;
  readonly #view: DataView;
  readonly #begin: number;
  readonly #stride: number;
  readonly #columns: ReadonlyMap<string, { at: number; read: Reader }>;

  constructor(
    view: DataView,
    begin: number,
    count: number,
    stride: number,
    columns: ReadonlyMap<string, { at: number; read: Reader }>,
  ) {
    this.#view = view;
    this.#begin = begin;
    this.count = count;
    this.#stride = stride;
    this.#columns = columns;
  }

  has(name: string): boolean {
    return this.#columns.has(name);
  }

  /** What reads a column, by the row. Throws CaseError where there is none. */
  column(name: string): (row: number) => number {
    const column = this.#columns.get(name);
    if (!column) {
      throw new CaseError(`has no splats: its points have no "${name}"; a scene of 3D Gaussians is needed`);
    }
    const view = this.#view;
    const stride = this.#stride;
    const { read } = column;
    const first = this.#begin + column.at;
    return (row) => read(view, first + row * stride);
  }
}

interface Declared {
  name: string;
  count: number;
  stride: number;
  columns: Map<string, { at: number; read: Reader }>;
  hasLists: boolean;
}

/** The elements of a PLY file, binary and little-endian, by name, whose rows are all there. Throws CaseError. */
export function readPlyElements(bytes: Uint8Array): Map<string, PlyElement> {
  const head = new TextDecoder("latin1").decode(bytes.subarray(0, kMostHeader));
  const end = /\nend_header\r?\n/.exec(head);
  if (!end) {
    throw new CaseError("is no PLY file that can be read: its header has no end");
  }
  const lines = head.slice(0, end.index).split(/\r?\n/);
  if (!lines.some((line) => /^format +binary_little_endian\b/.test(line))) {
    throw new CaseError("is no binary, little-endian PLY file; save it as one");
  }
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const elements = new Map<string, PlyElement>();
  let begin = end.index + end[0].length;
  for (const { name, count, stride, columns, hasLists } of declarations(lines)) {
    if (hasLists) {
      break; // where it ends, and what follows, only its rows would say: no splats
    }
    if (count * stride > bytes.length - begin) {
      throw new CaseError(`ends too early for ${count} of "${name}"; copy it again, whole`);
    }
    elements.set(name, new PlyElement(view, begin, count, stride, columns));
    begin += count * stride;
  }
  return elements;
}

function declarations(lines: readonly string[]): Declared[] {
  const declared: Declared[] = [];
  for (const line of lines) {
    const [word, first = "", second = ""] = line.trim().split(/ +/);
    const element = declared.at(-1);
    if (word === "element") {
      const count = Number(second);
      if (!Number.isSafeInteger(count) || count < 0) {
        throw new CaseError(`is no PLY file that can be read: "${line.trim()}"`);
      }
      declared.push({ name: first, count, stride: 0, columns: new Map(), hasLists: false });
    } else if (word === "property" && element) {
      const type = kTypes.get(first);
      if (type) {
        element.columns.set(second, { at: element.stride, read: type.read });
        element.stride += type.size;
      } else {
        element.hasLists = true;
      }
    }
  }
  return declared;
}
