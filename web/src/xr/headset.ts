import { signal } from "@preact/signals-core";
import { ArrayCamera, PerspectiveCamera, Vector3 } from "three";

import type { Actions } from "../actions";
import type { EyePicture, Surroundings } from "../api";
import { makeBackdrop } from "../render/depth_cue";
import type { OpenCase } from "../render/open_case";
import { pictureOf, type Subject } from "../render/splat_layer";
import type { LoadingCase } from "../model/case_list";
import type { Marking } from "../model/marking";
import type { Study } from "../study/study";
import { CaseError } from "../sog/zip";
import { viewDirection } from "../model/view";
import type { TourPlayer } from "../tour_player";
import type { Message } from "../ui/message";
import type { Viewer } from "../viewer";
import { type Eye, makeBothEyes, setBothEyes } from "./eyes";
import { type Effort, Governor } from "./governor";
import { Hand } from "./hand";
import { HeldLamp } from "./held_lamp";
import type { Panel } from "./panel/panel";
import type { PanelHost } from "./panel/panel_context";
import { RoomFloor } from "./room_floor";
import { Stage } from "./stage";

/** What this browser's headset offers; none without one. */
export async function offeredSurroundings(): Promise<Surroundings[]> {
  const { xr } = navigator;
  const all: Surroundings[] = ["immersive-vr", "immersive-ar"];
  const offered = await Promise.all(
    all.map(async (one) => (await xr?.isSessionSupported(one).catch(() => false)) ?? false),
  );
  return all.filter((_, i) => offered[i]);
}

/** What is far away fades to this: nothing is known of what lies behind a case in a room. */
const kDarkness = makeBackdrop();
const kNear = 0.05; // m
const kFar = 30;
/** How fast a stick slides the plane, mm or states a second. */
const kStickSpeed = 40;
/** Frames a second where the headset does not say: the least that one shows. */
const kFrameRate = 72;

/** Stands where its matrices say. */
function fixedCamera<T extends PerspectiveCamera>(camera: T): T {
  camera.matrixAutoUpdate = camera.matrixWorldAutoUpdate = false;
  return camera;
}

/** What is done for the headset by what the viewer stands in. */
type HeadsetHost = Pick<PanelHost, "cases" | "looks" | "open"> & Partial<Pick<PanelHost, "news">>;

/** A case in a headset: while it is worn, it draws in place of the page. */
export class Headset {
  readonly stage: Stage;
  readonly governor = new Governor();
  #effort: Effort | null = null; // that the headset knows of
  /** It is put on or taken off. */
  changed: () => void = () => {};
  /** A frame is drawn at `time`, ms, with the head at a place of the room, m, looking along `forward`. */
  framed: (time: number, head: Vector3, forward: Vector3) => void = () => {};
  /** The case that is on its way. */
  readonly loading = signal<LoadingCase | null>(null);
  /** Of what is shown here, in the panel's place. */
  study: Study | null = null;
  /** Null until it is worn for the first time. */
  panel: Panel | null = null;
  readonly #viewer: Viewer;
  readonly #actions: Actions;
  readonly #marking: Marking;
  readonly #host: HeadsetHost;
  readonly #tour: TourPlayer;
  readonly #message: Message;
  readonly #camera = new PerspectiveCamera(70, 1, kNear, kFar);
  readonly #both = makeBothEyes();
  readonly #hands: Hand[];
  readonly #lamp: HeldLamp;
  readonly #floor = new RoomFloor();
  #seesRoom = false; // of the person who wears it
  readonly #forward = new Vector3();
  readonly #eye = new Vector3(); // scratch
  #placed = false;
  #time = 0;
  #shown: OpenCase | null = null;
  #version = -1;
  #drawnWith: Effort | null = null;
  #subject: Subject | null = null;
  readonly #inWorld = fixedCamera(new PerspectiveCamera()); // what eyes see of the viewer's world
  readonly #inRoom = fixedCamera(new ArrayCamera()); // an eye
  readonly #wanted: ((eyes: EyePicture[]) => void)[] = []; // of the next frame

  /** `host` lists and opens cases; what `message` says is said here, too. */
  constructor(
    viewer: Viewer,
    actions: Actions,
    marking: Marking,
    tour: TourPlayer,
    message: Message,
    host: HeadsetHost,
  ) {
    this.#viewer = viewer;
    this.#actions = actions;
    this.#marking = marking;
    this.#host = host;
    this.#tour = tour;
    this.#message = message;
    const onPage = actions.lookingFrom;
    actions.lookingFrom = () => this.#lookingFrom ?? onPage();
    this.stage = new Stage(viewer, marking);
    this.stage.grabbed = () => tour.pause();
    const { xr } = viewer.renderer;
    this.#hands = [0, 1].map(
      (index) => new Hand(xr, index, this.#camera, this.stage.solid, () => this.#placePanel()),
    );
    this.#lamp = new HeldLamp(viewer, this.stage);
    this.stage.scene.add(...this.#hands.map((hand) => hand.object), this.#lamp.object, this.#floor.object);
    xr.addEventListener("sessionend", () => this.#takenOff());
    // What a session draws into does not come back.
    viewer.canvas.addEventListener("webglcontextlost", () => void this.leave());
  }

  get worn(): boolean {
    return this.#viewer.renderer.xr.isPresenting;
  }

  /** Frames a second that it shows; null: it is not worn, or does not say. */
  get frameRate(): number | null {
    return this.#viewer.renderer.xr.getSession()?.frameRate ?? null;
  }

  /** Fetches the code that is wanted in a headset alone. */
  prefetch(): void {
    void Promise.all([import("./panel/panel"), import("./input_model")]).catch(() => {});
  }

  /** Has ready what is drawn there besides the case, so that the first frame waits for nothing. */
  async prepare(): Promise<void> {
    await this.#makePanel();
    this.#viewer.renderer.compile(this.stage.scene, this.#camera);
  }

  /** Shows the case there. Rejects with CaseError. Needs a click: browsers want one. */
  async enter(surroundings: Surroundings): Promise<void> {
    const { renderer } = this.#viewer;
    let session: XRSession | undefined;
    try {
      const starting = navigator.xr!.requestSession(surroundings, {
        requiredFeatures: ["local-floor"],
        optionalFeatures: ["hand-tracking"],
      });
      const prepared = this.prepare(); // meanwhile
      prepared.catch(() => {}); // which is said once there is a session to end
      session = await starting;
      await prepared;
      renderer.xr.enabled = true;
      renderer.xr.setReferenceSpaceType("local-floor");
      await renderer.xr.setSession(session);
      this.#seesRoom = session.environmentBlendMode !== "opaque";
      this.#followHands(session);
    } catch (error) {
      renderer.xr.enabled = false;
      await session?.end().catch(() => {});
      throw new CaseError(`the headset does not start: ${(error as Error).message}`);
    }
    this.#placed = false;
    this.#version = -1;
    this.#effort = null;
    this.#viewer.yieldTo(this);
    // That of the renderer would draw in the page's frames as well.
    renderer.xr.setAnimationLoop((time, frame) => this.#frame(time, frame));
    this.changed();
  }

  /** What a hand does from its press on is one step of the history. */
  #followHands(session: XRSession): void {
    for (const type of ["selectstart", "squeezestart"] as const) {
      session.addEventListener(type, ({ inputSource }) => this.#actions.takeHold(inputSource));
    }
    for (const type of ["selectend", "squeezeend"] as const) {
      session.addEventListener(type, ({ inputSource }) => this.#actions.letGo(inputSource));
    }
  }

  async leave(): Promise<void> {
    await this.#viewer.renderer.xr.getSession()?.end();
  }

  /** What the eyes see of the case in the next frame, without hands and handles. */
  capture(): Promise<EyePicture[]> {
    return new Promise((resolve) => this.#wanted.push(resolve));
  }

  /** Puts the case, and the panel beside it, before the eyes again. */
  place(): void {
    this.#placed = false;
  }

  /** Something of the state is another. */
  refresh(): void {
    this.panel?.refresh();
  }

  dispose(): void {
    void this.leave();
    this.stage.dispose();
    this.panel?.dispose();
    this.#hands.forEach((hand) => hand.dispose());
    this.#lamp.dispose();
    this.#floor.dispose();
  }

  /** Its code is large, and wanted here alone. */
  async #makePanel(): Promise<void> {
    const { Panel, prepareRenderer } = await import("./panel/panel");
    if (!this.panel) {
      prepareRenderer(this.#viewer.renderer);
      const { stage } = this;
      const study = () => this.study;
      this.panel = new Panel(this.#viewer, this.#actions, this.#marking, {
        cases: () => this.#host.cases(),
        looks: () => this.#host.looks(),
        news: () => this.#host.news?.() ?? "",
        open: (name) => this.#host.open(name),
        loading: this.loading,
        message: this.#message,
        tour: this.#tour,
        // Not while the press is still told of, as hands are gone then.
        leave: () => queueMicrotask(() => void this.leave()),
        place: () => this.place(),
        turnTo: (side) => this.stage.turnTo(side, this.#both.middle),
        get study() {
          return study();
        },
        stage,
        governor: this.governor,
        lamp: this.#lamp,
        hands: this.#hands,
        summon: () => this.#placePanel(),
      });
      stage.scene.add(this.panel.object);
    }
    await this.panel.ready;
  }

  #placePanel(): void {
    this.panel?.place(this.#both.middle, this.#forward);
  }

  /** From the case towards the eyes, RAS; null where there is no case. */
  get #lookingFrom(): Vector3 | null {
    const center = this.#viewer.info?.sphere.center;
    return this.worn && center ? this.stage.toPatient(this.#both.middle).sub(center).normalize() : null;
  }

  #takenOff(): void {
    this.#marking.toggle(null);
    this.#actions.letAllGo();
    this.#lamp.hand = null;
    const { renderer } = this.#viewer;
    renderer.setAnimationLoop(null); // nor of the page, which the renderer goes on with
    renderer.xr.enabled = false;
    if (this.#shown) {
      this.#shown.mesh.extent = Infinity;
    }
    this.stage.setCase(null);
    this.#shown = null;
    this.#subject = null;
    this.#viewer.yieldTo(null);
    this.changed();
  }

  #frame(time: number, frame: XRFrame): void {
    const viewer = this.#viewer;
    const { renderer } = viewer;
    this.#govern(time, frame);
    renderer.xr.updateCamera(this.#camera);
    const eyes = renderer.xr.getCamera().cameras as Eye[];
    viewer.tick();
    if (eyes.length === 0) {
      return; // it does not know where it is yet
    }
    setBothEyes(this.#both, eyes);
    this.#show(viewer.openCase);
    const { middle, camera, width, height } = this.#both;
    this.#forward.set(0, 0, -1).transformDirection(camera.matrixWorld);
    if (!this.#placed) {
      this.#placed = true;
      this.stage.place(middle, this.#forward);
      this.#placePanel();
    }
    this.framed(time, middle, this.#forward);
    this.#hands.forEach((hand) => hand.update(this.stage.scene, time, this.panel!.crowd, middle));
    this.#lamp.update(this.#hands);
    this.#slide(Math.min(0.1, 0.001 * (time - this.#time)));
    this.#turnWithTour();
    this.#time = time;
    const pixelAngle = 2 / (eyes[0]!.viewport.w * eyes[0]!.projectionMatrix.elements[5]);
    this.stage.update(time, middle, pixelAngle);
    this.panel?.update(time, middle);
    if (this.#shown) {
      this.#prepare(this.#shown, camera, width, height);
    }
    if (this.#wanted.length > 0) {
      this.#draw(eyes, false);
      const pictures = eyes.map((eye) => this.#read(eye));
      this.#wanted.splice(0).forEach((resolve) => resolve(pictures));
    }
    this.#draw(eyes, true);
  }

  /** Sticks slide the plane that is not held, and tick at every state; or change the window, where that is wanted. */
  #slide(seconds: number): void {
    const { grip, windowGrip } = this.stage;
    windowGrip.update(this.#forward);
    for (const hand of this.#hands) {
      if (windowGrip.enabled) {
        windowGrip.push(hand.stick, seconds);
        continue;
      }
      const stick = hand.stick.forward;
      if (stick !== 0 && !grip.holding && !grip.locked) {
        const before = this.#viewer.store.planeState;
        this.#actions.step(stick * Math.abs(stick) * kStickSpeed * seconds);
        if (this.#viewer.store.planeState !== before) {
          hand.pulse(0.2, 8);
        }
      }
    }
  }

  /** Where the page's camera flies, the case turns in its place: nobody's head is moved. */
  #turnWithTour(): void {
    const before = this.#tour.share;
    const after = this.#tour.tick(performance.now());
    if (before !== null && after !== null) {
      const { azimuth, elevation } = this.#viewer.state.view;
      // Of what is left of the way: at its end it lies as the view says, however it lay in the hand.
      const share = (after - before) / (1 - before);
      this.stage.turnTo(viewDirection(azimuth, elevation), this.#both.middle, share);
    }
  }

  /** No more is drawn than the headset has time for. */
  #govern(time: number, frame: XRFrame): void {
    const { xr } = this.#viewer.renderer;
    const rate = this.frameRate ?? kFrameRate;
    this.governor.count(time, 1000 / rate);
    const { effort } = this.governor;
    if (effort === this.#effort) {
      return;
    }
    this.panel?.refresh();
    const space = xr.getReferenceSpace();
    const pose = space && frame.getViewerPose(space);
    if (pose) {
      this.#effort = effort; // a view keeps what was asked for
      pose.views.forEach((view) => view.requestViewportScale?.(effort.scale));
    }
  }

  /**
   * The case, with what it is held and cut by or alone. One eye after the other: what both see of the case is drawn
   * into the same textures.
   */
  #draw(eyes: readonly Eye[], tools: boolean): void {
    const { renderer, layer } = this.#viewer;
    this.stage.setToolsVisible(tools);
    this.#hands.forEach((hand) => (hand.object.visible = tools));
    this.#lamp.object.visible &&= tools;
    this.#floor.object.visible = tools && !this.#seesRoom;
    this.panel!.object.visible = tools;
    renderer.xr.enabled = false;
    renderer.clear();
    for (const eye of eyes) {
      if (this.#subject) {
        this.stage.seeWorld(eye, this.#inWorld);
        layer.drawEye(this.#subject, this.#inWorld, eye.viewport);
      }
      this.#inRoom.cameras = [eye];
      this.#inRoom.layers.mask = eye.layers.mask;
      this.#inRoom.matrixWorld.copy(eye.matrixWorld);
      this.#inRoom.matrixWorldInverse.copy(eye.matrixWorldInverse);
      this.#inRoom.projectionMatrix.copy(eye.projectionMatrix);
      renderer.render(this.stage.scene, this.#inRoom);
    }
    renderer.xr.enabled = true;
  }

  /** What was just drawn for an eye. */
  #read(eye: Eye): EyePicture {
    const { x, y, z: w, w: h } = eye.viewport;
    const gl = this.#viewer.renderer.getContext();
    const rows = new Uint8Array(4 * w * h);
    gl.readPixels(x, y, w, h, gl.RGBA, gl.UNSIGNED_BYTE, rows);
    const p = eye.projectionMatrix.elements;
    const pose = this.stage.poseInPatient(eye.matrixWorld).transpose().elements;
    return {
      picture: pictureOf(rows, w, h),
      camera: {
        w,
        h,
        fl_x: 0.5 * w * p[0],
        fl_y: 0.5 * h * p[5],
        cx: 0.5 * w * (1 - p[8]),
        cy: 0.5 * h * (1 + p[9]),
        transform_matrix: [0, 4, 8, 12].map((at) => pose.slice(at, at + 4)),
      },
    };
  }

  #show(shown: OpenCase | null): void {
    if (shown !== this.#shown) {
      this.stage.setCase(shown);
      this.#shown = shown;
      this.#version = -1;
      this.#subject = null;
    }
  }

  /** The newest cut, colours as seen from here, and a new order as soon as the last one is there. */
  #prepare(shown: OpenCase, camera: PerspectiveCamera, width: number, height: number): void {
    const viewer = this.#viewer;
    const { state, window, version } = viewer;
    const { effort } = this.governor;
    this.stage.seeWorld(camera, this.#inWorld);
    if (version !== this.#version || effort !== this.#drawnWith) {
      this.#version = version;
      this.#drawnWith = effort;
      this.#subject = shown.subject(this.#inWorld, height, state, window, effort);
      shown.cue.setBackdrop(kDarkness, 1);
    }
    const middle = this.stage.toWorld(this.#eye.copy(this.#both.middle));
    shown.mesh.updateColors(viewer.renderer, shown.mesh.scenePoint(middle));
    shown.mesh.extent = effort.extent;
    viewer.sortFor({ camera: this.#inWorld, width, height, leastPixels: effort.leastPixels });
  }
}
