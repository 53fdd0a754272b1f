import { describe, expect, it } from "vitest";

import type { CaseSummary } from "../../src/model/case_list";
import { newsText } from "../../src/model/case_news";

const shown = (trained: number) => ({ name: "head", trained }) as CaseSummary;
const making = { name: "head", quality: "standard", seconds: null, error: null };

describe("the news of a case", () => {
  it("say nothing of one that is finished", () => {
    expect(newsText(shown(1), [], "head")).toBe("");
    expect(newsText(undefined, [], null)).toBe("");
    expect(newsText(shown(1), [{ ...making, name: "chest" }], "head")).toBe("");
  });

  it("say what it is and when there will be a better one", () => {
    expect(newsText(shown(0), [], "head")).toBe("Instant");
    expect(newsText(shown(0.25), [], "head")).toBe("25 % trained");
    expect(newsText(shown(0), [making], "head")).toBe("Instant · standard follows");
    const left = (seconds: number) => newsText(shown(0), [{ ...making, seconds }], "head");
    expect(left(0)).toBe("Instant · standard in 10 s");
    expect(left(43)).toBe("Instant · standard in 40 s");
    expect(left(361)).toBe("Instant · standard in 6 min");
    expect(left(7300)).toBe("Instant · standard in 2 h");
    expect(newsText(shown(0), [{ ...making, error: "the disk is full" }], "head")).toBe(
      "Instant · standard stopped: the disk is full",
    );
  });
});
