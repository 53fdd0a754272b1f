import { join } from "node:path";

import type { FaceSource } from "../../src/model/faces";
import type { Triple } from "../../src/model/geometry";
import type { GreyOpenings } from "../../src/model/face_style";
import type { ClipOperator } from "../../src/worker/protocol";
import { type Picture, readPng } from "./picture";
import { clipgs } from "./program";
import type { Server } from "./server";
import type { Evaluates } from "./tab";

/** What a picture shows. */
export interface Shot {
  name?: string; // of the case; the phantom's if not said
  view: [number, number, number];
  plane: [number, number, number, number] | null;
  more?: [number, number, number, number, number?][]; // planes, and slabs with their thickness
  clip: ClipOperator;
  section?: FaceSource;
  grey?: number;
  shades?: [number, number]; // centre and width of the window
  openings?: GreyOpenings;
  rig?: string;
  turn?: number;
  lamp?: Triple;
}

/** The same with its faces drawn from the volume and by splats. */
export function facesOf(shot: Shot): Shot[] {
  return (["volume", "splats"] as const).map((section) => ({ ...shot, section }));
}

/** Shows a case, unless it is shown. */
export async function choose(page: Evaluates, name: string): Promise<void> {
  await page.evaluate(
    (wanted) => (window.clipgs.state.case === wanted ? undefined : window.clipgs.open(wanted)),
    name,
  );
}

/** Shows a shot of the case that is open. */
export async function show(page: Evaluates, shot: Shot): Promise<void> {
  const { view, plane, more = [], clip, section = "volume", grey = 0, shades } = shot;
  const { openings = "cinematic", rig = null, turn = 0, lamp = null } = shot;
  await page.evaluate(
    ([[azimuth, elevation, zoom], cuts, operator, source, share, [center, width], gaps, lights]) => {
      window.clipgs.setView({ azimuth, elevation, zoom });
      window.clipgs.setMode("arbitrary");
      window.clipgs.setCuts(
        cuts.map(([x, y, z, offset, thickness]) => ({ normal: [x, y, z], offset, thickness })),
      );
      window.clipgs.setClip(operator);
      window.clipgs.setSection(source);
      window.clipgs.setGrey(share);
      window.clipgs.setWindow({ center, width });
      window.clipgs.setOpenings(gaps);
      window.clipgs.setRig(lights.rig);
      window.clipgs.setTurn(lights.turn);
      window.clipgs.setLamp(lights.lamp);
    },
    [
      view,
      plane ? [plane, ...more] : [],
      clip,
      section,
      grey,
      shades ?? [40, 400],
      openings,
      { rig, turn, lamp },
    ] as const,
  );
}

/** What `clipgs render` makes of a shot. */
export async function rendered(
  server: Server,
  shot: Shot,
  size: string,
  options: string[] = [],
): Promise<Picture> {
  return (await renderedAndPrinted(server, shot, size, options)).picture;
}

/** The same, with what it prints. */
export async function renderedAndPrinted(
  server: Server,
  { name = "phantom", view, plane, more = [], clip, section, grey, shades, openings, rig, turn, lamp }: Shot,
  size: string,
  options: string[] = [],
): Promise<{ picture: Picture; printed: string }> {
  const path = join(server.folder, "render.png");
  const cut = [...(plane ? [plane] : []), ...more].flatMap((numbers) => [
    numbers.length > 4 ? "--slab" : "--plane",
    numbers.join(),
  ]);
  const source = section ? ["--section", section] : [];
  const printed = await clipgs(
    "render",
    join(server.cases, `${name}.sog`),
    "-o",
    path,
    "--view",
    view.join(),
    "--clip",
    clip,
    "--size",
    size,
    ...cut,
    ...source,
    ...(grey ? ["--grey", String(grey)] : []),
    ...(openings ? ["--openings", openings] : []),
    ...(rig ? ["--rig", rig] : []),
    ...(turn ? ["--turn-light", String(turn)] : []),
    ...(lamp ? ["--lamp", lamp.join()] : []),
    ...(shades ? ["--window", shades.join()] : []),
    ...options,
  );
  return { picture: readPng(path), printed };
}

/** The value of the phantom at a point, as `clipgs render` prints it. */
export async function valueAt(server: Server, point: readonly number[]): Promise<string> {
  const path = join(server.folder, "pin.png");
  const case_ = join(server.cases, "phantom.sog");
  const printed = await clipgs("render", case_, "-o", path, "--size", "16x16", "--pin", point.join());
  return printed.trim().split("mm: ")[1]!;
}

/** Marks a point, with name and note, and a length on the axial face at S 0; returns the ends of that. */
export function markAxialFace(page: Evaluates): Promise<Triple[]> {
  return page.evaluate(() => {
    const { min, max } = window.clipgs.bounds!;
    const [r, a] = [0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1])];
    const points: [number, number, number][] = [
      [r - 20, a, 0],
      [r + 20, a, 0],
    ];
    window.clipgs.addMark({ kind: "point", points: points.slice(0, 1), name: "A point", note: "A note" });
    window.clipgs.addMark({ kind: "length", points });
    return points;
  }, undefined);
}
