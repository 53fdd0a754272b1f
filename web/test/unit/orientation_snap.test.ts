import { Vector3 } from "three";
import { expect, it } from "vitest";

import { OrientationSnap } from "../../src/model/orientation_snap";

/** A coronal plane's normal, turned by so many degrees towards the axial. */
function turned(degrees: number): Vector3 {
  const angle = (degrees * Math.PI) / 180;
  return new Vector3(0, -Math.cos(angle), -Math.sin(angle));
}

it("clicks a plane onto the body plane that it comes near, and lets go of it farther away", () => {
  const snap = new OrientationSnap();
  snap.begin(turned(30));
  const coronal = new Vector3(0, -1, 0);
  for (const [degrees, held] of [
    [20, false],
    [6, false],
    [4, true],
    [-7, true],
    [7, true],
    [9, false],
    [6, false],
  ] as const) {
    const normal = turned(degrees);
    expect(snap.turn(normal).distanceTo(held ? coronal : normal), `${degrees}°`).toBe(0);
    expect(snap.caught !== null).toBe(held);
  }
  expect(snap.turn(turned(87)).distanceTo(new Vector3(0, 0, -1))).toBe(0);
});

it("holds a plane that is a body plane when it is taken hold of", () => {
  const snap = new OrientationSnap();
  snap.begin(turned(0));
  expect(snap.caught).not.toBeNull();
  snap.begin(turned(45));
  expect(snap.caught).toBeNull();
});

it("leaves a plane as it is turned where that is wanted", () => {
  const snap = new OrientationSnap();
  snap.begin(turned(0));
  snap.enabled = false;
  const normal = turned(3);
  expect(snap.turn(normal)).toBe(normal);
  expect(snap.caught).toBeNull();
});
