import { Quaternion, Vector3 } from "three";

/** How fast a still hand's trembling is followed, Hz, and how much faster for each m/s of its speed. */
const kStillHz = 2.5;
const kHzPerSpeed = 60;
/** A turn by so many radians is a movement of a metre: that of a point this far from the centre, m. */
const kArm = 0.15;

/**
 * Follows a pose that trembles: slowly where it stays, at once where it moves (G. Casiez et al., 1 € filter, CHI 2012).
 */
export class PoseFilter {
  readonly position = new Vector3();
  readonly quaternion = new Quaternion();

  /** Jumps to a pose. */
  reset(position: Vector3, quaternion: Quaternion): void {
    this.position.copy(position);
    this.quaternion.copy(quaternion);
  }

  /** Follows a pose after `seconds`. */
  follow(position: Vector3, quaternion: Quaternion, seconds: number): void {
    const away = this.position.distanceTo(position) + kArm * this.quaternion.angleTo(quaternion);
    const speed = away / Math.max(seconds, 1e-3);
    const cutoff = kStillHz + kHzPerSpeed * speed;
    const share = 1 - Math.exp(-2 * Math.PI * cutoff * seconds);
    this.position.lerp(position, share);
    this.quaternion.slerp(quaternion, share);
  }
}
