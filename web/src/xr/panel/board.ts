import type { Container } from "@pmndrs/uikit";
import { Group, type Vector3 } from "three";

/** Something small to read or press in the room, apart from the panel, while it is shown; at first it is not. */
export class Board {
  /** In the room. */
  readonly object = new Group();
  readonly #root: Container;
  readonly #isMet: boolean;

  /** `isMet`: hands meet it while it is shown. */
  constructor(root: Container, isMet: boolean) {
    this.#root = root;
    this.#isMet = isMet;
    this.object.add(root);
    this.show(false);
  }

  get isShown(): boolean {
    return this.object.visible;
  }

  show(isShown: boolean): void {
    this.object.visible = isShown;
    this.object.intersectChildren = isShown && this.#isMet;
  }

  /** Puts it before the eyes, so far from them towards a place, and so much higher, m. */
  putBefore(eye: Vector3, place: Vector3, away: number, above = 0): void {
    this.object.position.copy(place).sub(eye).setLength(away).add(eye);
    this.object.position.y += above;
    this.object.lookAt(eye);
  }

  /** Before a frame. */
  update(delta: number): void {
    if (this.isShown) {
      this.#root.update(delta);
    }
  }

  /** What it consists of, as the panel is asked for its own (widgets.ts); null: it is not shown. */
  get content(): Container | null {
    return this.isShown ? this.#root : null;
  }

  dispose(): void {
    this.#root.dispose();
  }
}
