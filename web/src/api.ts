import type { GreyOpenings } from "./model/face_style";
import type { Layers } from "./model/layers";
import type { Effort } from "./xr/governor";

export type { Layers };

// What scripts see of the viewer, and nothing that belongs to its libraries: packages hold these types as they are.

/** R, A, S. */
export type Triple = [number, number, number];
/** How splats are cut: by their centres, faded, exactly, or by the layers that they were trained in. */
export type ClipOperator = "hard" | "soft" | "exact" | "layers";
/** What cut faces are drawn from. */
export type FaceSource = "volume" | "splats";
/** How the plane moves: along the case's axis from state to state, or freely. */
export type Mode = "uniaxial" | "arbitrary";
/** Before the eyes a dark room, or the room where one is. */
export type Surroundings = "immersive-vr" | "immersive-ar";

/** Values from center − width/2 (black) to center + width/2 (white). */
export interface GreyWindow {
  /** In the volume's values: HU of a CT. */
  center: number;
  width: number;
}

/** Of the uniaxial mode: state k's plane is dot(axis, x) = first + k · spacing and keeps one side of it. */
export interface ApiStates {
  /** Unit vector, RAS. */
  axis: Triple;
  count: number;
  /** mm. */
  first: number;
  /** mm. */
  spacing: number;
  keeps: "below" | "above";
}

/** 8-bit RGBA, display sRGB, straight alpha, row by row from the top left. */
export interface Picture {
  /** px. */
  width: number;
  /** px. */
  height: number;
  data: Uint8ClampedArray;
}

/** What an eye saw, and from where: as a frame of a dataset's transforms.json says it, RAS mm. */
export interface EyePicture {
  picture: Picture;
  /** Of the picture: its size, focal lengths and principal point, px, and where it stood. */
  camera: {
    w: number;
    h: number;
    fl_x: number;
    fl_y: number;
    cx: number;
    cy: number;
    transform_matrix: number[][];
  };
}

/** What the last frames cost. */
export interface ViewerStats {
  /** Between frames while something moves. */
  frameMs: number;
  /** Culling and sorting, in the worker. */
  sortMs: number;
  /** Splats that are drawn. */
  drawn: number;
  /** All splats of the case. */
  total: number;
  /** Resolution of the picture shown, 1: full. */
  scale: number;
  /** The picture shown is that of the state, as good as it gets. */
  settled: boolean;
  /** On the GPU, of the volume that faces are drawn from; 0: none. */
  sectionBytes: number;
  /** Decoding what was left of it when the body was seen. */
  sectionMs: number;
}

/** Keeps dot(normal, x) >= offset, and of a slab no more than `thickness` mm beyond it. */
export interface ApiCut {
  /** Towards what is kept, RAS; need not be of unit length. */
  normal: Triple;
  /** mm, where the normal is of unit length. */
  offset: number;
  /** mm; absent: a plane, not a slab. */
  thickness?: number;
}

/** What a mark is of. */
export type MarkKind = "point" | "length" | "angle" | "region" | "outline";

/** A point; both ends; an end, the vertex, the other end; the centre and a point of the rim; the corners. RAS mm. */
export interface ApiMark {
  kind: MarkKind;
  points: Triple[];
  /** Of the face that a region or an outline lies in. */
  normal?: Triple;
  name?: string;
  note?: string;
}

/** What a mark measures: of its kind, as far as the case has values; `text` as the page shows it. */
export interface ApiMeasure {
  text: string;
  /** At a point. */
  value: number | null;
  /** Rms, of that value. */
  error: number | null;
  /** Of a length. */
  mm: number | null;
  /** Of an angle. */
  degrees: number | null;
  /** Of a region or an outline, mm². */
  area: number | null;
  /** Of the values within it. */
  mean: number | null;
  /** Their standard deviation. */
  deviation: number | null;
}

/** A view that was saved. */
export interface ApiView {
  name: string;
  text: string;
  /** What is shown, in the words of the viewer's address. */
  link: string;
  /** Of the flight there, s. */
  fly: number;
  /** Of the stay, s. */
  stay: number;
}

/** The viewer for scripts: `window.clipgs` of its own page, `clipgs` of an element. Patient space (RAS mm) throughout. */
export interface ClipgsApi {
  /** Resolves when the case that the address or the element names has been drawn; rejects with a line for a person. */
  readonly ready: Promise<void>;
  /** Shows another case: of the server by its name, in an element by its address. */
  open(name: string): Promise<void>;
  /** Shows a file of the person's own, which is sent nowhere: a case, or splats of other programs (.ply, .spz). */
  openFile(file: File): Promise<void>;
  /** Where the camera stands, degrees: azimuth 0 looks from the front, 90 from the patient's left; elevation 90 from above; zoom is kept from 0.25 to 24. */
  setView(view: { azimuth: number; elevation: number; zoom?: number }): void;
  /** Cuts with one plane that keeps dot(normal, x) >= offset; null: nothing is cut. */
  setPlane(plane: { normal: Triple; offset: number } | null): void;
  /** What all cuts keep is shown; `active` is the one that the page moves. False, and nothing changes, for more than
   * six planes, of which a slab has two. */
  setCuts(cuts: readonly ApiCut[], active?: number): boolean;
  /** How the plane moves. In the uniaxial mode one plane is left, at the state nearest to it, and so is every plane
   * that is set then. */
  setMode(mode: Mode): void;
  /** Shows a state, from 0, in the uniaxial mode; false, and nothing changes, where the case has no such state. */
  setState(state: number): boolean;
  /** Of the uniaxial mode of the case; null: none is open. */
  readonly states: ApiStates | null;
  /** `layers`: of a case with layers, cut along its axis; anything else is cut exactly then. */
  setClip(clip: ClipOperator): void;
  /** What cut faces are drawn from; a case without a section volume draws them by its splats. */
  setSection(section: FaceSource): void;
  /** How faces drawn from the volume look: 0 cinematic … 1 grey values through the window. */
  setGrey(grey: number): void;
  /**
   * What grey shows in gaps of a face that the window has black: the walls behind them, cinematic or of a clay that no
   * value looks like, or the gaps' values.
   */
  setOpenings(openings: GreyOpenings): void;
  /**
   * Lights the case by one of "ambient", "dome", "rim", "studio" and "theatre"; null: by the lights that it was made in.
   * Returns whether there is such a rig; cases without a section, and of translucent matter, stay as they are.
   */
  setRig(rig: string | null): boolean;
  /** Turns the lights by degrees about the patient's long axis, counterclockwise seen from the head. */
  setTurn(degrees: number): void;
  /** A lamp instead of the rig's: where it shines from (RAS); null: none. */
  setLamp(from: Triple | null): void;
  /** What lies behind the case: "black", "white", "studio" or "paper"; null: as the page is. Returns whether there is
   * such a one. */
  setBackground(background: string | null): boolean;
  /** How much what is far away fades towards that, from 0 (not at all) to 1 (wholly at the far end). */
  setDepthCue(strength: number): void;
  /** Values from center − width/2 (black) to center + width/2 (white); null: the case's own. */
  setWindow(window: GreyWindow | null): void;
  /** What of the case is shown. The body is left out only where faces of a cut are drawn from the volume. */
  setLayers(layers: Partial<Layers>): void;
  /**
   * Marks points: as many as the kind wants, in the order in which a person would press them. A region or an outline lies
   * in the face with that normal. Returns the mark's id; null where there is no value (outside and in air), where that is
   * marked already, and beyond 500 marks.
   */
  addMark(mark: ApiMark): string | null;
  /** Removes a mark, where it is there. */
  removeMark(id: string): void;
  /** Names a mark, or notes something about it. */
  describeMark(id: string, words: { name?: string; note?: string }): void;
  /** What is marked, the oldest first, with what it measures. */
  readonly marks: (Required<Omit<ApiMark, "normal">> & { id: string; normal: Triple | null } & ApiMeasure)[];
  /** The views that are saved of the volume: the stops of its tour. */
  readonly views: ApiView[];
  /** Saves what is shown as a view; false, and nothing changes, where there are 100. */
  saveView(name?: string, text?: string): boolean;
  /** Flies to a view, by its place from 0, and stays there. Resolves when it is on its way. */
  showView(index: number): Promise<void>;
  /** Flies from view to view, from the one that is shown or else the first. Resolves when it is on its way. */
  playTour(): Promise<void>;
  /** Ends that where it is. */
  stopTour(): void;
  /** The view that is flown to or shown, from 0 (null: none), whether others follow, and why one is not shown. */
  readonly tour: { index: number | null; playing: boolean; trouble: string };
  /** Of the case, RAS mm. */
  readonly bounds: { min: Triple; max: Triple } | null;
  /** What is shown. */
  readonly state: {
    case: string | null;
    view: { azimuth: number; elevation: number; zoom: number };
    /** The active one of `cuts`. */
    plane: { normal: Triple; offset: number } | null;
    cuts: ApiCut[];
    mode: Mode;
    /** Null in the arbitrary mode and where nothing is cut. */
    state: number | null;
    clip: ClipOperator;
    section: FaceSource;
    grey: number;
    openings: GreyOpenings;
    rig: string | null;
    turn: number;
    lamp: Triple | null;
    background: string | null;
    depthCue: number;
    window: GreyWindow | null;
    layers: Layers;
  };
  /** What the last frames cost, and whether the picture is as good as it gets. */
  readonly stats: Readonly<ViewerStats>;
  /** Whether resolution is given up where frames would come late, while something moves. */
  steady: boolean;
  /** The picture alone, as `clipgs render` writes it; `moving`: as it is drawn while something moves. */
  renderToPixels(width: number, height: number, moving?: boolean): Promise<Picture>;
  /**
   * A PNG of what is shown, without the handle, of that size: transparent or over what lies behind the case, with the labels
   * that saved pictures have or without.
   */
  picture(wanted: { width: number; height: number; transparent?: boolean; labels?: boolean }): Promise<Blob>;
  /** The case in a headset. Entering rejects with a line for a person, and needs a click of the user's. */
  readonly headset: {
    /** Whether it draws in place of the page. */
    readonly worn: boolean;
    enter(surroundings?: Surroundings): Promise<void>;
    leave(): Promise<void>;
    /** Of the case, 1: life size. */
    readonly scale: number;
    /** What the eyes see of the case in the next frame. */
    capture(): Promise<EyePicture[]>;
    /** Whether less is drawn where frames would come late. */
    steady: boolean;
    /** What is drawn of the case now: all is {scale: 1, extent: Infinity, leastPixels: 0}. */
    readonly effort: Effort;
    /** What its panel says of a case that could not be opened, or nothing. */
    readonly message: string;
    /** Where a text of its panel is in the room, m; null: it is not shown. */
    find(text: string): Triple | null;
  };
  /** Where a point appears on the page, CSS px; null behind the camera. */
  project(point: Triple): { x: number; y: number } | null;
}
