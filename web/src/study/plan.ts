import { Vector3 } from "three";

import type { Mode } from "../api";
import { type Plane, planeThrough, projectOnto, signedDistance } from "../model/geometry";
import { kModes } from "../model/states";
import { type JsonFile, JsonReader } from "../sog/json_reader";
import { CaseError, crc32 } from "../sog/zip";
import { kLanguages, type Language } from "../text/text";
import { kQuestionnaires, type Questionnaire } from "./questionnaires";

const kMostTasks = 50;
const kMostPins = 50;
const kMostSeconds = 3600;
const kMostTexts = 20;

/** What a plane is to be brought to, RAS mm: through points, to a plane, or both. */
export interface Target {
  points: readonly Vector3[];
  plane: Plane | null;
}

export interface Task {
  name: string;
  text: string;
  target: Target;
  /** Whether the target's points are marked. */
  marked: boolean;
  /** How it is looked at when it begins; absent: as cases are. */
  view?: { azimuth: number; elevation: number; zoom: number };
}

export interface PlannedMode {
  mode: Mode;
  title: string;
  text: string;
}

/** What a study does with each participant. */
export interface Plan {
  name: string;
  title: string;
  /** Of its text: a session goes on with the same one alone. */
  digest: string;
  case: string;
  /** Of its texts: what is said besides them is said in it, too. */
  language: Language;
  welcome: readonly string[];
  modes: readonly PlannedMode[];
  /** Whether every other participant begins with the other mode. */
  counterbalanced: boolean;
  practice: readonly Task[];
  tasks: readonly Task[];
  /** Whether tasks begin with another one for each pair of participants, and in the second mode. */
  rotated: boolean;
  /** What a task may take, s; null: any time. */
  limit: number | null;
  /** Of a rest between modes, s; 0: none. */
  pause: number;
  questionnaires: readonly Questionnaire[];
  /** Whether a comment is asked for at the end, at the desk. */
  comment: boolean;
}

/** Reads a plan (docs/study.md). Throws CaseError, in a line that says what is wrong where. */
export function parsePlan(text: string, name: string): Plan {
  const file: JsonFile = { name, remedy: "see docs/study.md" };
  let json: unknown;
  try {
    json = JSON.parse(text);
  } catch (error) {
    throw new CaseError(`${name}: is no JSON (${(error as Error).message}); see docs/study.md`);
  }
  const reader = new JsonReader(json, "plan", file);
  reader.integer("format", 1, 1);
  const pins = readPins(reader, file);
  const tasks = (key: string) => reader.children(key, kMostTasks).map((one) => readTask(one, pins, name));
  const plan: Plan = {
    name: readName(reader, "name"),
    title: reader.text("title"),
    digest: crc32(new TextEncoder().encode(text)).toString(16).padStart(8, "0"),
    case: reader.text("case"),
    language: reader.has("language") ? oneOf(reader, "language", kLanguages) : "en",
    welcome: reader.has("welcome") ? readTexts(reader, "welcome") : [],
    modes: reader.children("modes", kModes.length).map((one) => ({
      mode: oneOf(one, "mode", kModes),
      title: one.text("title"),
      text: one.text("text"),
    })),
    counterbalanced: !reader.has("order") || oneOf(reader, "order", ["counterbalanced", "fixed"]) !== "fixed",
    practice: reader.has("practice") ? tasks("practice") : [],
    tasks: tasks("tasks"),
    rotated: !reader.has("task_order") || oneOf(reader, "task_order", ["rotated", "fixed"]) !== "fixed",
    limit: reader.has("limit_s") ? reader.number("limit_s", 1, kMostSeconds) : null,
    pause: reader.has("pause_s") ? reader.number("pause_s", 0, kMostSeconds) : 0,
    questionnaires: readQuestionnaires(reader),
    comment: reader.has("comment") && reader.value("comment") === true,
  };
  if (plan.modes.length === 0 || new Set(plan.modes.map(({ mode }) => mode)).size < plan.modes.length) {
    reader.fail("modes");
  }
  const all = [...plan.practice, ...plan.tasks];
  if (plan.tasks.length === 0 || new Set(all.map((task) => task.name)).size < all.length) {
    throw new CaseError(`${name}: plan.tasks is empty or has a name twice; see docs/study.md`);
  }
  return plan;
}

/** How far a plane is from a target: of its normal, degrees, and of its points, rms mm; null where it does not say. */
export function errorFrom(
  { points, plane: wanted }: Target,
  plane: Plane,
  center: Vector3,
): { angle: number | null; distance: number } {
  const at = points.length > 0 ? points : [projectOnto(wanted!, center)];
  const squares = at.map((point) => signedDistance(plane, point) ** 2);
  const cosine = wanted && Math.min(1, Math.abs(wanted.normal.dot(plane.normal)));
  return {
    angle: cosine === null ? null : (180 / Math.PI) * Math.acos(cosine),
    distance: Math.sqrt(squares.reduce((sum, one) => sum + one, 0) / at.length),
  };
}

function oneOf<T extends string>(reader: JsonReader, key: string, texts: readonly T[]): T {
  const text = reader.text(key);
  return texts.find((one) => one === text) ?? reader.fail(key);
}

/** As records have them (src/study/records.h). */
function readName(reader: JsonReader, key: string): string {
  const text = reader.text(key);
  return /^[\w-]{1,64}$/.test(text) ? text : reader.fail(key);
}

function readTexts(reader: JsonReader, key: string): string[] {
  const list = reader.value(key);
  const fits =
    Array.isArray(list) && list.length <= kMostTexts && list.every((one) => typeof one === "string");
  return fits ? list : reader.fail(key);
}

function readQuestionnaires(reader: JsonReader): Questionnaire[] {
  const names = reader.has("questionnaires") ? readTexts(reader, "questionnaires") : ["sus", "efficiency"];
  const known = names.flatMap((name) => kQuestionnaires.find((one) => one === name) ?? []);
  return known.length === names.length && new Set(known).size === names.length
    ? known
    : reader.fail("questionnaires");
}

function readPins(reader: JsonReader, file: JsonFile): Map<string, Vector3> {
  if (!reader.has("pins")) {
    return new Map();
  }
  const names = Object.keys(reader.value("pins") as object);
  const pins = new JsonReader(reader.value("pins"), "plan.pins", file);
  return names.length <= kMostPins
    ? new Map(names.map((name) => [name, new Vector3(...pins.vector(name))]))
    : reader.fail("pins");
}

function readTask(reader: JsonReader, pins: ReadonlyMap<string, Vector3>, file: string): Task {
  const name = readName(reader, "name");
  const pinOf = (pin: string) => {
    const point = pins.get(pin);
    if (!point) {
      throw new CaseError(
        `${file}: the target of "${name}" is the pin "${pin}", which the plan does not have`,
      );
    }
    return point;
  };
  const task: Task = {
    name,
    text: reader.text("text"),
    target: readTarget(reader.child("target"), pinOf),
    marked: !reader.has("marked") || reader.value("marked") === true,
  };
  if (reader.has("view")) {
    const [azimuth, elevation, zoom] = reader.numbers("view", 3, -360, 360) as [number, number, number];
    task.view = { azimuth, elevation, zoom: zoom > 0 ? zoom : reader.fail("view") };
  }
  return task;
}

function readTarget(reader: JsonReader, pinOf: (name: string) => Vector3): Target {
  if (reader.has("plane")) {
    const [x, y, z, offset] = reader.numbers("plane", 4) as [number, number, number, number];
    const length = Math.hypot(x, y, z);
    const normal = length > 0 ? new Vector3(x, y, z).divideScalar(length) : reader.fail("plane");
    return { points: [], plane: { normal, offset: offset / length } };
  }
  if (reader.has("through")) {
    const points = readTexts(reader, "through").map(pinOf);
    const [a, b, c] = points;
    const normal =
      points.length === 3 ? b!.clone().sub(a!).cross(c!.clone().sub(a!)) : reader.fail("through");
    return normal.length() > 1e-3 ? { points, plane: planeThrough(normal, a!) } : reader.fail("through");
  }
  return { points: [pinOf(reader.text("pin"))], plane: null };
}
