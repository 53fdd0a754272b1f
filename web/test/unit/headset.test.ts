import {
  Group,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Quaternion,
  Ray,
  Raycaster,
  Sphere,
  TorusGeometry,
  Vector3,
  type WebXRManager,
} from "three";
import { expect, it } from "vitest";

import { kWorldFromPatient, planeThrough, signedDistance } from "../../src/model/geometry";
import { kRim } from "../../src/render/plane_widget";
import { Hand } from "../../src/xr/hand";
import { planeOfPose, poseOfPlane, rimDistance } from "../../src/xr/plane_grip";
import { PoseFilter } from "../../src/xr/pose_filter";
import { makeRandom } from "./sog_fixture";

const kFrame = 1 / 72; // s

it("a plane has a pose in the viewer's world, and that pose the plane", () => {
  const middle = new Vector3(10, -20, 30);
  for (const normal of [new Vector3(0, 0, -1), new Vector3(0.2, -0.7, 0.5), new Vector3(1, 0, 0)]) {
    const plane = planeThrough(normal, new Vector3(4, 5, 6));
    const position = new Vector3();
    const quaternion = new Quaternion();
    poseOfPlane(plane, middle, position, quaternion);
    const back = planeOfPose(position, quaternion);
    expect(back.normal.distanceTo(plane.normal)).toBeLessThan(1e-6);
    expect(back.offset).toBeCloseTo(plane.offset, 4);
    const point = position.clone().applyMatrix4(kWorldFromPatient.clone().invert());
    expect(signedDistance(plane, point)).toBeCloseTo(0, 4);
    expect(point.sub(middle).cross(plane.normal).length()).toBeLessThan(1e-3); // the nearest to the middle
  }
});

it("a trembling hand moves a filtered pose little, a moving one takes it along", () => {
  const filter = new PoseFilter();
  const still = new Quaternion();
  filter.reset(new Vector3(), still);
  const tremble = 0.0005; // m
  let most = 0;
  for (let i = 0; i < 200; ++i) {
    filter.follow(new Vector3(tremble * (i % 2 === 0 ? 1 : -1), 0, 0), still, kFrame);
    most = i > 20 ? Math.max(most, Math.abs(filter.position.x)) : 0;
  }
  expect(most).toBeLessThan(0.3 * tremble);

  filter.reset(new Vector3(), still);
  const speed = 0.5; // m/s
  const hand = new Vector3();
  const turn = new Quaternion();
  for (let i = 0; i < 72; ++i) {
    hand.x += speed * kFrame;
    turn.setFromAxisAngle(new Vector3(0, 1, 0), i / 72);
    filter.follow(hand, turn, kFrame);
  }
  expect(hand.x - filter.position.x).toBeLessThan(0.5 * speed * kFrame);
  expect(filter.quaternion.angleTo(turn)).toBeLessThan(0.5 / 72);
});

/** A hand with a controller at the room's origin, that points along −z, and presses what it meets in `scene`. */
function controller() {
  const parts = { ray: new Group(), grip: new Group(), joints: Object.assign(new Group(), { joints: {} }) };
  const xr = {
    getController: () => parts.ray,
    getControllerGrip: () => parts.grip,
    getHand: () => parts.joints,
  };
  const hand = new Hand(xr as unknown as WebXRManager, 0, new PerspectiveCamera(), new Group(), () => {});
  parts.ray.dispatchEvent({
    type: "connected",
    data: { hand: null, handedness: "none", profiles: [] },
  } as never);
  const press = (scene: Group) => {
    scene.updateMatrixWorld();
    for (const time of [0, 14]) {
      hand.update(scene, time, { parts: new Group(), sphere: new Sphere() }, new Vector3());
    }
    parts.ray.dispatchEvent({ type: "selectstart" } as never);
    parts.ray.dispatchEvent({ type: "selectend" } as never);
    hand.dispose();
  };
  return press;
}

/** A sheet before the hand, which tells that it is pressed. */
function sheet(z: number, pressed: string[], name: string): Mesh {
  const mesh = new Mesh(new PlaneGeometry());
  mesh.position.z = z;
  mesh.addEventListener("click" as never, () => pressed.push(name));
  return mesh;
}

it("has hands that press what they point at, whatever without height lies near them", () => {
  const pressed: string[] = [];
  const flat = sheet(-0.02, pressed, "flat");
  flat.scale.y = 0;
  controller()(new Group().add(sheet(-1, pressed, "wall"), flat));
  expect(pressed).toEqual(["wall"]);
});

it("has hands that take what they are at, before what their ray meets sooner", () => {
  const pressed: string[] = [];
  const plane = sheet(0.05, pressed, "plane"); // behind: no ray meets it
  plane.pointerEventsOrder = 1;
  controller()(new Group().add(sheet(-0.01, pressed, "case"), plane));
  expect(pressed).toEqual(["plane"]);
});

it("the rim of the plane is met by rays where a ring of triangles is", () => {
  const ring = new Mesh(new TorusGeometry(kRim, 0.06, 96, 768), new MeshBasicMaterial());
  ring.updateMatrixWorld();
  const random = makeRandom(11);
  const point = (reach: number) =>
    new Vector3(random() - 0.5, random() - 0.5, random() - 0.5).multiplyScalar(2 * reach);
  let met = 0;
  for (let i = 0; i < 200; ++i) {
    const origin = point(3);
    const target = i % 2 === 0 ? point(1.5) : point(1).setZ(0).setLength(kRim);
    const ray = new Ray(origin, target.sub(origin).normalize());
    const caster = new Raycaster(ray.origin, ray.direction);
    const expected = caster.intersectObject(ring)[0]?.distance ?? null;
    const distance = rimDistance(ray);
    if (Math.hypot(Math.hypot(origin.x, origin.y) - kRim, origin.z) > 0.07) {
      expect(distance === null, JSON.stringify(ray)).toBe(expected === null);
      expect(distance ?? 0).toBeCloseTo(expected ?? 0, 1);
      met += Number(distance !== null);
    }
  }
  expect(met).toBeGreaterThan(80);
});
