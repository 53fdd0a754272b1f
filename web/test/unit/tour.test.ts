import { readFileSync } from "node:fs";
import { Vector3 } from "three";
import { beforeEach, describe, expect, it } from "vitest";

import { planesOf } from "../../src/model/cut";
import { crossing, flight } from "../../src/model/flight";
import { textOf } from "../../src/model/kept_file";
import { changeBetween, changed } from "../../src/model/keeper";
import { layOut } from "../../src/model/label_layout";
import { parseLink } from "../../src/model/link";
import { linkedState } from "../../src/model/linked_state";
import { anchorOf, markText, measure } from "../../src/model/marks";
import { kModes, type PlaneStates } from "../../src/model/states";
import {
  formatTour,
  kMostStops,
  makeStop,
  parseTour,
  type Stop,
  withChange,
  withMove,
  withoutStop,
  withStop,
} from "../../src/model/tour";
import { cameraAxes, type View, viewDirection } from "../../src/model/view";
import { ViewerStore } from "../../src/model/viewer_state";
import { TourPlayer } from "../../src/tour_player";
import { kBase, shownOf } from "./tour_fixture";

interface Fixture {
  sphere: { center: [number, number, number]; radius: number };
  states: Omit<PlaneStates, "axis"> & { axis: [number, number, number] };
  flights: { from: string; to: string; share: number; shown: object }[];
  crossings: { share: number; before: number; flown: number }[];
}

interface MarksFixture {
  marks: { link: string; marks: { text: string; anchor: number[] }[] }[];
  picture: [number, number];
  moved: [number, number];
  /** Of labels anchors, sizes, and the points of their lines. */
  layouts: { labels: [number, number, number, number, ...number[]][]; first: number[]; again: number[] }[];
}

const fixture = JSON.parse(readFileSync("../src/tour/flights.json", "utf8")) as Fixture;
const sphere = { center: new Vector3(...fixture.sphere.center), radius: fixture.sphere.radius };
const states: PlaneStates = { ...fixture.states, axis: new Vector3(...fixture.states.axis) };
const stateOf = (link: string) => linkedState(parseLink(link), kBase, states);

function expectNear(actual: unknown, expected: unknown, path = ""): void {
  if (typeof expected === "number") {
    expect(Math.abs((actual as number) - expected), path).toBeLessThan(1e-6);
  } else if (typeof expected === "object" && expected !== null) {
    expect(Object.keys(actual as object), path).toEqual(Object.keys(expected));
    for (const [key, value] of Object.entries(expected)) {
      expectNear((actual as Record<string, unknown>)[key], value, `${path}.${key}`);
    }
  } else {
    expect(actual, path).toBe(expected);
  }
}

describe("a flight", () => {
  it("shows what that of `clipgs render` does", () => {
    for (const { from, to, share, shown } of fixture.flights) {
      expectNear(shownOf(from, to, share, sphere, states), shown, `${from} → ${to} at ${share}`);
    }
  });

  it("crosses to another look before anything moves, as that of `clipgs render` does", () => {
    for (const { share, ...way } of fixture.crossings) {
      expectNear(crossing(share), way, `at ${share}`);
    }
    let last = crossing(0);
    expect(last).toEqual({ before: 1, flown: 0 });
    for (let share = 0.01; share <= 1; share += 0.01) {
      const now = crossing(share);
      expect(now.before).toBeLessThanOrEqual(last.before);
      expect(now.before > 0 && now.flown > 0).toBe(false);
      last = now;
    }
  });

  it("turns no picture round at once, even where it begins or ends above the head", () => {
    const places = ["0,0", "40,20", "180,0", "-90,45", "120,-70", "0,89.9", "90,90", "200,-90", "60,130"];
    const rightOf = (view: View) => cameraAxes(viewDirection(view.azimuth, view.elevation).negate()).right;
    for (const [from, to] of places.flatMap((a) => places.map((b) => [a, b] as const))) {
      const ends = [stateOf(`view=${from}`), stateOf(`view=${to}`)] as const;
      let last = flight(...ends, 0, sphere).view;
      for (let i = 1; i <= 200; ++i) {
        const now = flight(...ends, i / 200, sphere).view;
        const degrees = (rightOf(now).angleTo(rightOf(last)) * 180) / Math.PI;
        expect(degrees, `${from} → ${to} at ${i / 200}`).toBeLessThan(2);
        last = now;
      }
    }
  });

  it("goes the shorter way round, and steadily towards what is zoomed at", () => {
    const [from, to] = [stateOf("view=170,0,1"), stateOf("view=-150,0,8&pan=40,0,0")];
    const azimuths = Array.from({ length: 11 }, (_, i) => flight(from, to, i / 10, sphere).view.azimuth);
    azimuths.slice(1, -1).forEach((azimuth, i) => expect(azimuth).toBeGreaterThan(azimuths[i]!));
    let last = Infinity;
    for (let share = 0; share <= 1; share += 0.05) {
      const { pan, zoom } = flight(from, to, share, sphere).view;
      const aside = zoom * (40 - pan.x); // on the screen
      expect(aside).toBeLessThanOrEqual(last + 1e-9);
      last = aside;
    }
  });

  it("brings planes from outside the body and takes them there, never too many at once", () => {
    const many = ["1,0,0,0", "-1,0,0,-40", "0,1,0,0", "0,-1,0,-40", "0,0,1,0", "0,0,-1,-40"];
    const [from, to] = [stateOf(many.map((plane) => `plane=${plane}`).join("&")), stateOf("plane=off")];
    const [there, back] = [flight(from, to, 0.499999, sphere), flight(to, from, 0.5, sphere)];
    for (const { cuts } of [there, back]) {
      expect(planesOf(cuts).length).toBeLessThanOrEqual(6);
      for (const { normal, offset } of cuts) {
        expect(normal.dot(sphere.center) - sphere.radius).toBeGreaterThan(offset - 1e-3);
      }
    }
    const turned = flight(stateOf("plane=1,0,0,10"), stateOf("plane=0,1,0,-20"), 0.5, sphere).cuts[0]!;
    expect(turned.normal.length()).toBeCloseTo(1, 12);
    // About the body's middle, which is 0 and then 0 mm of it away.
    expect(turned.normal.dot(sphere.center) - turned.offset).toBeCloseTo(0, 9);
  });

  it("is nowhere faster than its frames can follow", () => {
    for (const flown of fixture.flights) {
      const [from, to] = [stateOf(flown.from), stateOf(flown.to)];
      let last = flight(from, to, 0, sphere);
      for (let i = 1; i <= 200; ++i) {
        const now = flight(from, to, i / 200, sphere);
        const [up, before] = [now, last].map(({ view }) => viewDirection(view.azimuth, view.elevation).z);
        expect(Math.abs(Math.asin(up!) - Math.asin(before!)) * (180 / Math.PI)).toBeLessThan(2);
        expect(Math.abs(now.grey - last.grey)).toBeLessThan(0.02);
        last = now;
      }
    }
  });
});

describe("marks of a film", () => {
  const { marks, picture, moved, layouts } = JSON.parse(
    readFileSync("../src/tour/marks.json", "utf8"),
  ) as MarksFixture;

  it("say and stand where the page has them", () => {
    for (const one of marks) {
      const read = parseLink(one.link).marks ?? [];
      const said = read.map((mark) => markText(mark, measure(mark, null)));
      expect(said).toEqual(one.marks.map(({ text }) => text));
      read.forEach((mark, i) => expectNear(anchorOf(mark).toArray(), one.marks[i]!.anchor, one.link));
    }
    const size = { width: picture[0], height: picture[1] };
    for (const { labels, first, again } of layouts) {
      const shifted = ([right, down]: readonly [number, number]) => {
        const place = (x: number, y: number) => ({ x: x + right, y: y + down });
        return labels.map(([x, y, width, height, ...line]) => ({
          anchor: place(x, y),
          ...{ width, height },
          line: line.flatMap((at, k) => (k % 2 === 0 ? [place(at, line[k + 1]!)] : [])),
        }));
      };
      const laid = layOut(shifted([0, 0]), size).map(({ choice }) => choice);
      expect(laid).toEqual(first);
      expect(layOut(shifted(moved), size, laid).map(({ choice }) => choice)).toEqual(again);
    }
  });
});

describe("a tour's file", () => {
  const stops = [
    { ...makeStop("view=30,20&plane=0,0,-1,40", "The skull base"), text: "Größe; & more\nlines" },
    { ...makeStop("case=bone&view=0,0", ""), fly: 0, stay: 12.5 },
  ];

  it("comes back whole, and what is not one is said in a line", () => {
    expect(parseTour(formatTour(stops, "abc"), "a.json", "abc")).toEqual(stops);
    expect(parseTour(formatTour(stops, ""), "a.json", "abc")).toEqual(stops);
    const file = JSON.parse(formatTour(stops, "abc")) as { stops: object[] };
    const refused = (change: object, volume = "abc") => {
      try {
        parseTour(JSON.stringify({ ...file, ...change }), "a.json", volume);
      } catch (error) {
        return (error as Error).message;
      }
      return "";
    };
    expect(refused({ clipgs_tour: 2 })).toMatch(/^a\.json: of a version .* newer clipgs$/);
    expect(refused({}, "other")).toMatch(/^a\.json: a tour of another volume/);
    expect(refused({ stops: Array(101).fill(file.stops[0]) })).toMatch(/^a\.json: holds 101 stops, .* 100/);
    expect(refused({ stops: [{ ...file.stops[0], fly: -1 }] })).toMatch(/stops\[0\]\.fly/);
    expect(refused({ stops: [{ ...file.stops[0], stay: "5" }] })).toMatch(/stops\[0\]\.stay/);
    expect(refused({ stops: [{ ...file.stops[0], show: 1 }] })).toMatch(/stops\[0\]\.show/);
    expect(refused({ stops: [{ ...file.stops[0], show: "x".repeat(40_001) }] })).toMatch(/show/);
    expect(refused({ stops: [{ ...file.stops[0], id: null }] })).toMatch(/stops\[0\]\.id/);
    expect(refused({ newer: 1, stops: [{ ...file.stops[0], newer: {} }] })).toBe("");
    for (const text of ["", "[]", "{}", "null", "{"]) {
      expect(() => parseTour(text, "a.json", "abc")).toThrow(/^a\.json: /);
    }
  });

  it("loses nothing of what is too much for it, and says so", () => {
    const text = (change: object) => JSON.stringify({ clipgs_tour: 1, volume: "", ...change });
    const stop = { id: "a", show: "view=1,1" };
    const read = (stops: object[]) => parseTour(text({ stops }), "a.json", "abc");
    expect(() => read(Array<object>(10_000).fill(stop))).toThrow("a.json: holds 10000 stops");
    expect(() => read([{ ...stop, text: "x".repeat(10_000_000) }])).toThrow(
      /^a\.json: tour\.stops\[0\]\.text has more than 2000 characters; [^\n]{1,40}$/,
    );
    expect(() => read([{ ...stop, name: "x".repeat(121) }])).toThrow(/name has more than 120 characters/);
    expect(() => parseTour(text({ stops: [stop] }).slice(0, -3), "a.json", "")).toThrow("a.json: not a tour");
    expect(read([stop, stop, { ...stop, id: "a-2" }]).map(({ id }) => id)).toEqual(["a", "a-2", "a-2-2"]);
    const long = makeStop("view=1,1", "n".repeat(500), "t".repeat(5000));
    expect(parseTour(formatTour([long], ""), "a.json", "")).toEqual([long]);
    const [changed] = withChange([long], long.id, { text: "u".repeat(5000) });
    expect(parseTour(formatTour([changed!], ""), "a.json", "")[0]!.text.length).toBe(2000);
  });

  it("of a person is not waited for where it is none by its size", async () => {
    const huge = { name: "huge.json", size: 2 ** 25, text: () => Promise.reject(new Error("read")) };
    await expect(textOf(huge as unknown as File)).rejects.toThrow(/^huge\.json: has more than 16 MiB/);
    await expect(textOf(new File(["{}"], "a.json"))).resolves.toBe("{}");
  });

  it("keeps the order that a person put, and what somebody else added meanwhile", () => {
    const [a, b] = stops as [Stop, Stop];
    const c = makeStop("view=1,1", "c");
    const moved = withMove([a, b], b.id, -1);
    expect(moved).toEqual([b, a]);
    expect(withMove(moved, b.id, -1)).toBe(moved);
    const change = changeBetween([a, b], moved, true);
    expect(changed([a, c, b], change)).toEqual([b, a, c]);
    expect(withoutStop(moved, a.id)).toEqual([b]);
    expect(withChange(moved, a.id, { name: "other" })[1]).toEqual({ ...a, name: "other" });
    expect(withStop([a, b], c, a.id)).toEqual([a, c, b]);
    expect(withStop([a, b], c)).toEqual([a, b, c]);
    expect(withStop(Array(kMostStops).fill(a), c)).toBeNull();
  });
});

describe("a player", () => {
  const store = new ViewerStore();
  let now = 0;
  let wanted: string[] = [];
  let refusal: string | null = null;
  let still = false;
  let holds = 0;
  let caseName = "head";
  let expected: string[] = [];
  let veil = 0;
  const player = new TourPlayer({
    store,
    window: null,
    get caseName() {
      return caseName;
    },
    openLook: async (name) => {
      wanted.push(name);
      await Promise.resolve();
      if (refusal !== null) {
        throw new Error(refusal);
      }
      caseName = name;
      veil = 1;
    },
    expectLook: (name) => expected.push(name),
    get isVeiled() {
      return veil > 0;
    },
    veil: (share) => (veil = share),
    isStill: () => still,
    takeHold: () => ++holds,
    letGo: () => --holds,
    wake: () => {},
  });
  const after = (seconds: number) => {
    for (let i = 0; i < 100; ++i) {
      player.tick((now += 10 * seconds));
    }
  };
  const settle = () => new Promise((resolve) => setTimeout(resolve));

  beforeEach(() => {
    player.leave();
    wanted = [];
    expected = [];
    caseName = "head";
    veil = 0;
    refusal = null;
    still = false;
    store.setCase({
      states,
      sphere,
      bounds: { min: new Vector3(-1, -1, -1), max: new Vector3(1, 1, 1) },
      volume: "abc",
    } as Parameters<ViewerStore["setCase"]>[0]);
    store.setStops([
      { ...makeStop("view=0,0&plane=off", "first"), id: "1", fly: 1, stay: 2 },
      { ...makeStop("case=head&view=90,10,2&state=57&pin=1,2,3", "second"), id: "2", fly: 1, stay: 2 },
    ]);
    store.restore(kBaseView);
  });
  const kBaseView = { view: kBase.view, cuts: [], mode: kModes[1] } as const;

  it("flies from stop to stop, and ends at the last", async () => {
    await player.play();
    after(0.5);
    expect(player.index).toBe(0);
    after(1);
    expect(player.index).toBe(0);
    after(2);
    await settle();
    after(0.5);
    expect(player.index).toBe(1);
    expect(store.state.mode).toBe("arbitrary");
    expect(holds).toBe(1);
    after(1);
    expect(store.planeState).toBe(57);
    expect(store.state.view).toMatchObject({ azimuth: 90, zoom: 2 });
    expect(store.state.tourMarks!.length).toBe(1);
    expect(player.playing).toBe(true);
    after(3);
    expect(player.playing).toBe(false);
    expect([player.index, holds]).toEqual([1, 0]);
    player.leave();
    expect(store.state.tourMarks).toBeNull();
    expect(player.index).toBe(-1);
  });

  it("is stopped by whoever changes what is seen, and goes on to where it was going", async () => {
    await player.play();
    after(0.5);
    store.setView({ azimuth: 45 });
    after(0.1);
    expect([player.playing, holds]).toEqual([false, 0]);
    after(5);
    expect(store.state.view.azimuth).toBe(45);
    store.setMarks([]); // changes nothing that flies
    await player.play();
    expect(player.index).toBe(0);
    after(1.1);
    expect(store.state.view.azimuth).toBe(0);
  });

  it("jumps where nothing is to move", async () => {
    still = true;
    await player.show("2");
    player.tick((now += 16));
    expect(store.state.view.azimuth).toBe(90);
    expect(player.playing).toBe(false);
  });

  it("has the look before fade before anything moves, and fetches the next one while it stays", async () => {
    const [first, second] = store.state.stops as [Stop, Stop];
    store.setStops([first, { ...second, show: "case=bone&view=90,10" }]);
    await player.play();
    after(1.1);
    expect([expected, wanted]).toEqual([["bone"], []]);
    after(2);
    await settle();
    expect(wanted).toEqual(["bone"]);
    player.tick((now += 1));
    expect([veil, store.state.view.azimuth]).toEqual([1, 0]);
    player.tick((now += 200));
    expect(veil).toBeLessThan(0.5);
    expect([veil > 0, store.state.view.azimuth]).toEqual([true, 0]);
    player.tick((now += 300));
    expect(veil).toBe(0);
    expect(store.state.view.azimuth).toBeGreaterThan(0);
    after(1);
    expect(store.state.view.azimuth).toBe(90);
  });

  it("shows another look at once where nothing is to move, and leaves none half faded", async () => {
    const [first, second] = store.state.stops as [Stop, Stop];
    store.setStops([first, { ...second, show: "case=bone&view=90,10" }]);
    still = true;
    await player.show("2");
    player.tick((now += 16));
    expect([veil, store.state.view.azimuth]).toEqual([0, 90]);
    still = false;
    caseName = "head";
    await player.show("2");
    player.tick((now += 16));
    player.tick((now += 100));
    expect(veil).toBeGreaterThan(0);
    player.pause();
    expect(veil).toBe(0);
    caseName = "head";
    const shown = player.show("2");
    veil = 1; // the look has come, its section has not
    player.leave();
    expect(veil).toBe(0);
    await shown;
  });

  it("says which case is missing, loses nothing, and goes on when told to", async () => {
    const stops = store.state.stops;
    store.setStops([{ ...stops[0]!, show: "case=gone&view=1,1" }, stops[1]!]);
    refusal = "there is no gone.sog";
    await player.play();
    expect(wanted).toEqual(["gone"]);
    expect(veil).toBe(0);
    expect(player.trouble).toBe("View 1 is not shown: there is no gone.sog");
    expect(player.playing).toBe(false);
    expect(store.state.stops.length).toBe(2);
    await player.step(1);
    after(1.1);
    expect(player.trouble).toBe("");
    expect(store.state.view.azimuth).toBe(90);
  });
});
