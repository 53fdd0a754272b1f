import { describe, expect, it } from "vitest";

import { caseFile } from "../../src/model/case_list";

describe("addresses of cases", () => {
  it("keep the strokes between folders, and nothing else that has a meaning there", () => {
    expect(caseFile("head")).toBe("cases/head.sog");
    expect(caseFile("ward 3/2027/a?b#c%2f")).toBe("cases/ward%203/2027/a%3Fb%23c%252f.sog");
    expect(caseFile("ward/head", "marks.json")).toBe("cases/ward/head.marks.json");
  });
});
