import { HandleStore } from "@pmndrs/handle";
import { Container, reversePainterSortStable, Text } from "@pmndrs/uikit";
import { computed, signal } from "@preact/signals-core";
import {
  Group,
  type Object3D,
  Sphere,
  SRGBColorSpace,
  type Texture,
  TextureLoader,
  Vector3,
  type WebGLRenderer,
} from "three";

import { type Actions, kLeastThickness } from "../../actions";
import { type CaseSummary, failureText, formatCount } from "../../model/case_list";
import type { FaceSource } from "../../model/faces";
import type { GreyOpenings } from "../../model/face_style";
import { isSameWindow, type Window } from "../../model/grey";
import { kRigs } from "../../model/rigs";
import { type CaseGroup, countText, groupCases, type Look } from "../../model/looks";
import type { Layers } from "../../model/layers";
import { kOrientations, type Orientation, orientationOf, planeText } from "../../model/planes";
import type { Marking } from "../../model/marking";
import { type Mark, type MarkKind, markText, measure } from "../../model/marks";
import type { Mode } from "../../model/states";
import { capital } from "../../model/values";
import type { Study } from "../../study/study";
import type { Viewer } from "../../viewer";
import type { ClipOperator } from "../../worker/protocol";
import type { Effort, Governor } from "../governor";
import type { HeldLamp } from "../held_lamp";
import { kLeastScale, kMostScale, type Stage } from "../stage";
import { kHelp } from "./help";
import { OrientationCube } from "./orientation_cube";
import { OrientationLetters } from "./orientation_letters";
import { RoomMarks } from "./room_marks";
import { SdfFont } from "./sdf_font";
import { StudyBoard } from "./study_board";
import { WristButton } from "./wrist_button";
import {
  button,
  choice,
  column,
  findText,
  type Live,
  label,
  replaceChildren,
  row,
  slider,
  space,
} from "./widgets";

/** Among rigs, the lights that the case was made in. */
const kOwnLight = "";
type LampHand = "none" | "left" | "right";
/** More than three buttons do not stand in a row. */
const kRigRows = [0, 3].map((first) => [kOwnLight, ...kRigs.keys()].slice(first, first + 3));

/** m a px. */
const kPixel = 0.001;
const kWidth = 480; // px
/** Where it is put: this far from the eyes, aside of where they look and below, m and radians. */
const kAway = 1.0;
const kAside = 0.72;
const kBelow = 0.12;
/** How near and how far it can be moved, m. */
const kNearest = 0.6;
const kFarthest = 2;
/** Of its top above its middle, m. */
const kTop = 0.27;
/** Of the cube from its middle, m: above its right end. */
const kCube = new Vector3(0.2, kTop + 0.055, 0);
/** It follows the state so often while something moves, ms. */
const kRefreshMs = 100;
/** What is drawn is counted so often, ms. */
const kCountMs = 500;
/** What is met first, where a hand points at several things. */
const kOrder = 2;

const kOperators = { hard: "Hard", soft: "Soft", exact: "Exact" } as const;

const kMarkNames: Readonly<Record<MarkKind, string>> = {
  point: "Point",
  length: "Length",
  angle: "Angle",
  region: "Circle",
  outline: "Outline",
};

const kCaseTabs = { cut: "Cut", faces: "Faces", marks: "Marks", layers: "Layers" } as const;
const kOtherTabs = { cases: "Cases", view: "View", help: "Help" } as const;
/** Looks have no tab where all are, but a button that is there where the volume has several. */
type Tab = keyof typeof kCaseTabs | keyof typeof kOtherTabs | "looks";

/** Of cases that have one. */
type Pictures = ReadonlyMap<CaseSummary, Texture | null>;

/** What is done for the panel by what is around it. */
export interface PanelHost {
  cases(): Promise<CaseSummary[]>;
  /** Of the volume that is shown; none where it has one alone. */
  looks(): readonly Look[];
  /** What the case is where it is not finished, and when there will be a better one. */
  news(): string;
  open(name: string): Promise<void>;
  leave(): void;
  /** Puts case and panel before the eyes, the case in life size. */
  place(): void;
  /** Turns the case so that a side of the patient (RAS) is looked at. */
  turnTo(side: Vector3): void;
  /** That is led through, if one is: the panel is its alone then. */
  readonly study: Study | null;
  readonly stage: Stage;
  readonly governor: Governor;
  readonly lamp: HeldLamp;
  /** Of bare hands. */
  readonly wrists: readonly Object3D[];
  /** Puts the panel before the eyes. */
  summon(): void;
}

/** What uikit needs of a renderer. */
export function prepareRenderer(renderer: WebGLRenderer): void {
  renderer.localClippingEnabled = true;
  renderer.setTransparentSort(reversePainterSortStable);
}

/** Everything that the page's panels do, as a panel in the room. */
export class Panel {
  /** In the room: the panel, and what is marked. */
  readonly object = new Group();
  readonly #board = new Group();
  readonly #viewer: Viewer;
  readonly #actions: Actions;
  readonly #marking: Marking;
  readonly #marks: RoomMarks;
  readonly #letters: OrientationLetters;
  readonly #cube: OrientationCube;
  #lettered = true;
  readonly #host: PanelHost;
  readonly #font = new SdfFont();
  readonly #root: Container;
  readonly #own: Container; // all of it but a study's
  readonly #studying = signal(false);
  #study: StudyBoard | null = null;
  readonly #tab = signal<Tab>("cut");
  readonly #version = signal(0); // of what is shown
  readonly #message = signal("");
  readonly #windows = row();
  readonly #cards = column({ gap: 6 });
  readonly #looks = column({ gap: 6 });
  readonly #listed = column({ gap: 6 }); // marks
  readonly #wristButtons: readonly WristButton[];
  readonly #move: HandleStore<unknown>;
  readonly #release: () => void;
  readonly #textures = new TextureLoader();
  readonly #pictures = new Map<string, Promise<Texture | null>>();
  #shownMarks: readonly Mark[] = [];
  #shownWindows: ReadonlyMap<string, Window> = new Map();
  #atRight = false; // of what the eyes look at
  #stale = false;
  #refreshed = 0;
  #time = 0;
  readonly #eye = new Vector3();
  /** What hands meet of it, and where that is in the room. */
  readonly crowd = { parts: new Group(), sphere: new Sphere() };
  readonly #cubePlace = new Vector3(); // scratch

  constructor(viewer: Viewer, actions: Actions, marking: Marking, host: PanelHost) {
    this.#viewer = viewer;
    this.#actions = actions;
    this.#marking = marking;
    this.#host = host;
    this.#marks = new RoomMarks(viewer, (text) => this.#font.families(text));
    this.#letters = new OrientationLetters(this.#font.families());
    this.#cube = new OrientationCube((side) => host.turnTo(side), kOrder);
    const bar = new Container({ height: 22, alignItems: "center", justifyContent: "center" }).add(
      new Container({ width: 120, height: 6, borderRadius: 3, backgroundColor: "#5a6270" }),
    );
    this.#root = column(
      {
        pixelSize: kPixel,
        width: kWidth,
        padding: 16,
        gap: 10,
        borderRadius: 20,
        backgroundColor: "#14171c",
        fontFamilies: this.#font.families(),
        anchorX: "center",
        anchorY: "top", // tabs stay where they are, however much is in them
        "*": { pointerEventsOrder: kOrder, borderColor: "#7fd8f2" },
      },
      bar,
      this.#header(),
    );
    this.#own = column(
      { gap: 10, display: computed(() => (this.#studying.value ? "none" : "flex")) },
      choice<Tab>(kCaseTabs as Record<Tab, string>, this.#tab, (tab) => this.show(tab)),
      choice<Tab>(kOtherTabs as Record<Tab, string>, this.#tab, (tab) => this.show(tab)),
      ...this.#cut(),
      ...this.#faces(),
      ...this.#markTab(),
      ...this.#layers(),
      this.#scrolled("cases", this.#cards),
      this.#scrolled("looks", this.#looks),
      ...this.#view(),
      this.#only("help", help()),
      new Text({
        text: this.#message,
        color: "#ffb3a6",
        fontSize: 16,
        display: computed(() => (this.#message.value ? "flex" : "none")),
      }),
    );
    this.#root.add(this.#own);
    // Lifted by what holds it: uikit clips pictures as if the root itself were not moved.
    this.crowd.parts.position.y = kTop;
    this.object.add(this.#board.add(this.crowd.parts.add(this.#root)));
    this.object.add(this.#marks.object, this.#letters.object, this.#cube.object);
    // Nobody presses these; what marks a point is the stage's.
    this.#marks.object.intersectChildren = this.#letters.object.intersectChildren = false;
    this.#wristButtons = host.wrists.map(
      (wrist) => new WristButton(wrist, "Panel", this.#font.families(), () => host.summon()),
    );
    this.#move = new HandleStore(this.#board, () => ({
      scale: false,
      rotate: false,
      multitouch: false,
      apply: ({ current }, board) => {
        board.position.copy(current.position).sub(this.#eye).clampLength(kNearest, kFarthest).add(this.#eye);
        board.lookAt(this.#eye);
      },
    }));
    this.#release = this.#move.bind(bar);
  }

  /** Its text can be drawn. */
  get ready(): Promise<unknown> {
    return this.#font.ready;
  }

  /** Why a case could not be opened; empty: nothing is wrong. */
  get message(): string {
    return this.#message.value;
  }

  /** Says why a case cannot be opened, or shown any more. */
  tell(message: string): void {
    this.#root.setProperties({ fontFamilies: this.#font.families(message) });
    this.#message.value = message;
  }

  /** Where this text is, of a mark, its own, or a letter, or the cube's side of this name, in the room; null: it is
   * not shown, or on a button that cannot be pressed. */
  find(text: string): Vector3 | null {
    return (
      this.#marks.find(text) ??
      findText(this.#root, text) ??
      this.#letters.find(text) ??
      this.#cube.find(text)
    );
  }

  /** Something of the state is another. */
  refresh(): void {
    this.#stale = true;
  }

  /** Opens a tab. */
  show(tab: Tab): void {
    this.#tab.value = tab;
    if (tab === "cases") {
      void this.#listCases();
    } else if (tab === "looks") {
      void this.#listLooks();
    }
  }

  /** Puts it beside what eyes at `eye` look at along `forward`, at their left or right. */
  place(eye: Vector3, forward: Vector3): void {
    const direction = new Vector3(forward.x, 0, forward.z).normalize();
    direction.applyAxisAngle(new Vector3(0, 1, 0), this.#atRight ? -kAside : kAside);
    this.#board.position.copy(eye).addScaledVector(direction, kAway);
    this.#board.position.y -= kBelow;
    this.#board.lookAt(eye);
  }

  /** Before a frame, seen from `eye` in the room. */
  update(time: number, eye: Vector3): void {
    this.#eye.copy(eye);
    const counting = this.#tab.value === "view" && time - this.#refreshed > kCountMs;
    // A study's board is small, and nothing that is over is to be pressed there.
    const due = this.#studying.value || time - this.#refreshed > kRefreshMs;
    if (counting || (this.#stale && due)) {
      this.#stale = false;
      this.#refreshed = time;
      this.#showWindows();
      this.#showMarks();
      this.#updateStudy();
      ++this.#version.value;
    }
    this.#move.update(time);
    const delta = Math.min(100, time - this.#time);
    this.#time = time;
    this.#root.update(delta);
    this.#wristButtons.forEach((one) => one.update(eye, delta));
    const { stage } = this.#host;
    const bounds = this.#viewer.info?.bounds;
    this.#letters.object.visible = this.#lettered && bounds !== undefined;
    if (this.#lettered && bounds) {
      this.#letters.update(bounds, stage.roomFromPatient, eye, delta);
    }
    const { reading, roomFromPatient } = stage;
    this.#marks.update(reading, roomFromPatient, eye, stage.toPatient(eye), delta);
    this.#cube.place(this.#inRoom(this.#cubePlace.copy(kCube)), stage.quaternion);
    this.#updateCrowd();
  }

  dispose(): void {
    this.#release();
    this.#root.dispose();
    this.#marks.dispose();
    this.#letters.dispose();
    this.#cube.dispose();
    this.#wristButtons.forEach((one) => one.dispose());
    this.#pictures.forEach((picture) => void picture.then((one) => one?.dispose()));
  }

  /** Of a point of the board. */
  #inRoom(point: Vector3): Vector3 {
    return point.applyQuaternion(this.#board.quaternion).add(this.#board.position);
  }

  #updateStudy(): void {
    const { study } = this.#host;
    if (study && !this.#study) {
      this.#study = new StudyBoard(study, this.#actions, this.#font);
      this.#root.add(this.#study.content);
      this.#studying.value = true;
    }
    this.#study?.update();
  }

  #updateCrowd(): void {
    const [width, height] = this.#root.size.peek() ?? [0, 0];
    const { sphere } = this.crowd;
    sphere.radius = 0.5 * kPixel * Math.hypot(width, height);
    this.#inRoom(sphere.center.set(0, kTop - 0.5 * kPixel * height, 0));
  }

  #live<T>(read: () => T): Live<T> {
    return computed(() => {
      void this.#version.value;
      return read();
    });
  }

  /** What is shown in a tab, where `where` holds. */
  #only(tab: Tab, element: Container | Text, where: () => boolean = () => true): Container | Text {
    const shown = this.#live(where);
    element.setProperties({
      display: computed(() => (this.#tab.value === tab && shown.value ? "flex" : "none")),
    });
    return element;
  }

  #header(): Container {
    const title = this.#live(() => {
      const name = this.#viewer.info?.title || this.#viewer.caseName || "No case";
      return [name, this.#host.news()].filter(Boolean).join(" · ");
    });
    const looks = button("Looks", () => this.show("looks"), {
      pressed: computed(() => this.#tab.value === "looks"),
    });
    const several = this.#live(() => this.#host.looks().length > 0);
    looks.setProperties({
      flexGrow: 0,
      flexBasis: 90,
      display: computed(() => (several.value && !this.#studying.value ? "flex" : "none")),
    });
    return row(
      column(
        { gap: 2, flexGrow: 1, flexShrink: 1 },
        label(title, { size: 21 }),
        label("Not for diagnosis", { quiet: true, size: 14 }),
      ),
      looks,
    );
  }

  #cut(): (Container | Text)[] {
    const [viewer, actions] = [this.#viewer, this.#actions];
    const clip = this.#live(() => viewer.state.clip);
    const { grip } = this.#host.stage;
    const free = this.#live(() => !actions.isUniaxial);
    const isCut = this.#live(() => viewer.cut !== null);
    const position = this.#live(() => actions.position ?? { min: 0, max: 1, value: 0 });
    const thickness = this.#live(() => ({
      min: kLeastThickness,
      max: Math.max(kLeastThickness, position.value.max - position.value.min),
      value: viewer.cut?.thickness ?? 0,
    }));
    const orientations = Object.fromEntries(kOrientations.map((one) => [one, capital(one)]));
    const tab = (element: Container | Text, where?: () => boolean) => this.#only("cut", element, where);
    return [
      tab(
        choice<Mode>(
          { arbitrary: "Any angle", uniaxial: "One axis" },
          this.#live(() => viewer.state.mode),
          (mode) => viewer.store.setMode(mode),
        ),
      ),
      tab(
        choice<Orientation>(
          orientations as Record<Orientation, string>,
          this.#live(() => viewer.cut && orientationOf(viewer.cut)),
          (one) => actions.orient(one),
        ),
        () => !actions.isUniaxial,
      ),
      tab(label(this.#live(() => this.#readout))),
      tab(slider(position, (value) => actions.moveTo(value))),
      tab(
        row(
          button("Flip", () => actions.flip(), { enabled: computed(() => free.value && isCut.value) }),
          button("Slab", () => actions.toggleSlab(), {
            enabled: computed(() => free.value && isCut.value),
            pressed: this.#live(() => (viewer.cut?.thickness ?? null) !== null),
          }),
          button("Lock", () => this.#set(() => (grip.locked = !grip.locked)), {
            pressed: this.#live(() => grip.locked),
          }),
          button("Snap", () => this.#set(() => (grip.snap.enabled = !grip.snap.enabled)), {
            enabled: free,
            pressed: this.#live(() => grip.snap.enabled),
          }),
          button("Reset", () => actions.resetPlane()),
        ),
      ),
      tab(
        column(
          {},
          label(this.#live(() => `Slab of ${(viewer.cut?.thickness ?? 0).toFixed(1)} mm`)),
          slider(thickness, (mm) => actions.setThickness(mm)),
        ),
        () => (viewer.cut?.thickness ?? null) !== null,
      ),
      tab(
        row(
          button("Cut", () => actions.toggle(), { pressed: isCut }),
          button("Undo", () => actions.undo(), { enabled: this.#live(() => actions.canUndo) }),
          button("Redo", () => actions.redo(), { enabled: this.#live(() => actions.canRedo) }),
        ),
      ),
      tab(
        row(
          button("Add plane", () => actions.add(), { enabled: this.#live(() => actions.canAdd) }),
          button(
            this.#live(() => `${viewer.state.active + 1} of ${viewer.state.cuts.length}`),
            () => actions.activate(),
            { enabled: this.#live(() => viewer.state.cuts.length > 1) },
          ),
          button("Remove", () => actions.remove(), { enabled: isCut }),
        ),
        () => !actions.isUniaxial,
      ),
      tab(
        choice<ClipOperator>({ ...kOperators, layers: "Layers" }, clip, (one) => viewer.store.setClip(one)),
        () => viewer.hasLayers,
      ),
      tab(
        choice<keyof typeof kOperators>(
          kOperators,
          computed(() => (clip.value === "layers" ? "exact" : clip.value)),
          (one) => viewer.store.setClip(one),
        ),
        () => !viewer.hasLayers,
      ),
    ];
  }

  /** In a hand; one that is put out is held no more. */
  #holdLamp(hand: LampHand): void {
    this.#host.lamp.hand = hand === "none" ? null : hand;
    if (hand === "none") {
      this.#viewer.store.setLamp(null);
    }
  }

  #faces(): (Container | Text)[] {
    const viewer = this.#viewer;
    const tab = (element: Container | Text, where?: () => boolean) => this.#only("faces", element, where);
    const byVolume = () => this.#byVolume;
    const canChangeRig = () => byVolume() && viewer.canChangeRig === true;
    const isGrey = () => byVolume() && viewer.state.grey > 0 && viewer.window !== null;
    const change = (part: Partial<Window>) => {
      const { window } = viewer;
      viewer.store.setWindow(window && { ...window, ...part });
    };
    const curve = () => viewer.section?.curve ?? [0, 1];
    const [low, high] = [() => curve()[0]!, () => curve().at(-1)!];
    return [
      tab(
        choice<FaceSource>(
          { volume: "From the volume", splats: "By the splats" },
          this.#live(() => (byVolume() ? "volume" : "splats")),
          (source) => viewer.store.setSection(source),
          this.#live(() => !viewer.noSection),
        ),
      ),
      tab(
        label(
          this.#live(() => viewer.noSection ?? ""),
          { quiet: true, size: 15 },
        ),
        () => viewer.noSection !== null,
      ),
      tab(label("Light"), canChangeRig),
      ...kRigRows.map((names) =>
        tab(
          choice<string>(
            Object.fromEntries(names.map((name) => [name, name ? capital(name) : "As made"])),
            this.#live(() => viewer.state.rig ?? kOwnLight),
            (name) => viewer.store.setRig(name === kOwnLight ? null : name),
          ),
          canChangeRig,
        ),
      ),
      tab(
        choice<LampHand>(
          { none: "No lamp", left: "Left hand", right: "Right hand" },
          this.#live(() => (viewer.state.lamp ? this.#host.lamp.hand : "none")),
          (hand) => this.#set(() => this.#holdLamp(hand)),
        ),
        canChangeRig,
      ),
      tab(
        button("Leave the lamp where it is", () => this.#set(() => (this.#host.lamp.hand = null))),
        () => canChangeRig() && this.#host.lamp.hand !== null,
      ),
      tab(
        label(this.#live(() => `Light turned by ${Math.round(viewer.state.turn)}°`)),
        () => canChangeRig() && !viewer.state.lamp,
      ),
      tab(
        slider(
          this.#live(() => ({ min: -180, max: 180, value: viewer.state.turn })),
          (turn) => viewer.store.setTurn(Math.round(turn)),
        ),
        () => canChangeRig() && !viewer.state.lamp,
      ),
      tab(label("From cinematic to grey"), byVolume),
      tab(
        slider(
          this.#live(() => ({ min: 0, max: 1, value: viewer.state.grey })),
          (grey) => viewer.store.setGrey(grey),
        ),
        byVolume,
      ),
      tab(
        choice<GreyOpenings>(
          { cinematic: "Lit openings", neutral: "Clay", values: "Values" },
          this.#live(() => viewer.state.openings),
          (openings) => viewer.store.setOpenings(openings),
        ),
        () => isGrey() && canChangeRig(),
      ),
      tab(this.#windows, isGrey),
      tab(
        column(
          {},
          label(this.#live(() => `Centre ${Math.round(viewer.window?.center ?? 0)}`)),
          slider(
            this.#live(() => ({ min: low(), max: high(), value: viewer.window?.center ?? 0 })),
            (center) => change({ center }),
          ),
          label(this.#live(() => `Width ${Math.round(viewer.window?.width ?? 0)}`)),
          slider(
            this.#live(() => ({ min: 1, max: high() - low(), value: viewer.window?.width ?? 0 })),
            (width) => change({ width }),
          ),
        ),
        isGrey,
      ),
    ];
  }

  /** What can be marked, and what is. */
  #markTab(): (Container | Text)[] {
    const [viewer, marking] = [this.#viewer, this.#marking];
    const tab = (element: Container | Text, where?: () => boolean) => this.#only("marks", element, where);
    const tool = (kind: MarkKind) =>
      button(kMarkNames[kind], () => this.#set(() => marking.toggle(kind)), {
        pressed: computed(() => marking.kind === kind),
      });
    const hasSection = () => viewer.section !== null;
    return [
      tab(row(tool("point"), tool("length"), tool("angle")), hasSection),
      tab(
        row(
          tool("region"),
          tool("outline"),
          button("End outline", () => this.#set(() => marking.finish()), {
            enabled: computed(() => marking.kind === "outline" && marking.points.length > 2),
          }),
        ),
        hasSection,
      ),
      this.#scrolled("marks", this.#listed),
    ];
  }

  #showMarks(): void {
    const { marks } = this.#viewer.state;
    if (marks === this.#shownMarks) {
      return;
    }
    this.#shownMarks = marks;
    const texts = marks.map((mark) => markText(mark, measure(mark, this.#viewer.section)));
    this.#root.setProperties({ fontFamilies: this.#font.families(texts.join("")) });
    replaceChildren(
      this.#listed,
      marks.map((mark, i) => {
        const remove = button("Remove", () => this.#viewer.store.removeMark(mark.id));
        remove.setProperties({ flexGrow: 0, flexBasis: 90 });
        return row(
          column({ flexGrow: 1, flexShrink: 1, justifyContent: "center" }, label(texts[i]!)),
          remove,
        );
      }),
    );
  }

  #layers(): (Container | Text)[] {
    const viewer = this.#viewer;
    const tab = (element: Container | Text, where?: () => boolean) => this.#only("layers", element, where);
    const layer = (text: string, name: keyof Layers, enabled: () => boolean) =>
      button(text, () => viewer.store.setLayers({ [name]: !viewer.state.layers[name] }), {
        enabled: this.#live(enabled),
        pressed: this.#live(() => viewer.state.layers[name]),
      });
    return [
      tab(
        row(
          layer("Body", "body", () => this.#byVolume && viewer.state.layers.faces),
          layer("Cut faces", "faces", () => this.#byVolume),
        ),
      ),
      tab(
        row(
          button("Handle", () => viewer.store.setHandle(!viewer.state.handle), {
            pressed: this.#live(() => viewer.state.handle),
          }),
          layer("Marks", "marks", () => true),
          button("Letters", () => this.#set(() => (this.#lettered = !this.#lettered)), {
            pressed: this.#live(() => this.#lettered),
          }),
        ),
      ),
      tab(label("Depth: what is far away fades")),
      tab(
        slider(
          this.#live(() => ({ min: 0, max: 1, value: viewer.state.depthCue })),
          (strength) => viewer.store.setDepthCue(strength),
        ),
      ),
      tab(label("Without the body, the cut faces stand in the room alone.", { quiet: true, size: 15 })),
    ];
  }

  #scrolled(tab: Tab, content: Container): Container | Text {
    const list = new Container({ maxHeight: 420, overflow: "scroll", flexDirection: "column" });
    return this.#only(tab, list.add(content));
  }

  #view(): (Container | Text)[] {
    const tab = (element: Container | Text) => this.#only("view", element);
    const { stats } = this.#viewer;
    const { governor } = this.#host;
    return [
      tab(label(this.#live(() => `The case at ${scaleText(this.#host.stage.scale)}`))),
      tab(
        slider(
          this.#live(() => ({
            min: Math.log(kLeastScale),
            max: Math.log(kMostScale),
            value: Math.log(this.#host.stage.scale),
          })),
          (value) => this.#set(() => (this.#host.stage.scale = Math.exp(value))),
        ),
      ),
      tab(
        row(
          button("Life size", () => this.#set(() => (this.#host.stage.scale = 1)), {
            pressed: this.#live(() => this.#host.stage.scale === 1),
          }),
          button("Before me", () => this.#host.place()),
        ),
      ),
      tab(
        row(
          button(
            this.#live(() => (this.#atRight ? "Panel to the left" : "Panel to the right")),
            () => this.#set(() => this.#changeSide()),
          ),
          button("Steady", () => this.#set(() => (governor.enabled = !governor.enabled)), {
            pressed: this.#live(() => governor.enabled),
          }),
          button("Take off", () => this.#host.leave()),
        ),
      ),
      tab(
        label(
          this.#live(
            () =>
              `${formatCount(stats.drawn)} of ${formatCount(stats.total)} splats, ${effortText(governor.effort)}`,
          ),
          { quiet: true, size: 15 },
        ),
      ),
    ];
  }

  /** Whether cut faces are drawn from the volume, where they are shown. */
  get #byVolume(): boolean {
    return !this.#viewer.noSection && this.#viewer.state.section === "volume";
  }

  get #readout(): string {
    const { cut, planeState } = this.#viewer.store;
    const { positionText } = this.#actions;
    return cut
      ? planeState === null
        ? `${planeText(cut)} · ${positionText}`
        : positionText
      : "Nothing is cut";
  }

  /** Changes what the viewer does not tell of. */
  #set(change: () => void): void {
    change();
    this.refresh();
  }

  #changeSide(): void {
    this.#atRight = !this.#atRight;
    this.#host.place();
  }

  #showWindows(): void {
    const { windows } = this.#viewer;
    if (windows !== this.#shownWindows) {
      this.#shownWindows = windows;
      replaceChildren(
        this.#windows,
        [...windows].map(([name, one]) =>
          button(name, () => this.#viewer.store.setWindow(one), {
            pressed: this.#live(() => isSameWindow(one, this.#viewer.window)),
          }),
        ),
      );
    }
  }

  async #listCases(): Promise<void> {
    try {
      const groups = groupCases(await this.#host.cases());
      const pictures = await this.#prepare(groups.flatMap(({ looks }) => looks));
      replaceChildren(
        this.#cards,
        groups.flatMap((group) => this.#group(group, pictures)),
      );
      this.#message.value = "";
    } catch (error) {
      this.#message.value = (error as Error).message;
    }
  }

  async #listLooks(): Promise<void> {
    const looks = this.#host.looks();
    const pictures = await this.#prepare(looks);
    replaceChildren(this.#looks, [
      label("Of one volume: place, cut, window and marks stay.", { quiet: true, size: 15 }),
      ...pairs(looks.map((look) => this.#card(look, pictures, look.case.look?.description))),
    ]);
  }

  /** Has the letters of their texts drawn; resolves with the pictures of those that have one. */
  async #prepare(looks: readonly Look[]): Promise<Pictures> {
    const texts = looks.map(({ case: { name, title, look, error } }) =>
      [name, title, look?.title, look?.description, error].join(""),
    );
    this.#root.setProperties({ fontFamilies: this.#font.families(texts.join("")) });
    const pictures = looks.map(
      async ({ case: one }) => [one, one.thumbnail ? await this.#picture(one.thumbnail) : null] as const,
    );
    return new Map(await Promise.all(pictures));
  }

  /** uikit wants it whole; a case without one goes without. An address is of one picture for ever. */
  #picture(url: string): Promise<Texture | null> {
    const known = this.#pictures.get(url);
    const picture =
      known ??
      this.#textures.loadAsync(url).then(
        (texture) => {
          texture.colorSpace = SRGBColorSpace;
          return texture;
        },
        () => {
          this.#pictures.delete(url);
          return null;
        },
      );
    this.#pictures.set(url, picture);
    return picture;
  }

  /** The cards of a volume's cases, two in a row where they are several. */
  #group(group: CaseGroup, pictures: Pictures): (Container | Text)[] {
    const cards = group.looks.map((look) => this.#card(look, pictures));
    if (cards.length === 1) {
      return cards;
    }
    return [label(`${group.title} · ${countText(group)}`, { quiet: true, size: 15 }), ...pairs(cards)];
  }

  #card({ case: one, name }: Look, pictures: Pictures, detail?: string): Container {
    return button(one.error ? one.name : name, () => void this.#open(one.name), {
      picture: pictures.get(one) ?? undefined,
      pressed: this.#live(() => this.#viewer.caseName === one.name),
      detail,
    });
  }

  async #open(name: string): Promise<void> {
    this.#message.value = "";
    try {
      await this.#host.open(name);
    } catch (error) {
      this.tell(failureText(name, error));
    }
    this.refresh();
  }
}

/** Two in a row. */
function pairs(cards: readonly Container[]): Container[] {
  return cards.flatMap((card, i) => (i % 2 === 0 ? [row(card, cards[i + 1] ?? space())] : []));
}

function help(): Container {
  return column(
    { gap: 7 },
    ...kHelp.map(([what, does]) =>
      column({ gap: 1 }, label(what, { size: 15 }), label(does, { quiet: true, size: 15 })),
    ),
  );
}

/** What is given up for frames in time. */
function effortText({ scale, extent, leastPixels, walls, detail }: Effort): string {
  const parts = [
    ...(scale < 1 ? [`${Math.round(100 * scale)} % resolution`] : []),
    ...(extent < Infinity ? [`to ${extent.toFixed(1)} σ`] : []),
    ...(leastPixels > 0 ? [`from ${leastPixels} px`] : []),
    ...(walls !== "fine" ? [`${walls} walls`] : []),
    ...(detail === "outline" ? ["no surface"] : detail === "splats" ? ["splats alone"] : []),
  ];
  return parts.length > 0 ? parts.join(", ") : "in full";
}

function scaleText(scale: number): string {
  return scale === 1 ? "life size" : `${scale < 1 ? scale.toFixed(2) : scale.toFixed(1)} × life size`;
}
