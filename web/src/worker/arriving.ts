import { JsonReader } from "../sog/json_reader";
import { parseSogMeta, splatFiles } from "../sog/sog";
import { type Archive, CaseError, readZip } from "../sog/zip";
import { ZipBeginning } from "../sog/zip_beginning";
import type { Progress } from "./file_cache";

/** What is seen of a case before there is anything to draw. */
export interface Cover {
  title: string;
  thumbnail: Uint8Array<ArrayBuffer>; // WebP
}

/** A case whose file is on its way. Both reject with CaseError. */
export interface ArrivingCase {
  /** Its splats, and whatever is there by then. */
  readonly splats: Promise<Archive>;
  /** All of it, checked. */
  readonly whole: Promise<Archive>;
}

/**
 * A case, as `fetchFile` brings its bytes. `early`: where its file begins with them, splats do not wait for the rest.
 * `show` is given the cover, if that comes before them.
 */
export function arrive(
  fetchFile: (progress: Progress) => Promise<Uint8Array>,
  early: boolean,
  show: (cover: Cover) => void,
): ArrivingCase {
  const beginning = new ZipBeginning();
  let covered = false;
  let begin!: (archive: Archive) => void;
  const begun = new Promise<Archive>((resolve) => (begin = resolve));
  const bytes = fetchFile((_loaded, _total, bytes) => {
    if (!beginning.read(bytes)) {
      return;
    }
    const cover = covered ? null : coverOf(beginning.archive);
    if (cover) {
      covered = true;
      show(cover);
    }
    if (hasSplats(beginning)) {
      beginning.end();
      if (early) {
        begin(beginning.archive);
      }
    }
  });
  const whole = readWhole(bytes, beginning);
  whole.catch(() => {}); // said to who waits for it
  return { splats: Promise.race([begun, whole]), whole };
}

async function readWhole(bytes: Promise<Uint8Array>, beginning: ZipBeginning): Promise<Archive> {
  const archive = await readZip(await bytes);
  if (!beginning.agrees(archive)) {
    throw new CaseError("the archive's directory is damaged; copy the file again");
  }
  return archive;
}

/** What is wrong with it is said of the whole file. */
function hasSplats(beginning: ZipBeginning): boolean {
  try {
    return splatFiles(parseSogMeta(beginning.archive)).every((name) => beginning.entries.has(name));
  } catch {
    return false;
  }
}

function coverOf(archive: Archive): Cover | null {
  try {
    const clipgs = new JsonReader(parseSogMeta(archive).clipgs, "clipgs");
    const picture = archive.get(clipgs.text("thumbnail"));
    return picture ? { title: clipgs.text("title"), thumbnail: picture.slice() } : null;
  } catch {
    return null;
  }
}
