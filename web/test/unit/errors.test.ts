import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import ts from "typescript";
import { afterAll, describe, expect, it } from "vitest";

import { german } from "../../src/text/de";
import { inOwnWords, speak } from "../../src/text/text";

/** What no line in German says. */
const kEnglish = /\b(the|is|not|of|has|which|again|copy|use|try|choose|file|can)\b/;

/** The texts of all errors that sources throw for people to read; what differs is a number. */
function thrownLines(): string[] {
  return readdirSync("src", { recursive: true, encoding: "utf8" })
    .filter((file) => file.endsWith(".ts"))
    .flatMap((file) => {
      const lines: string[] = [];
      const visit = (node: ts.Node, isThrown: boolean): void => {
        if (isThrown && ts.isStringLiteralLike(node)) {
          lines.push(node.text);
        } else if (isThrown && ts.isTemplateExpression(node)) {
          const spans = node.templateSpans.map(({ literal }, i) => `${i + 2}${literal.text}`);
          lines.push(node.head.text + spans.join(""));
        } else {
          const isError = ts.isNewExpression(node) && node.expression.getText() === "CaseError";
          node.forEachChild((child) => visit(child, isThrown || isError));
        }
      };
      visit(
        ts.createSourceFile(file, readFileSync(join("src", file), "utf8"), ts.ScriptTarget.ES2022, true),
        false,
      );
      return lines;
    });
}

describe("errors", () => {
  afterAll(() => speak("en"));

  it("have all a line in German", () => {
    speak("de", german);
    const lines = thrownLines();
    expect(lines.length).toBeGreaterThan(60);
    expect(lines.map(inOwnWords).filter((line) => kEnglish.test(line))).toEqual([]);
  });

  it("keep what differs, in the order of the other language", () => {
    speak("de", german);
    expect(
      inOwnWords(
        "a.ply: has 5000000 splats, and the viewer shows 4194304 at most; thin it out, as in SuperSplat",
      ),
    ).toBe(
      "a.ply: hat 5000000 Splats, und der Betrachter zeigt höchstens 4194304; bitte ausdünnen, etwa in SuperSplat",
    );
    expect(
      inOwnWords("meta.json: clipgs.sphere.radius is missing or out of range; build the case again"),
    ).toBe(
      "meta.json: clipgs.sphere.radius fehlt oder liegt außerhalb des Erlaubten; bitte den Fall neu herstellen",
    );
    expect(inOwnWords("x: something that nobody knows")).toBe("x: something that nobody knows");
  });

  it("are as they are in English", () => {
    speak("en");
    expect(inOwnWords("x: has no splats")).toBe("x: has no splats");
  });
});
