import { Data3DTexture, LinearFilter, Matrix4, RGBAFormat, type WebGLRenderer } from "three";

import { indexFromPatient } from "../model/faces";
import type { Plane } from "../model/geometry";
import type { LightRig } from "../sog/section";
import type { LightClient } from "../worker/light_client";
import type { WallLight } from "../worker/protocol";
import type { SectionFaces } from "./section_faces";
import type { SplatMesh } from "./splat_mesh";
import { uploadInPieces } from "./upload";

function same(a: readonly Plane[], b: readonly Plane[]): boolean {
  return (
    a.length === b.length &&
    a.every((plane, i) => plane.offset === b[i]!.offset && plane.normal.equals(b[i]!.normal))
  );
}

/** Bytes handed over at once. More take the main thread longer, fewer let a moving plane wait longer for its light. */
const kUploadBytes = 1.5e6;

function lightTexture(texels: Uint8Array, [x, y]: WallLight["cells"], depth: number): Data3DTexture {
  const texture = new Data3DTexture(texels as BufferSource as Uint8Array<ArrayBuffer>, x, y, depth);
  texture.format = RGBAFormat;
  texture.internalFormat = "SRGB8_ALPHA8";
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Light under a cut: nearly as it is, or all that is computed. */
interface Solution {
  planes: readonly Plane[];
  rig: LightRig | null;
  quick: boolean;
}

/** On the GPU: the light that the case was made in, that of a cut, which is drawn, and what will take its place. */
interface Textures {
  own: Data3DTexture;
  shown: Data3DTexture;
  next: Data3DTexture;
  cells: WallLight["cells"];
}

/**
 * Keeps the light in what cuts open, and on the splats, that of the cut and of the lights that were chosen: nearly, while
 * planes move, and at rest as `clipgs render` has it. `changed` is called where what is seen has changed.
 */
export class OpenedLight {
  readonly #renderer: WebGLRenderer;
  readonly #client: LightClient;
  readonly #faces: SectionFaces;
  readonly #mesh: SplatMesh;
  readonly #changed: () => void;
  /** Until it is known whether there is anything to light. */
  readonly ready: Promise<void>;
  #textures: Textures | null = null;
  #state: "coming" | "drawn" | "none" = "coming";
  #lit: Solution | null = null;
  #solving: Promise<void> | null = null;
  #rig: LightRig | null = null; // that is wanted; null: the case's own
  #told: LightRig | null = null; // that the worker knows of

  constructor(
    renderer: WebGLRenderer,
    client: LightClient,
    faces: SectionFaces,
    mesh: SplatMesh,
    changed: () => void,
  ) {
    this.#renderer = renderer;
    this.#client = client;
    this.#faces = faces;
    this.#mesh = mesh;
    this.#changed = changed;
    this.ready = client.openings.then(async (openings) => {
      if (openings && this.#state !== "none") {
        this.#faces.setSpace(openings);
      }
      if (!openings?.light || this.#state === "none") {
        this.dispose();
      } else {
        await this.#take(openings.light);
      }
      changed();
    });
  }

  /** Whether lights can be chosen: null, until that is known. */
  get canChangeRig(): boolean | null {
    return this.#state === "coming" ? null : this.#state === "drawn";
  }

  /** Chooses lights; null: those that the case was made in. */
  setRig(rig: LightRig | null): void {
    if (this.#state === "drawn" && rig !== this.#rig) {
      this.#rig = rig;
      this.#faces.setRig(rig ?? this.#faces.section.rig);
      this.#changed();
    }
  }

  /** Whether the light is that of the cut, and as good as it gets. */
  isSettled(planes: readonly Plane[]): boolean {
    const lit = this.#lit;
    return (
      this.#state === "none" ||
      !this.#matters(planes) ||
      (this.#state === "drawn" && lit !== null && !lit.quick && this.#is(lit, planes))
    );
  }

  /** Whether splats look otherwise than they were trained. */
  relights(planes: readonly Plane[]): boolean {
    return this.#lit !== null && this.#matters(planes);
  }

  /** Asks for the light under a cut, unless some is being computed. */
  follow(planes: readonly Plane[], quick: boolean): void {
    const enough = quick && this.#lit !== null && this.#is(this.#lit, planes);
    if (this.#state === "drawn" && !this.#solving && !enough && !this.isSettled(planes)) {
      void this.#solve(planes, quick);
    }
  }

  /** Until the light is that of the cut. */
  async settle(planes: readonly Plane[]): Promise<void> {
    await this.ready;
    while (!this.isSettled(planes)) {
      await (this.#solving ?? this.#solve(planes, false));
    }
  }

  dispose(): void {
    this.#state = "none";
    this.#client.dispose();
    if (this.#textures) {
      const { own, shown, next } = this.#textures;
      [own, shown, next].forEach((texture) => texture.dispose());
    }
    this.#textures = null;
  }

  #is({ planes, rig }: Solution, wanted: readonly Plane[]): boolean {
    return rig === this.#rig && same(planes, wanted);
  }

  /** Uncut, under its own lights, a case looks as it was trained. */
  #matters(planes: readonly Plane[]): boolean {
    return planes.length > 0 || this.#rig !== null;
  }

  async #take(light: WallLight): Promise<void> {
    const { ownLight, cells, cellSize } = light;
    const { section } = this.#faces;
    const texture = () => lightTexture(ownLight.texels, cells, 12 * cells[2]);
    const textures = { own: texture(), shown: texture(), next: texture(), cells };
    this.#textures = textures;
    if (!(await this.#give(textures.own, ownLight.texels))) {
      return;
    }
    const [x, y, z] = section.spacing.map((mm) => mm / cellSize);
    const cellFromPatient = new Matrix4().makeScale(x!, y!, z!).multiply(indexFromPatient(section));
    this.#state = "drawn";
    this.#faces.setOpenings(light);
    this.#faces.setOwnLight(textures.own, ownLight.scale);
    this.#mesh.setOwnLight(textures.own, ownLight.scale, cells, cellFromPatient, section.tone);
  }

  /** Hands texels to the GPU. Returns whether anybody still wants them. */
  async #give(texture: Data3DTexture, texels: Uint8Array): Promise<boolean> {
    const { cells } = this.#textures!;
    texture.image.data = texels as BufferSource as Uint8Array<ArrayBuffer>;
    const slice = 4 * cells[0] * cells[1];
    const piece = (z: number, depth: number) =>
      lightTexture(texels.subarray(z * slice, (z + depth) * slice), cells, depth);
    const wanted = () => this.#textures !== null;
    await uploadInPieces(this.#renderer, texture, piece, Math.ceil(kUploadBytes / slice), wanted);
    return wanted();
  }

  #solve(planes: readonly Plane[], quick: boolean): Promise<void> {
    this.#solving = this.#light(planes, quick).then(() => {
      this.#solving = null;
      this.#changed();
    });
    return this.#solving;
  }

  async #light(planes: readonly Plane[], quick: boolean): Promise<void> {
    const values = planes.flatMap(({ normal, offset }) => [...normal.toArray(), offset]);
    const rig = this.#rig;
    if (rig !== this.#told) {
      this.#told = rig;
      this.#client.setRig(rig ?? this.#faces.section.rig);
    }
    const solved = await this.#client.solve(Float32Array.from(values), quick);
    const textures = this.#textures;
    if (!solved) {
      this.#state = "none"; // what was lit last stays
    } else if (textures && (await this.#give(textures.next, solved.texels))) {
      const { next, shown } = textures;
      textures.shown = next;
      textures.next = shown;
      this.#faces.setLight(next, solved.scale);
      this.#mesh.setLight(next, solved.scale);
      this.#lit = { planes, rig, quick };
    }
  }
}
