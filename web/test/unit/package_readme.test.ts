import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";

describe("the package's README", () => {
  it("names all that scripts can do", () => {
    const api = readFileSync("src/api.ts", "utf8").split("export interface ClipgsApi {")[1]!;
    const names = [...api.matchAll(/^ {2}(?:readonly )?(\w+)[(:]/gm)].map(([, name]) => name!);
    const readme = readFileSync("package/README.md", "utf8");
    expect(names.length).toBeGreaterThan(30);
    expect(names.filter((name) => !readme.includes(`\`${name}\``))).toEqual([]);
  });
});
