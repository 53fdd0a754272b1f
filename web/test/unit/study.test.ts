import { readFileSync } from "node:fs";
import { Vector3 } from "three";
import { afterEach, describe, expect, it, vi } from "vitest";

import { planeThrough } from "../../src/model/geometry";
import { Journal } from "../../src/study/journal";
import { FrameTimes, TaskMeasures } from "../../src/study/measures";
import { errorFrom, parsePlan, type Plan } from "../../src/study/plan";
import { itemsOf } from "../../src/study/questionnaires";
import { germanStudy } from "../../src/text/study_de";
import { englishStudy } from "../../src/text/study_en";
import { modesOf, resumeAt, stepsOf, tasksOf } from "../../src/study/schedule";

const kPlan = readFileSync("../presets/study/clipgs-vr.json", "utf8");
const plan = (change: (json: Record<string, unknown>) => void = () => {}): Plan => {
  const json = JSON.parse(kPlan) as Record<string, unknown>;
  change(json);
  return parsePlan(JSON.stringify(json), "clipgs-vr.json");
};

describe("a study's plan", () => {
  it("is read", () => {
    const { name, case: file, modes, tasks, practice, questionnaires, limit } = plan();
    expect(name).toBe("clipgs-vr");
    expect(file).toBe("phantom");
    expect(modes.map(({ mode }) => mode)).toEqual(["uniaxial", "arbitrary"]);
    expect(tasks.map((task) => task.name)).toEqual(["ventricle", "carina", "kidneys"]);
    expect(practice).toHaveLength(1);
    expect(questionnaires).toEqual(["sus", "efficiency"]);
    expect(limit).toBe(180);
    const { points, plane } = tasks[2]!.target;
    points.forEach((point) => expect(plane!.normal.dot(point) - plane!.offset).toBeCloseTo(0, 9));
  });

  it("is the same in German", () => {
    const german = parsePlan(readFileSync("../presets/study/clipgs-vr-de.json", "utf8"), "clipgs-vr-de.json");
    expect([plan().language, german.language]).toEqual(["en", "de"]);
    const structure = ({ modes, practice, tasks, welcome, ...rest }: Plan) => ({
      ...rest,
      ...{ name: "", digest: "", language: "", title: "", welcome: welcome.length },
      modes: modes.map(({ mode }) => mode),
      tasks: [...practice, ...tasks].map((task) => ({ ...task, text: "" })),
    });
    expect(structure(german)).toEqual(structure(plan()));
  });

  it("is refused in one line where it is wrong", () => {
    const wrong: [(json: Record<string, unknown>) => void, RegExp][] = [
      [(json) => (json["format"] = 2), /clipgs-vr\.json: plan\.format is missing or out of range; see docs/],
      [(json) => delete json["title"], /plan\.title/],
      [(json) => (json["language"] = "fr"), /plan\.language/],
      [(json) => (json["name"] = "my plan"), /plan\.name/],
      [(json) => (json["modes"] = []), /plan\.modes/],
      [(json) => (json["modes"] = [0, 1].map(() => (json["modes"] as unknown[])[0])), /plan\.modes/],
      [(json) => (json["pins"] = {}), /the target of "gallbladder" is the pin "gallbladder", which the plan/],
      [(json) => (json["questionnaires"] = ["sus", "mood"]), /plan\.questionnaires/],
      [(json) => (json["tasks"] = []), /plan\.tasks/],
      [(json) => (json["tasks"] = json["practice"]), /a name twice/],
      [(json) => (json["limit_s"] = 0), /plan\.limit_s/],
      [(json) => (json["order"] = "random"), /plan\.order/],
      [
        (json) =>
          (json["tasks"] = [{ name: "a", text: "", target: { through: ["carina", "carina", "spleen"] } }]),
        /through/,
      ],
      [(json) => (json["tasks"] = [{ name: "a", text: "", target: { plane: [0, 0, 0, 1] } }]), /plane/],
    ];
    for (const [change, message] of wrong) {
      expect(() => plan(change)).toThrow(message);
    }
    expect(() => parsePlan("{", "x.json")).toThrow(/x\.json: is no JSON/);
  });

  it("says how far a plane is from a target", () => {
    const center = new Vector3(1, 2, 3);
    const plane = planeThrough(new Vector3(0, 0, 1), new Vector3(0, 0, 5));
    const pin = { points: [new Vector3(9, 9, 2)], plane: null };
    expect(errorFrom(pin, plane, center)).toEqual({ angle: null, distance: 3 });
    const turned = planeThrough(new Vector3(0, 1, -1), center);
    const { angle, distance } = errorFrom({ points: [], plane: turned }, plane, center);
    expect(angle).toBeCloseTo(45, 9);
    expect(distance).toBeCloseTo(2, 9);
    const both = { points: [new Vector3(0, 0, 1), new Vector3(0, 0, 8)], plane: null };
    expect(errorFrom(both, plane, center).distance).toBeCloseTo(Math.sqrt((16 + 9) / 2), 9);
  });
});

describe("a study's schedule", () => {
  it("lets every other participant begin with the other mode, and every task stand everywhere equally often", () => {
    const all = plan();
    const count = new Map<string, number>();
    for (let participant = 1; participant <= 6; ++participant) {
      modesOf(all, participant).forEach(({ mode }, position) =>
        tasksOf(all, participant, position).forEach(({ name }, at) => {
          const key = `${position} ${mode} ${at} ${name}`;
          count.set(key, (count.get(key) ?? 0) + 1);
        }),
      );
    }
    expect(count.size).toBe(2 * 2 * 3 * 3);
    expect(new Set(count.values())).toEqual(new Set([1]));
    const fixed = plan((json) => Object.assign(json, { order: "fixed", task_order: "fixed" }));
    expect(modesOf(fixed, 2)[0]!.mode).toBe("uniaxial");
    expect(tasksOf(fixed, 5, 1)[0]!.name).toBe("ventricle");
  });

  it("goes on at the first step that is not recorded, and what leads to it", () => {
    const steps = stepsOf(plan(), 1);
    const kinds = (n: number) => steps[resumeAt(steps, n)]!.kind;
    expect(kinds(0)).toBe("mode");
    expect(kinds(1)).toBe("task");
    expect(kinds(4)).toBe("questionnaire");
    expect(kinds(6)).toBe("mode");
    expect(kinds(12)).toBe("comment");
    expect(kinds(13)).toBe("thanks");
    expect(steps.filter(({ recorded }) => recorded)).toHaveLength(14);
  });

  it("asks ten questions of the SUS, one of efficiency and six of the TLX", () => {
    for (const words of [englishStudy, germanStudy]) {
      expect(itemsOf("sus", words).map(({ values }) => values.length)).toEqual(Array(10).fill(5));
      expect(itemsOf("efficiency", words)).toHaveLength(1);
      expect(itemsOf("tlx", words).map(({ values }) => [values[0], values.at(-1), values.length])).toEqual(
        Array(6).fill([0, 100, 21]),
      );
      expect(
        itemsOf("tlx", words)
          .map(({ low }) => low === words.tlx.perfect)
          .indexOf(true),
      ).toBe(3);
    }
  });
});

describe("what is measured of a task", () => {
  const target = { points: [new Vector3(0, 0, 10)], plane: null };
  const z = new Vector3(0, 0, 1);

  it("is the plane's way and turn, those of the head, the error, and how often it was grasped", () => {
    const measures = new TaskMeasures(target, new Vector3(), 1000);
    const at = (offset: number) => planeThrough(z, new Vector3(0, 0, offset));
    measures.plane(at(0), 1000);
    measures.plane(at(6), 1100);
    measures.plane(at(4), 1200);
    measures.plane(at(4), 1900);
    measures.plane(planeThrough(new Vector3(0, 1, 1), new Vector3()), 2500);
    const [x, y] = [new Vector3(1, 0, 0), new Vector3(0, 1, 0)];
    measures.head(new Vector3(), x);
    measures.head(new Vector3(0, 0.25, 0), y);
    measures.head(new Vector3(0, 0.25, 0.5), y);
    const { frames, display_hz, ...summary } = measures.summary(3500, 90);
    expect(frames).toBe(0);
    expect(display_hz).toBe(90);
    expect(summary).toMatchObject({
      seconds: 2.5,
      travel_mm: 12,
      rotation_deg: 45,
      head_mm: 750,
      head_deg: 90,
      angle_deg: null,
      distance_mm: 7.071,
      regrasps: 1,
    });
  });

  it("counts what hands hold, where there are hands", () => {
    const measures = new TaskMeasures(target, new Vector3(), 0);
    for (const held of [false, true, true, false, true, false, false, true]) {
      measures.holds(held);
    }
    expect(measures.summary(1, null)).toMatchObject({ regrasps: 2, head_mm: null, distance_mm: null });
  });

  it("is how long frames take, the slowest of them, and those that did not come", () => {
    const frames = new FrameTimes();
    expect(frames.summary(72).frame_ms).toBeNull();
    let now = 5;
    for (let i = 0; i < 199; ++i) {
      frames.count(now);
      now += 10;
    }
    frames.count((now += 30));
    expect(frames.summary(100)).toEqual({ frames: 199, frame_ms: 10.15, low_fps: 40, dropped: 3 });
    expect(frames.summary(null).dropped).toBe(3);
  });
});

/** A server's end of a journal. */
class FakeServer {
  readonly records: string[] = [];
  down: "before" | "after" | null = null;
  refusal: [number, string] | null = null;

  fetch = async (url: string, init?: RequestInit): Promise<Response> => {
    if (this.down === "before") {
      throw new TypeError("fetch failed");
    }
    if (init?.method !== "POST") {
      const [session] = this.sessions;
      return url.includes("?")
        ? Response.json(session ? [{ session, plan: "clipgs-vr", records: 1, ended: this.ended }] : [])
        : new Response(this.records.map((line) => `${line}\n`).join(""));
    }
    if (this.refusal) {
      return new Response(this.refusal[1], { status: this.refusal[0] });
    }
    this.sessions = [url.split("/").at(-1)!];
    for (const line of (init.body as string).split("\n").filter((one) => one)) {
      if ((JSON.parse(line) as { seq: number }).seq === this.records.length) {
        this.records.push(line);
      }
    }
    if (this.down === "after") {
      throw new TypeError("fetch failed");
    }
    return Response.json({ records: this.records.length });
  };

  sessions: string[] = [];

  get ended(): boolean {
    return this.records.at(-1)?.includes('"end"') ?? false;
  }
}

class MemoryStore extends Map<string, string> {
  getItem = (key: string) => this.get(key) ?? null;
  setItem = (key: string, value: string) => void this.set(key, value);
  removeItem = (key: string) => void this.delete(key);
}

describe("a study's journal", () => {
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  function setUp() {
    vi.useFakeTimers();
    const server = new FakeServer();
    vi.stubGlobal("fetch", server.fetch);
    return { server, store: new MemoryStore() };
  }

  it("sends until it is stored, once, and says what is wrong meanwhile", async () => {
    const { server, store } = setUp();
    const journal = Journal.begin(7, store);
    expect(journal.session).toMatch(/^p007-[0-9a-f]{8}$/);
    const digest = plan().digest;
    await journal.add({ kind: "session", digest });
    for (const down of ["before", "after"] as const) {
      server.down = down;
      const added = journal.add({ kind: "comment", text: down });
      await vi.advanceTimersByTimeAsync(5000);
      expect(journal.trouble).toMatch(/does not answer/);
      expect(store.size).toBe(1);
      server.down = null;
      await vi.advanceTimersByTimeAsync(5000);
      await added;
      expect(journal.trouble).toBeNull();
      expect(store.size).toBe(0);
    }
    server.refusal = [507, "the disk is full\n"];
    const added = journal.add({ kind: "end" });
    await vi.advanceTimersByTimeAsync(100);
    expect(journal.trouble).toBe("the disk is full");
    server.refusal = null;
    await vi.advanceTimersByTimeAsync(5000);
    await added;
    expect(server.records.map((line) => (JSON.parse(line) as { seq: number }).seq)).toEqual([0, 1, 2, 3]);
    expect(journal.text).toBe(server.records.map((line) => `${line}\n`).join(""));
  });

  it("goes on after a power cut, here or there, without a lost or doubled record", async () => {
    const { server, store } = setUp();
    const first = Journal.begin(7, store);
    await first.add({ kind: "session", digest: plan().digest });
    server.down = "after"; // stored there, not known here
    void first.add({ kind: "comment", text: "known there" });
    await vi.advanceTimersByTimeAsync(100);
    server.down = "before";
    void first.add({ kind: "comment", text: "known here" });
    await vi.advanceTimersByTimeAsync(100);
    first.dispose();
    server.down = null;
    const second = (await Journal.resume(plan(), 7, store))!;
    expect(second.entries.map((entry) => entry["text"])).toEqual([undefined, "known there", "known here"]);
    await second.send();
    expect(server.records).toHaveLength(3);
    await second.add({ kind: "end" });
    await expect(Journal.resume(plan(), 7, store)).rejects.toThrow(/taken part already/);
  });

  it("does not go on by another text of the plan", async () => {
    const { store } = setUp();
    await Journal.begin(7, store).add({ kind: "session", digest: plan().digest });
    const other = plan((json) => (json["limit_s"] = 99));
    await expect(Journal.resume(other, 7, store)).rejects.toThrow(/another text of clipgs-vr/);
  });

  it("begins where nobody has", async () => {
    const { store } = setUp();
    expect(await Journal.resume(plan(), 7, store)).toBeNull();
  });
});
