import { HandleStore } from "@pmndrs/handle";
import { Container, reversePainterSortStable } from "@pmndrs/uikit";
import { computed, signal } from "@preact/signals-core";
import { Group, Sphere, Vector3, type WebGLRenderer } from "three";

import type { Actions } from "../../actions";
import { inShort } from "../../model/case_title";
import { Follower } from "../../model/follower";
import type { Marking } from "../../model/marking";
import { kBesideCase } from "../../render/draw_order";
import { texts } from "../../text/text";
import type { Viewer } from "../../viewer";
import { handedness } from "../preferences";
import { CasesTab } from "./cases_tab";
import { cutTab } from "./cut_tab";
import { faceTab } from "./face_tab";
import { FirstHints } from "./first_hints";
import { helpTab } from "./help_tab";
import { layersTab } from "./layers_tab";
import type { Board } from "./board";
import { LoadingBoard } from "./loading_board";
import { LooksTab } from "./looks_tab";
import { marksTab } from "./marks_tab";
import { OrientationCube } from "./orientation_cube";
import { OrientationLetters } from "./orientation_letters";
import { type PalmAction, PalmMenu } from "./palm_menu";
import type { PanelContext, PanelHost } from "./panel_context";
import { RoomMarks } from "./room_marks";
import { SdfFont } from "./sdf_font";
import { StudyBoard } from "./study_board";
import { tourTab } from "./tour_tab";
import { TroubleBoard } from "./trouble_board";
import { viewTab } from "./view_tab";
import { button, choice, column, findText, kSmallFont, label, row, when } from "./widgets";

/** m a px: a button is as high as a finger is thick, and more. */
const kPixel = 0.00064;
const kWidth = 480; // px
/**
 * Where it is put: this far from the eyes, where a finger reaches it, aside of where they look, no farther than one looks
 * without turning one's head, and below; m and radians.
 */
const kAway = 0.58;
const kAside = 0.41;
const kBelow = 0.12;
/** How near and how far it can be moved, m. */
const kNearest = 0.35;
const kFarthest = 2;
/** Of its top above its middle, m. */
const kTop = 0.16;
/** Of the cube from its middle, m: above its right end. */
const kCube = new Vector3(0.125, kTop + 0.04, 0);
/** It follows the state so often while something moves, ms. */
const kRefreshMs = 100;
/** What is drawn is counted so often, ms. */
const kCountMs = 500;
/** What is met first, where a hand points at several things. */
const kOrder = 2;

/** Looks have no tab where all are, but a button that is there where the volume has several. */
type Tab = keyof ReturnType<typeof texts>["headset"]["tabs"] | "looks";
/** More do not stand in a row. */
const kTabRows: readonly (readonly Exclude<Tab, "looks">[])[] = [
  ["cut", "faces", "marks", "layers"],
  ["cases", "tour", "view", "help"],
];

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
  readonly #marks: RoomMarks;
  readonly #letters: OrientationLetters;
  readonly #cube: OrientationCube;
  readonly #lettering = { shown: true };
  readonly #host: PanelHost;
  readonly #font = new SdfFont();
  readonly #root: Container;
  readonly #studying = signal(false);
  #study: StudyBoard | null = null;
  readonly #tab = signal<Tab>("cut");
  readonly #follower = new Follower();
  readonly #cases: CasesTab;
  readonly #looks: LooksTab;
  readonly #palmMenus: readonly PalmMenu[];
  readonly #loadingBoard: LoadingBoard;
  readonly #trouble: TroubleBoard;
  readonly #boards: readonly Board[];
  readonly #hints: FirstHints;
  readonly #move: HandleStore<unknown>;
  readonly #release: () => void;
  #stale = false;
  #refreshed = 0;
  #time = 0;
  readonly #eye = new Vector3();
  /** What hands meet of it, and where that is in the room. */
  readonly crowd = { parts: new Group(), sphere: new Sphere() };
  readonly #cubePlace = new Vector3(); // scratch
  readonly #top = new Vector3();

  constructor(viewer: Viewer, actions: Actions, marking: Marking, host: PanelHost) {
    this.#viewer = viewer;
    this.#actions = actions;
    this.#host = host;
    this.#marks = new RoomMarks(viewer, (text) => this.#font.families(text));
    this.#letters = new OrientationLetters(this.#font.families());
    this.#cube = new OrientationCube((side) => host.turnTo(side), kOrder);
    const context: PanelContext = {
      viewer,
      actions,
      marking,
      host,
      live: this.#follower.live,
      set: (change) => {
        change();
        this.refresh();
      },
      spell: (said) => this.#root.setProperties({ fontFamilies: this.#font.families(said.join("")) }),
    };
    const bar = new Container({
      height: 32,
      borderRadius: 10,
      alignItems: "center",
      justifyContent: "center",
      hover: { backgroundColor: "#2a2f38" },
    }).add(new Container({ width: 120, height: 6, borderRadius: 3, backgroundColor: "#5a6270" }));
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
        renderOrder: kBesideCase,
        "*": { pointerEventsOrder: kOrder, borderColor: "#7fd8f2", renderOrder: kBesideCase },
      },
      bar,
      this.#header(),
    );
    this.#cases = new CasesTab(context);
    this.#looks = new LooksTab(context);
    this.#root.add(this.#tabs(context));
    // Lifted by what holds it: uikit clips pictures as if the root itself were not moved.
    this.crowd.parts.position.y = kTop;
    this.object.add(this.#board.add(this.crowd.parts.add(this.#root)));
    this.object.add(this.#marks.object, this.#letters.object, this.#cube.object);
    // Nobody presses these; what marks a point is the stage's.
    this.#marks.object.intersectChildren = this.#letters.object.intersectChildren = false;
    this.#palmMenus = host.hands.map(
      (hand) => new PalmMenu(hand, this.#font.families(), this.#palmActions()),
    );
    this.#loadingBoard = new LoadingBoard(host.loading, (text) => this.#font.families(text));
    this.#trouble = new TroubleBoard(host.message, (text) => this.#font.families(text));
    this.#hints = new FirstHints(host.stage, this.#font.families());
    this.#boards = [this.#trouble, this.#loadingBoard, ...this.#palmMenus].map(({ board }) => board);
    this.object.add(...this.#boards.map(({ object }) => object), this.#hints.object);
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

  /** Where this text is, of a mark, its own, or a letter, or the cube's side of this name, in the room; null: it is
   * not shown, or on a button that cannot be pressed. */
  find(text: string): Vector3 | null {
    return (
      this.#marks.find(text) ??
      (this.#board.visible ? findText(this.#root, text) : null) ??
      this.#boards.map(({ content }) => content && findText(content, text)).find((at) => at) ??
      (this.#hints.text === text ? this.#hints.object.position.clone() : null) ??
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
      void this.#cases.list();
    } else if (tab === "looks") {
      void this.#looks.list();
    }
  }

  /** Puts it beside what eyes at `eye` look at along `forward`, at the side of the hand that does less. */
  place(eye: Vector3, forward: Vector3): void {
    this.#setShown(true);
    const direction = new Vector3(forward.x, 0, forward.z).normalize();
    direction.applyAxisAngle(new Vector3(0, 1, 0), handedness.value === "left" ? -kAside : kAside);
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
      this.#updateStudy();
      this.#follower.refresh();
    }
    this.#move.update(time);
    const delta = Math.min(100, time - this.#time);
    this.#time = time;
    this.#root.update(delta);
    this.#palmMenus.forEach((menu) => menu.update(eye, delta));
    const { stage } = this.#host;
    const bounds = this.#viewer.info?.bounds;
    this.#letters.object.visible = this.#lettering.shown && bounds !== undefined;
    if (this.#lettering.shown && bounds) {
      this.#letters.update(bounds, stage.roomFromPatient, eye, delta);
    }
    this.#loadingBoard.update(stage.position, eye, delta);
    this.#trouble.update(stage.position, eye, delta);
    this.#hints.update(bounds && !this.#studying.value ? stage.top(bounds, this.#top) : null, eye, delta);
    const { reading, roomFromPatient } = stage;
    this.#marks.update(reading, roomFromPatient, eye, stage.toPatient(eye), delta);
    this.#cube.place(this.#inRoom(this.#cubePlace.copy(kCube)), stage.quaternion);
    this.#updateCrowd();
  }

  dispose(): void {
    this.#release();
    this.#root.dispose();
    this.#cases.dispose();
    this.#looks.dispose();
    this.#marks.dispose();
    this.#letters.dispose();
    this.#cube.dispose();
    this.#palmMenus.forEach(({ board }) => board.dispose());
    this.#loadingBoard.dispose();
    this.#trouble.board.dispose();
    this.#hints.dispose();
  }

  /** Of a point of the board. */
  #inRoom(point: Vector3): Vector3 {
    return point.applyQuaternion(this.#board.quaternion).add(this.#board.position);
  }

  /** What a palm offers: what is wanted without looking for it. */
  #palmActions(): PalmAction[] {
    const t = texts().headset;
    return [
      [t.panel, () => this.#host.summon()],
      [t.hide, () => this.#setShown(false)],
      [t.flip, () => this.#actions.flip()],
      [t.beforeMe, () => this.#host.place()],
    ];
  }

  /** One that is hidden is met by no hand. */
  #setShown(shown: boolean): void {
    this.#board.visible = this.#board.intersectChildren = shown;
    this.#cube.object.visible = shown;
    this.#cube.object.pointerEvents = shown ? "auto" : "none";
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

  /** All of it but its head and a study's. */
  #tabs(context: PanelContext): Container {
    const names: Readonly<Record<string, string>> = texts().headset.tabs;
    const contents: Record<Tab, Container> = {
      cut: cutTab(context),
      faces: faceTab(context),
      marks: marksTab(context),
      layers: layersTab(context, this.#lettering),
      cases: this.#cases.element,
      looks: this.#looks.element,
      view: viewTab(context),
      tour: tourTab(context),
      help: helpTab(),
    };
    return when(
      computed(() => !this.#studying.value),
      column(
        { gap: 10 },
        ...kTabRows.map((tabs) =>
          choice<Tab>(
            Object.fromEntries(tabs.map((tab) => [tab, names[tab]!])) as Record<Tab, string>,
            this.#tab,
            (tab) => this.show(tab),
          ),
        ),
        ...(Object.entries(contents) as [Tab, Container][]).map(([tab, content]) =>
          when(
            computed(() => this.#tab.value === tab),
            content,
          ),
        ),
      ),
    );
  }

  #header(): Container {
    const { live } = this.#follower;
    const title = live(() => {
      const name = this.#viewer.info?.title || this.#viewer.caseName || texts().page.noCase;
      return [inShort(name), this.#host.news()].filter(Boolean).join(" · ");
    });
    const looks = button(texts().headset.looks, () => this.show("looks"), {
      pressed: computed(() => this.#tab.value === "looks"),
    });
    looks.setProperties({ flexGrow: 0, flexBasis: 90 });
    const several = live(() => this.#host.looks().length > 0);
    return row(
      column(
        { gap: 2, flexGrow: 1, flexShrink: 1 },
        label(title, { size: 21 }),
        label(texts().notForDiagnosis, { quiet: true, size: kSmallFont }),
      ),
      when(
        computed(() => several.value && !this.#studying.value),
        looks,
      ),
    );
  }
}
