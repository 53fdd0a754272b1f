import { Matrix4, Vector3 } from "three";

import { JsonReader } from "../sog/json_reader";
import { CaseError } from "../sog/zip";
import { shownTitle } from "./case_title";
import { type FaceGain, readFaceGain } from "./face_gain";
import type { Box, Sphere } from "./geometry";
import { defaultStates, type PlaneStates, readStates } from "./states";

/** What the `clipgs` block of a case says (docs/format.md), checked. */
export interface CaseInfo {
  /** Scene space → RAS mm: a rotation, a uniform scale and a translation. */
  sceneToPatient: Matrix4;
  mmPerUnit: number;
  states: PlaneStates;
  faceGain: FaceGain;
  /** Splats lie where the section has surfaces, and are not trained: where those are drawn they add nothing. */
  placed: boolean;
  sphere: Sphere;
  bounds: Box;
  title: string;
  preset: string;
  /** Of the volume that the case was made of; empty where that is not known. */
  volume: string;
}

/** Whether both show one volume: what is said of the one in RAS mm holds for the other. */
export function isSameVolume(a: CaseInfo | null | undefined, b: CaseInfo): boolean {
  return a?.volume === b.volume && b.volume !== "";
}

/** Rows of a 4×4 similarity with determinant > 0. */
function similarity(reader: JsonReader, key: string): Matrix4 {
  const rows = reader.value(key);
  const flat = Array.isArray(rows) ? rows.flat() : [];
  if (flat.length !== 16 || !flat.every((v) => Number.isFinite(v))) {
    reader.fail(key);
  }
  const matrix = new Matrix4().fromArray(flat as number[]).transpose();
  const axes = [new Vector3(), new Vector3(), new Vector3()] as const;
  matrix.extractBasis(...axes);
  const scale = axes[0].length();
  const tolerance = 1e-4 * scale;
  const even = axes.every((a) => Math.abs(a.length() - scale) < tolerance);
  const upright =
    Math.abs(axes[0].dot(axes[1])) + Math.abs(axes[1].dot(axes[2])) + Math.abs(axes[2].dot(axes[0]));
  if (!(scale > 0) || !even || upright > tolerance * scale || matrix.determinant() <= 0) {
    reader.fail(key);
  }
  return matrix;
}

function readPlaced(reader: JsonReader): boolean {
  const placed = reader.has("splats");
  if (placed && reader.text("splats") !== "placed") {
    reader.fail("splats");
  }
  return placed;
}

/** What it is called, and the volume that it was made of. */
function readName(reader: JsonReader): Pick<CaseInfo, "title" | "preset" | "volume"> {
  const preset = reader.text("preset");
  const look = reader.has("look") ? reader.child("look") : null;
  const word = (key: string) => (look?.has(key) ? look.text(key) : "");
  const title = reader.text(reader.has("whole_title") ? "whole_title" : "title");
  const said = { title: word("title"), region: word("region"), modality: word("modality") };
  return { title: shownTitle({ title, preset, look: said }), preset, volume: look?.text("volume") ?? "" };
}

/** Throws CaseError. */
export function parseCaseInfo(block: unknown): CaseInfo {
  if (block === undefined) {
    throw new CaseError(
      "this SOG has no clipgs block, which says how it lies in the patient; make it with clipgs pack",
    );
  }
  const reader = new JsonReader(block, "clipgs");
  if (reader.value("version") !== 1) {
    throw new CaseError("the case is of a version that this viewer does not know; use a newer clipgs");
  }
  const vector = (from: JsonReader, key: string) => new Vector3(...from.vector(key));
  const sceneToPatient = similarity(reader.child("world"), "scene_to_ras_mm");
  const sphere = reader.child("sphere");
  const bounds = reader.child("bounds");
  const axis = vector(reader, "axis").normalize();
  const extent = reader.numbers("extent", 2) as [number, number];
  return {
    sceneToPatient,
    mmPerUnit: new Vector3().setFromMatrixColumn(sceneToPatient, 0).length(),
    states: reader.has("states") ? readStates(reader.child("states"), axis) : defaultStates(axis, extent),
    faceGain: readFaceGain(reader),
    placed: readPlaced(reader),
    sphere: { center: vector(sphere, "center"), radius: sphere.number("radius", Number.MIN_VALUE) },
    bounds: { min: vector(bounds, "min"), max: vector(bounds, "max") },
    ...readName(reader),
  };
}
