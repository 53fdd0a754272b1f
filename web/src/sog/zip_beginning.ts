import { type Archive, crc32, kLocalSignature, kMaxEntries, kStored } from "./zip";

const kHeaderSize = 30;
/** The sizes come after the content. */
const kSizesFollow = 1 << 3;
const kEncrypted = 1;

/**
 * The entries that a ZIP archive begins with, while its bytes come: those that are stored, whole, and what their checksums
 * say. The first that is not so ends them. Only an archive's directory, at its end, says what it holds: readZip() reads
 * that, and agrees() with it is what was read here, or the archive is damaged.
 */
export class ZipBeginning {
  readonly entries = new Map<string, Uint8Array>();
  #at = 0;
  #ended = false;

  /** Reads on in `bytes`, all that there are by now. Returns whether there is an entry more. */
  read(bytes: Uint8Array): boolean {
    const before = this.entries.size;
    while (!this.#ended && this.#readEntry(bytes)) {
      // one more
    }
    return this.entries.size > before;
  }

  /** Reads no more of it. */
  end(): void {
    this.#ended = true;
  }

  /** What there is of an archive whose other files may be still to come. */
  get archive(): Archive {
    return { get: (name) => this.entries.get(name), has: () => true };
  }

  /** Whether the whole archive has what was read of its beginning. */
  agrees(archive: ReadonlyMap<string, Uint8Array>): boolean {
    return [...this.entries].every(([name, { byteOffset, length }]) => {
      const entry = archive.get(name);
      return entry?.length === length && entry.byteOffset === byteOffset;
    });
  }

  #readEntry(bytes: Uint8Array): boolean {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const at = this.#at;
    if (at + kHeaderSize > bytes.length) {
      return false;
    }
    const flags = view.getUint16(at + 6, true);
    const size = view.getUint32(at + 22, true);
    const nameLength = view.getUint16(at + 26, true);
    const begin = at + kHeaderSize + nameLength + view.getUint16(at + 28, true);
    const isPlain =
      view.getUint32(at, true) === kLocalSignature &&
      view.getUint16(at + 8, true) === kStored &&
      view.getUint32(at + 18, true) === size &&
      (flags & (kSizesFollow | kEncrypted)) === 0;
    if (!isPlain || this.entries.size === kMaxEntries) {
      this.#ended = true;
      return false;
    }
    if (begin + size > bytes.length) {
      return false;
    }
    const name = new TextDecoder().decode(bytes.subarray(at + kHeaderSize, at + kHeaderSize + nameLength));
    const data = bytes.subarray(begin, begin + size);
    if (this.entries.has(name) || crc32(data) !== view.getUint32(at + 14, true)) {
      this.#ended = true;
      return false;
    }
    this.entries.set(name, data);
    this.#at = begin + size;
    return true;
  }
}
