import { type Matrix4, Vector2, Vector3 } from "three";

import type { Sphere } from "../model/geometry";

/** `Backdrop` of shaders/depth_cue.glsl. */
export interface BackdropUniform {
  isGlow: boolean;
  size: Vector2;
  center: Vector2;
  inner: Vector3;
  middle: Vector3;
  outer: Vector3;
}

/** Black, of any size. */
export function makeBackdrop(): BackdropUniform {
  return {
    isGlow: false,
    size: new Vector2(1, 1),
    center: new Vector2(),
    inner: new Vector3(),
    middle: new Vector3(),
    outer: new Vector3(),
  };
}

/** `DepthCue` of shaders/depth_cue.glsl. */
export interface CueUniform {
  strength: number;
  center: Vector3;
  radius: number;
  covering: boolean;
}

/** How what is far away of a case fades towards what lies behind it, for the shaders of splats and faces. */
export class DepthCue {
  readonly splats: CueUniform; // in scene space
  readonly faces: CueUniform; // RAS mm
  /** What lies behind the picture that is drawn. */
  readonly backdrop = makeBackdrop();

  constructor(sphere: Sphere, sceneToPatient: Matrix4, mmPerUnit: number) {
    const { center, radius } = sphere;
    this.faces = { strength: 0, center, radius, covering: false };
    this.splats = {
      ...this.faces,
      center: center.clone().applyMatrix4(sceneToPatient.clone().invert()),
      radius: radius / mmPerUnit,
    };
  }

  get strength(): number {
    return this.faces.strength;
  }

  /** 0: nothing fades … 1: what is farthest has gone. */
  set strength(strength: number) {
    this.splats.strength = this.faces.strength = strength;
  }

  /** Whether what is left of what covers the picture is drawn, in place of colours. */
  set covering(covering: boolean) {
    this.splats.covering = this.faces.covering = covering;
  }

  /** Fades towards a backdrop, in a picture of `scale` times its size. */
  setBackdrop(backdrop: BackdropUniform, scale: number): void {
    const { size, center, inner, middle, outer } = this.backdrop;
    this.backdrop.isGlow = backdrop.isGlow;
    size.copy(backdrop.size).multiplyScalar(scale);
    center.copy(backdrop.center).multiplyScalar(scale);
    inner.copy(backdrop.inner);
    middle.copy(backdrop.middle);
    outer.copy(backdrop.outer);
  }
}
