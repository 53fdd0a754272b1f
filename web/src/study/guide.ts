import type { App } from "../app";
import { StudyCard } from "../ui/study_card";
import type { Study } from "./study";

/** Leads people through a study, on the page and in a headset: nothing else is there to be used. */
export class StudyGuide {
  readonly #study: Study;
  readonly #app: App;
  readonly #card: StudyCard;
  #counting = 0;

  constructor(study: Study, app: App) {
    this.#study = study;
    this.#app = app;
    this.#card = new StudyCard(app.actions, study.words, study.plan.language);
  }

  /** What is shown on the page, where the case is to be seen above it. */
  get cardAside(): HTMLElement | null {
    return this.#card.isAside ? this.#card.element : null;
  }

  begin(): void {
    const study = this.#study;
    const { root, headset } = this.#app;
    root.classList.add("in-study");
    for (const part of root.querySelectorAll<HTMLElement>(".bar, .mark-layer")) {
      part.inert = true; // neither the case nor a mark is to be changed
    }
    root.append(this.#card.element);
    headset.study = study;
    headset.framed = (time, head, forward) => {
      study.measures?.frames.count(time);
      study.measures?.head(head, forward);
      study.measures?.holds(headset.stage.grip.holding !== null);
    };
    study.changed = () => (headset.worn ? headset.refresh() : this.#showCard());
    this.#countFrames();
    study.changed();
    this.#app.frame();
  }

  /** The viewer's state is another, or the headset is put on or taken off. */
  observe(): void {
    this.#study.observe();
  }

  dispose(): void {
    cancelAnimationFrame(this.#counting);
    this.#study.dispose();
  }

  /** The case is framed in what the card leaves free. */
  #showCard(): void {
    if (this.#card.show(this.#study.screen)) {
      this.#app.frame();
    }
  }

  /** Of the page, while a task is done there. */
  #countFrames(): void {
    this.#counting = requestAnimationFrame((time) => {
      if (!this.#app.headset.worn) {
        this.#study.measures?.frames.count(time);
      }
      this.#countFrames();
    });
  }
}
