import type { Plane } from "../model/geometry";
import type { LightClient } from "../worker/light_client";
import type { SectionFaces } from "./section_faces";

function same(a: readonly Plane[], b: readonly Plane[]): boolean {
  return (
    a.length === b.length &&
    a.every((plane, i) => plane.offset === b[i]!.offset && plane.normal.equals(b[i]!.normal))
  );
}

/** Light under a cut: nearly as it is, or all that is computed. */
interface Solution {
  planes: readonly Plane[];
  quick: boolean;
}

/**
 * Keeps the light in what cuts open that of the cut: nearly, while planes move, and at rest as `clipgs render` has it.
 * `changed` is called where what is seen has changed.
 */
export class OpenedLight {
  /** Until it is known whether there is anything to light. */
  readonly ready: Promise<void>;
  readonly #client: LightClient;
  readonly #faces: SectionFaces;
  readonly #changed: () => void;
  #state: "coming" | "drawn" | "none" = "coming";
  #lit: Solution | null = null;
  #solving: Promise<void> | null = null;

  constructor(client: LightClient, faces: SectionFaces, changed: () => void) {
    this.#client = client;
    this.#faces = faces;
    this.#changed = changed;
    this.ready = client.openings.then((openings) => {
      this.#state = openings ? "drawn" : "none";
      if (openings) {
        faces.setOpenings(openings);
      } else {
        client.dispose();
      }
      changed();
    });
  }

  /** Whether the light of openings is that of the cut, and as good as it gets. */
  isSettled(planes: readonly Plane[]): boolean {
    const lit = this.#lit;
    return (
      this.#state === "none" ||
      planes.length === 0 ||
      (this.#state === "drawn" && lit !== null && !lit.quick && same(lit.planes, planes))
    );
  }

  /** Asks for the light under a cut, unless some is being computed. */
  follow(planes: readonly Plane[], quick: boolean): void {
    const { planes: before } = this.#lit ?? { planes: [] };
    const enough = quick && this.#lit !== null && same(before, planes);
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
  }

  #solve(planes: readonly Plane[], quick: boolean): Promise<void> {
    const values = planes.flatMap(({ normal, offset }) => [...normal.toArray(), offset]);
    this.#solving = this.#client.solve(Float32Array.from(values), quick).then((texels) => {
      this.#solving = null;
      if (!texels) {
        this.#state = "none"; // what was lit last stays
      } else if (this.#state === "drawn") {
        this.#faces.setLight(texels);
        this.#lit = { planes, quick };
        this.#changed();
      }
    });
    return this.#solving;
  }
}
