const kSources = import.meta.glob<string>("../shaders/*.glsl", {
  query: "?raw",
  import: "default",
  eager: true,
});

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
  return source.replace(/^#include "(.+)"$/gm, (_, other: string) => shader(other, included));
}
