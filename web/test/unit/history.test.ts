import { describe, expect, it } from "vitest";

import { History } from "../../src/model/history";

describe("History", () => {
  it("goes back and forth", () => {
    const history = new History("a");
    expect([history.canUndo, history.canRedo, history.undo(), history.redo()]).toEqual([
      false,
      false,
      "a",
      "a",
    ]);
    history.record("b");
    history.record("c");
    expect([history.undo(), history.undo(), history.undo()]).toEqual(["b", "a", "a"]);
    expect(history.canRedo).toBe(true);
    expect([history.redo(), history.redo(), history.redo()]).toEqual(["b", "c", "c"]);
  });

  it("forgets what was undone once something new happens", () => {
    const history = new History("a");
    history.record("b");
    history.undo();
    history.record("c");
    expect([history.canRedo, history.undo(), history.redo()]).toEqual([false, "a", "c"]);
  });

  it("forgets the oldest where there are too many", () => {
    const history = new History(0, 3);
    [1, 2, 3, 4].forEach((state) => history.record(state));
    expect([history.undo(), history.undo(), history.undo()]).toEqual([3, 2, 2]);
    expect(history.canUndo).toBe(false);
  });
});
