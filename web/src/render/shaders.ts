import { kMaxPlanes } from "../model/cut";

const kSources = import.meta.glob<string>("../shaders/*.glsl", {
  query: "?raw",
  import: "default",
  eager: true,
});

/**
 * Writes loops over planes out, so that what they index are constants: software renderers keep arrays with other indices
 * in memory, and a loop over one plane took a fifth of the time of a frame.
 */
function unrollPlanes(source: string): string {
  return source.replace(
    /^( *)for \(int i = (\d); i < kPlanes; \+\+i\) \{\n([^]*?)^\1\}$/gm,
    (_, _indent, first: string, body: string) =>
      Array.from({ length: kMaxPlanes - Number(first) }, (_, k) => {
        const i = Number(first) + k;
        return `#if kPlanes > ${i}\n{\nconst int i = ${i};\n${body}}\n#endif`;
      }).join("\n"),
  );
}

/** The text of shaders/`name` with its includes, each once. */
export function shader(name: string, included = new Set<string>()): string {
  if (included.has(name)) {
    return "";
  }
  included.add(name);
  const source = kSources[`../shaders/${name}`];
  if (source === undefined) {
    throw new Error(`there is no shader ${name}`);
  }
  return unrollPlanes(source).replace(/^#include "(.+)"$/gm, (_, other: string) => shader(other, included));
}
