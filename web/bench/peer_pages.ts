// Pages of other viewers (bench/peers), and where their cameras and planes are: in the space of a scene's file.

import { createReadStream, existsSync } from "node:fs";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { extname, resolve } from "node:path";
import type { Page } from "playwright-core";
import { Matrix4, PerspectiveCamera, Vector3 } from "three";

import type { CaseInfo } from "../src/model/case_info";
import { kWorldFromPatient, type Triple } from "../src/model/geometry";
import { applyView, kFieldOfView, viewFrom } from "../src/model/view";
import { makeSceneCamera, setSceneCamera } from "../src/render/scene_camera";
import type { Session } from "../test/browser/session";

export const kPeers = {
  spark: "Spark 2.2.0",
  playcanvas: "PlayCanvas 2.23.3",
  gs3d: "GaussianSplats3D 0.4.7",
};
export type PeerName = keyof typeof kPeers;

const kBlankBytes = 10_000; // of a picture that shows nothing, at most

/** Keeps dot(normal, x) >= offset. */
export interface Cut {
  normal: Triple;
  offset: number;
}

/** What the pages in bench/peers resolve to, by `window.peer`. */
export interface Peer {
  setCamera(matrix: number[]): void;
  setPlane(plane: Cut | null): void;
  draw(): void;
}

/** The matrix of a camera of three.js in scene space, of a square picture of that size, px; angles in degrees. */
export function sceneCamera(info: CaseInfo, azimuth: number, elevation: number, size: number): Matrix4 {
  const camera = new PerspectiveCamera();
  applyView(camera, viewFrom(azimuth, elevation), info.sphere, size, size);
  const world = new Matrix4().multiplyMatrices(kWorldFromPatient, info.sceneToPatient);
  const seen = makeSceneCamera();
  setSceneCamera(seen, camera, world, size, size, info.mmPerUnit);
  const { rotation, position } = seen;
  const [right, down, forward] = [new Vector3(), new Vector3(), new Vector3()];
  new Matrix4().setFromMatrix3(rotation).transpose().extractBasis(right, down, forward);
  return new Matrix4().makeBasis(right, down.negate(), forward.negate()).setPosition(position);
}

/** A plane of the patient's space in scene space. */
export function scenePlane({ sceneToPatient, mmPerUnit }: CaseInfo, { normal, offset }: Cut): Cut {
  const n = new Vector3(...normal);
  const origin = new Vector3().setFromMatrixPosition(sceneToPatient);
  const inScene = n.clone().transformDirection(sceneToPatient.clone().invert());
  return { normal: inScene.toArray(), offset: (offset - n.dot(origin)) / mmPerUnit };
}

/** Serves files by their absolute path. */
export function serveFiles(): Promise<Server> {
  const types: Record<string, string> = {
    ".html": "text/html",
    ".js": "text/javascript",
    ".mjs": "text/javascript",
  };
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url!, "http://localhost").pathname);
    if (existsSync(path)) {
      response.setHeader("Content-Type", types[extname(path)] ?? "application/octet-stream");
      createReadStream(path).pipe(response);
    } else {
      response.writeHead(404).end();
    }
  });
  return new Promise((done) => server.listen(0, "127.0.0.1", () => done(server)));
}

/** Opens a scene's file in one of them, `size` px a side. */
export async function openPeer(
  session: Session,
  server: Server,
  name: PeerName,
  scene: string,
  size: number,
): Promise<Page> {
  const { port } = server.address() as AddressInfo;
  const wanted = new URLSearchParams({
    peer: name,
    scene: resolve(scene),
    size: String(size),
    fov: String((kFieldOfView * 180) / Math.PI),
  });
  const url = `http://127.0.0.1:${port}${resolve("bench/peers/index.html")}?${wanted}`;
  const page = await session.openPage(url, [], { width: size, height: size, scale: 1 });
  page.on("pageerror", (error) => console.error(`${kPeers[name]}: ${error.message}`));
  await page.waitForFunction(() => "peer" in window);
  return page;
}

/** Draws until something is seen: some begin a while after they say that they are ready. Returns the picture. */
export async function waitUntilShown(page: Page, draw: () => Promise<void>): Promise<Buffer> {
  for (let i = 0; i < 60; ++i) {
    await page.bringToFront();
    await draw();
    const shot = await page.screenshot();
    if (shot.length > kBlankBytes) {
      return shot;
    }
  }
  throw new Error(`${page.url()} shows nothing`);
}
