// What a frame takes beside other viewers of Gaussian scenes; run by bench/web.sh, which says how.
//
// Every viewer draws the case's Gaussians in the same view, in turns in one browser: with the camera turning around
// them, and with a plane that moves. clipgs cuts Gaussians where the plane goes through them; Spark and PlayCanvas,
// each by what its documentation offers, remove those whose centre is beyond it; GaussianSplats3D has no planes and
// draws all of them in an order that need not change. All draw splats alone; a case with a section clipgs draws once more
// as people see it, with faces, surfaces and outlines from its volume and the light that a cut lets in. Of a case with
// layers the plane goes from state to state as well, and clipgs draws those by their layers, too.

import { copyFileSync } from "node:fs";
import type { Server } from "node:http";
import { join } from "node:path";
import { parseArgs } from "node:util";
import type { Page } from "playwright-core";
import { Vector3 } from "three";

import type { CaseInfo } from "../src/model/case_info";
import type { FaceSource } from "../src/model/faces";
import { projectBox, type Triple } from "../src/model/geometry";
import { stateCut } from "../src/model/states";
import type { ClipOperator } from "../src/worker/protocol";
import { Session } from "../test/browser/session";
import { caseHasLayers, exportSplats, readCaseInfo } from "./case_file";
import { childrenCpuMs } from "./cpu_time";
import { median, table } from "./measure";
import {
  type Cut,
  kPeers,
  openPeer,
  type Peer,
  type PeerName,
  sceneCamera,
  scenePlane,
  serveFiles,
  waitUntilShown,
} from "./peer_pages";

const { positionals, values } = parseArgs({
  allowPositionals: true,
  options: {
    size: { type: "string", default: "512" }, // px
    frames: { type: "string", default: "12" }, // of a movement
    rounds: { type: "string", default: "5" },
    shots: { type: "string" }, // a folder for what each of them shows
    alone: { type: "boolean", default: false }, // clipgs by itself
  },
});
const [file = ""] = positionals;
const kSize = Number(values.size);
/** What contenders are seen in: each draws as many pixels. */
const kViewport = { width: kSize, height: kSize, scale: 1 };
const kFrames = Number(values.frames);
const kRounds = Number(values.rounds);
const kElevation = 24; // degrees
const kAzimuth = 28;

/** One frame of a movement: where the camera is, and what is cut, RAS mm. */
interface Moment {
  azimuth: number;
  plane: Cut | null;
}

/** What a frame takes, ms: of the clock's time, and of the browser's processors, which other programs change less. */
interface FrameTime {
  clock: number;
  cpu: number;
}

/** A viewer in its page. */
interface Contender {
  name: string;
  page: Page;
  time(movement: Moment[]): Promise<FrameTime>;
}

/** In every page: shows moments, and waits until the GPU has drawn them. */
declare global {
  interface Window {
    show(moment: unknown): void;
    drawFrames(moments: unknown[]): Promise<void>;
  }
}

/** Draws moments by `window.show`, each in a frame of its own. */
function installFrames(): void {
  window.drawFrames = async (moments) => {
    for (const moment of moments) {
      window.show(moment);
      await new Promise(requestAnimationFrame);
    }
    const gl = document
      .querySelector<HTMLCanvasElement>("canvas.stage, body > canvas")!
      .getContext("webgl2")!;
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // when all is drawn
  };
}

async function timeFrames(page: Page, moments: unknown[]): Promise<FrameTime> {
  const draw = (some: unknown[]) => page.evaluate((them) => window.drawFrames(them), some);
  await draw(moments.slice(0, 2)); // nothing is left to wait for
  const [start, used] = [performance.now(), childrenCpuMs()];
  await draw(moments);
  const count = moments.length;
  return { clock: (performance.now() - start) / count, cpu: (childrenCpuMs() - used) / count };
}

async function clipgsPage(session: Session, section: FaceSource): Promise<Page> {
  const page = await session.open(`#size=${kSize}x${kSize}`, [], kViewport);
  await page.keyboard.press("h"); // no handle
  await page.evaluate(installFrames);
  await page.evaluate(
    async ([elevation, source]) => {
      const { clipgs } = window;
      await clipgs.ready;
      clipgs.steady = false;
      clipgs.setSection(source);
      window.show = (moment) => {
        const { azimuth, plane } = moment as Moment;
        clipgs.setView({ azimuth, elevation });
        clipgs.setPlane(plane);
      };
      do {
        await new Promise(requestAnimationFrame);
      } while (!clipgs.stats.settled);
    },
    [kElevation, section] as const,
  );
  return page;
}

function clipgs(page: Page, clip: ClipOperator, how: string = clip): Contender {
  const time = async (movement: Moment[]) => {
    await page.evaluate((operator) => window.clipgs.setClip(operator), clip);
    return timeFrames(page, movement);
  };
  return { name: `clipgs, ${how}`, page, time };
}

/** A viewer that knows the scene alone: its camera and planes are in scene space. */
async function peer(
  session: Session,
  server: Server,
  name: PeerName,
  scene: string,
  info: CaseInfo,
): Promise<Contender> {
  const page = await openPeer(session, server, name, scene, kSize);
  await page.evaluate(installFrames);
  await page.evaluate(async () => {
    const viewer = await (window as unknown as { peer: Promise<Peer> }).peer;
    window.show = (moment) => {
      const { camera, plane } = moment as { camera: number[]; plane: Cut | null };
      viewer.setCamera(camera);
      viewer.setPlane(plane);
      viewer.draw();
    };
  });
  const time = (movement: Moment[]) => {
    const moments = movement.map(({ azimuth, plane }) => ({
      camera: sceneCamera(info, azimuth, kElevation, kSize).toArray(),
      plane: plane && scenePlane(info, plane),
    }));
    return timeFrames(page, moments);
  };
  return { name: kPeers[name], page, time };
}

/** The offset of the plane of this normal that cuts half of the splats away. */
async function halfOffset(page: Page, normal: Triple, [first, last]: [number, number]): Promise<number> {
  let [low, high] = [first, last];
  for (let step = 0; step < 8; ++step) {
    const offset = 0.5 * (low + high);
    const { drawn, total } = await page.evaluate(
      async (plane) => {
        window.clipgs.setPlane(plane);
        do {
          await new Promise(requestAnimationFrame);
        } while (!window.clipgs.stats.settled);
        return window.clipgs.stats;
      },
      { normal, offset },
    );
    [low, high] = drawn > 0.5 * total ? [offset, high] : [low, offset];
  }
  return low;
}

/** The plane of a state. */
function planeOfState({ states }: CaseInfo, state: number): Cut {
  const { normal, offset } = stateCut(states, state);
  return { normal: normal.toArray(), offset };
}

async function makeMovements(info: CaseInfo, page: Page): Promise<Record<string, Moment[]>> {
  const { bounds, states } = info;
  const axis = new Vector3(1, 0.3, 0.5).normalize();
  const normal = axis.toArray();
  const [first, last] = projectBox(bounds, axis);
  const at = (share: number) => ({ normal, offset: first + share * (last - first) });
  const half = { normal, offset: await halfOffset(page, normal, [first, last]) };
  const movement = (moment: (share: number) => Moment) =>
    Array.from({ length: kFrames }, (_, i) => moment(i / (kFrames - 1)));
  return {
    "turning, uncut": movement((s) => ({ azimuth: kAzimuth + 20 * s, plane: null })),
    "turning, half cut": movement((s) => ({ azimuth: kAzimuth + 20 * s, plane: half })),
    "plane moving": movement((s) => ({ azimuth: kAzimuth, plane: at(0.8 - 0.7 * s) })),
    ...((await caseHasLayers(file)) && {
      "from state to state": movement((s) => ({
        azimuth: kAzimuth,
        plane: planeOfState(info, Math.round((0.2 + 0.7 * s) * (states.count - 1))),
      })),
    }),
  };
}

async function openAll(session: Session, info: CaseInfo, server: Server): Promise<Contender[]> {
  const page = await clipgsPage(session, "splats");
  const contenders = [clipgs(page, "exact"), clipgs(page, "hard")];
  if (await page.evaluate(() => window.clipgs.stats.sectionBytes > 0)) {
    contenders.push(clipgs(await clipgsPage(session, "volume"), "exact", "with its volume"));
  }
  if (await caseHasLayers(file)) {
    contenders.push(clipgs(page, "layers"));
  }
  if (values.alone) {
    return contenders;
  }
  const splats = join(session.folder, "splats.ply");
  exportSplats(file, splats);
  for (const name of Object.keys(kPeers) as PeerName[]) {
    const scene = name === "gs3d" ? splats : file; // which reads no SOG
    contenders.push(await peer(session, server, name, scene, info));
  }
  return contenders;
}

async function main(): Promise<void> {
  const info = await readCaseInfo(file);
  const session = new Session();
  await session.start((cases) => copyFileSync(file, join(cases, "case.sog")));
  const server = await serveFiles();
  try {
    const contenders = await openAll(session, info, server);
    const movements = await makeMovements(info, contenders[0]!.page);
    for (const contender of contenders) {
      const first = { azimuth: kAzimuth, plane: null };
      await waitUntilShown(contender.page, async () => void (await contender.time([first, first, first])));
    }
    const times = contenders.map(() => Object.keys(movements).map((): FrameTime[] => []));
    for (let round = 0; round < kRounds; ++round) {
      for (const [m, [movement, moments]] of Object.entries(movements).entries()) {
        for (const [c, contender] of contenders.entries()) {
          await contender.page.bringToFront();
          const time = await contender.time(moments);
          times[c]![m]!.push(time);
          console.error(`${contender.name}, ${movement}: ${time.clock.toFixed(0)} ms a frame`);
          if (values.shots && round === 0) {
            const name = `${contender.name} ${movement}.png`.replaceAll(/[ ,]+/g, "-");
            await contender.page.screenshot({ path: join(values.shots, name) });
          }
        }
      }
    }
    for (const kind of ["clock", "cpu"] as const) {
      const medians = times.map((one) => one.map((rounds) => median(rounds.map((time) => time[kind]))));
      const rows = contenders.map(({ name }, c) => [
        name,
        ...medians[c]!.map((ms, m) => `${ms.toFixed(0)} (${(medians[0]![m]! / ms).toFixed(2)})`),
      ]);
      const what = kind === "clock" ? "ms a frame" : "ms of processor a frame";
      console.log(table([`${what} (clipgs, exact, to this)`, ...Object.keys(movements)], rows) + "\n");
    }
  } finally {
    server.close();
    process.exitCode = (await session.stop()) ?? 0;
  }
}

await main();
