import { Matrix4, type PerspectiveCamera, Vector3 } from "three";

import { kWorldFromPatient, type Sphere } from "./geometry";

// The framing of the project, as src/core/camera.h has it: the same numbers give the same picture.

/** Field of view across the shorter side, radians. */
export const kFieldOfView = 0.6981317;
/** Share of the shorter side that the bounding sphere fills at zoom 1. */
export const kFrameFill = 0.9;

/**
 * Where the camera stands. Azimuth 0° looks at the patient from the front, 90° from the patient's left;
 * elevation 90° from above the head. `pan` moves what is looked at away from the sphere's centre, `back` the camera
 * away from that, mm.
 */
export interface View {
  azimuth: number;
  elevation: number;
  zoom: number;
  pan: Vector3;
  back: number;
}

/** Degrees: from straight above, what is up is not known. */
const kMaxElevation = 89.9;
const kZoom = { least: 0.25, most: 24 };

export function viewFrom(azimuth: number, elevation: number, zoom = 1): View {
  return { azimuth, elevation, zoom: withinZoom(zoom), pan: new Vector3(), back: 0 };
}

/** Unit vector from the target towards the camera, RAS. */
export function viewDirection(azimuth: number, elevation: number): Vector3 {
  const az = (azimuth * Math.PI) / 180;
  const el = (elevation * Math.PI) / 180;
  return new Vector3(-Math.sin(az) * Math.cos(el), Math.cos(az) * Math.cos(el), Math.sin(el));
}

/** The angles of a view from a direction (RAS), degrees. */
export function anglesOf(direction: Vector3): Pick<View, "azimuth" | "elevation"> {
  const { x, y, z } = direction.clone().normalize();
  const degrees = 180 / Math.PI;
  return {
    azimuth: Math.atan2(-x, y) * degrees,
    elevation: Math.asin(Math.min(1, Math.max(-1, z))) * degrees,
  };
}

/** Distance from a sphere's centre at which it fills kFrameFill of the shorter side. */
export function framingDistance(radius: number): number {
  return radius / Math.sin(Math.atan(kFrameFill * Math.tan(0.5 * kFieldOfView)));
}

/** Of the camera from what it looks at, mm. */
export function cameraDistance(view: View, sphere: Sphere): number {
  return Math.max(1, framingDistance(sphere.radius) + view.back);
}

/** The same camera, and what it turns about, as a view of something else in the patient. */
export function reframed(view: View, from: Sphere, to: Sphere): View {
  return {
    ...view,
    pan: from.center.clone().add(view.pan).sub(to.center),
    back: cameraDistance(view, from) - framingDistance(to.radius),
  };
}

/** Axes of a camera that looks along `forward` with the patient's head up, RAS. */
export function cameraAxes(forward: Vector3): { right: Vector3; down: Vector3 } {
  let right = new Vector3().crossVectors(forward, new Vector3(0, 0, 1));
  if (right.length() < 1e-4) {
    right = new Vector3(-1, 0, 0); // looking along the body: the patient's left is to the right
  }
  right.normalize();
  return { right, down: new Vector3().crossVectors(forward, right) };
}

/** Axes of the camera of a view, RAS. */
export function viewAxes({ azimuth, elevation }: View): { right: Vector3; down: Vector3 } {
  return cameraAxes(viewDirection(azimuth, elevation).negate());
}

/** Turned about what is looked at, by degrees to the right and up. */
export function turned(view: View, right: number, up: number): Pick<View, "azimuth" | "elevation"> {
  return {
    azimuth: wrapped(view.azimuth + right),
    elevation: clamp(view.elevation + up, -kMaxElevation, kMaxElevation),
  };
}

function withinZoom(zoom: number): number {
  return clamp(zoom, kZoom.least, kZoom.most);
}

export function zoomed({ zoom }: View, factor: number): Pick<View, "zoom"> {
  return { zoom: withinZoom(zoom * factor) };
}

/** With what is seen pushed by mm, but for no farther than it is seen. */
export function pushed(view: View, { radius }: Sphere, byRight: number, byDown: number): Pick<View, "pan"> {
  const { right, down } = viewAxes(view);
  const pan = view.pan.clone().addScaledVector(right, -byRight).addScaledVector(down, -byDown);
  return { pan: pan.clampLength(0, Math.max(2 * radius, view.pan.length())) };
}

function clamp(value: number, min: number, max: number): number {
  return Math.min(max, Math.max(min, value));
}

/** An angle in [−180°, 180°). */
function wrapped(degrees: number): number {
  return ((((degrees + 180) % 360) + 360) % 360) - 180;
}

/** What panels cover of a picture at its right and bottom, px: the case is framed in what they leave. */
export interface Inset {
  right: number;
  bottom: number;
}

/** Points a three.js camera, in the viewer's world, at `sphere` for a picture of width × height px. */
export function applyView(
  camera: PerspectiveCamera,
  view: View,
  sphere: Sphere,
  width: number,
  height: number,
  inset: Inset = { right: 0, bottom: 0 },
): void {
  const direction = viewDirection(view.azimuth, view.elevation);
  const distance = cameraDistance(view, sphere);
  const position = sphere.center.clone().add(view.pan).addScaledVector(direction, distance);
  const { right, down } = cameraAxes(direction.clone().negate());
  const basis = new Matrix4().makeBasis(right, down.negate(), direction).setPosition(position);
  const metres = new Matrix4().multiplyMatrices(kWorldFromPatient, basis);
  metres.decompose(camera.position, camera.quaternion, new Vector3());
  const focal = focalLength(view.zoom, width - inset.right, height - inset.bottom);
  camera.fov = (2 * Math.atan((0.5 * height) / focal) * 180) / Math.PI;
  camera.aspect = width / height;
  // What is cut may reach beyond the sphere, and the camera may have framed more than that.
  const nearest = Math.min(distance, framingDistance(sphere.radius));
  camera.near = 0.001 * Math.max(1, nearest - 3 * sphere.radius);
  camera.far = 0.001 * (distance + 5 * sphere.radius + view.pan.length() + Math.max(0, view.back));
  camera.setViewOffset(width, height, 0.5 * inset.right, 0.5 * inset.bottom, width, height);
  camera.updateMatrixWorld();
}

/** px. */
export function focalLength(zoom: number, width: number, height: number): number {
  return ((0.5 * Math.max(1, Math.min(width, height))) / Math.tan(0.5 * kFieldOfView)) * zoom;
}
