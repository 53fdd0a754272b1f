import { Vector3 } from "three";

import type { Actions } from "../actions";
import { makeMark } from "../model/marks";
import type { CaseError } from "../sog/zip";
import type { StudyTexts } from "../text/study_en";
import { inOwnWords } from "../text/text";
import type { Viewer } from "../viewer";
import { type Entry, Journal, type Store } from "./journal";
import { TaskMeasures } from "./measures";
import type { Plan, Task } from "./plan";
import { modesOf, resumeAt, type Step, stepsOf } from "./schedule";
import type { Screen } from "./screen";
import { screenOf } from "./screens";

const kMostParticipant = 9999;
type Device = "headset" | "desk";
type TaskStep = Extract<Step, { kind: "task" }>;

/** What a study is led through with. */
export interface Surroundings {
  readonly viewer: Viewer;
  readonly actions: Actions;
  readonly store: Store;
  /** Whether there is a headset, and whether it is worn. */
  readonly headset: { readonly offered: boolean; readonly worn: boolean; enter(): void; leave(): void };
  /** Hz; null: it does not say. */
  displayHz(): number | null;
  /** Offers a text as a file. */
  save(name: string, text: string): void;
}

/** A task that is being done. */
interface Running {
  step: TaskStep;
  measures: TaskMeasures;
}

/** Leads one participant after the other through a plan: where they are, and what is done with what they do (screens.ts). */
export class Study {
  /** `screen` is another. */
  changed: () => void = () => {};
  readonly plan: Plan;
  /** What is said besides the plan, in its language. */
  readonly words: StudyTexts;
  readonly #around: Surroundings;
  #journal: Journal | null = null;
  #device: Device = "desk";
  #steps: readonly Step[] = [];
  #at = 0;
  #typed = "";
  #refusal: string | null = null;
  #busy = false;
  #running: Running | null = null;
  #restarts = 0;
  #answers: number[] = [];
  #item = 0;
  #restUntil: number | null = null;
  #ticking = 0;
  #ended = false;

  constructor(plan: Plan, words: StudyTexts, around: Surroundings) {
    this.plan = plan;
    this.words = words;
    this.#around = around;
    this.#ticking = window.setInterval(() => this.#tick(), 250);
  }

  dispose(): void {
    this.#ended = true;
    this.#running = null;
    this.#journal?.dispose();
    clearInterval(this.#ticking);
  }

  /** What is shown now. */
  get screen(): Screen {
    return screenOf(this);
  }

  get headset(): Surroundings["headset"] {
    return this.#around.headset;
  }

  /** Of the participant; null: none has begun. */
  get journal(): Journal | null {
    return this.#journal;
  }

  get device(): Device {
    return this.#device;
  }

  get steps(): readonly Step[] {
    return this.#steps;
  }

  /** The number of the step, from 0. */
  get at(): number {
    return this.#at;
  }

  /** Null: none has begun. */
  get step(): Step | null {
    return this.#journal ? this.#steps[this.#at]! : null;
  }

  /** A number or a comment. */
  get typed(): string {
    return this.#typed;
  }

  /** Why the number that was typed is refused; null: it is not. */
  get refusal(): string | null {
    return this.#refusal;
  }

  /** Something is being recorded, or looked up. */
  get busy(): boolean {
    return this.#busy;
  }

  /** To the items of a questionnaire, as far as they are given. */
  get answers(): readonly number[] {
    return this.#answers;
  }

  /** The item that is asked, from 0. */
  get item(): number {
    return this.#item;
  }

  get running(): Readonly<Running> | null {
    return this.#running;
  }

  /** What is measured now; null: nothing is. */
  get measures(): TaskMeasures | null {
    return this.#running?.measures ?? null;
  }

  get isCut(): boolean {
    return this.#around.viewer.cut !== null;
  }

  /** Left of a rest; 0: it is over. */
  get secondsOfRest(): number {
    const left = this.#restUntil === null ? 0 : this.#restUntil - performance.now();
    return Math.max(0, Math.ceil(left / 1000));
  }

  /** Left for the task; null: it may take any time, or none is done. */
  get secondsOfTask(): number | null {
    const { limit } = this.plan;
    return this.measures && limit && Math.max(0, Math.ceil(limit - this.measures.seconds(performance.now())));
  }

  /** The viewer's state is another, or the headset is put on or taken off. */
  observe(): void {
    const { viewer, headset } = this.#around;
    this.measures?.plane(viewer.cut, performance.now());
    if (this.#running && this.#device === "headset" && !headset.worn) {
      this.#running = null; // begun again when it is worn again
      ++this.#restarts;
    }
    this.changed();
  }

  /** The participant's number, or the comment. */
  type(value: string): void {
    this.#typed = value;
    this.changed();
  }

  /** Looks for what the participant has done already, and begins, or goes on with it. */
  async begin(device: Device): Promise<void> {
    const participant = Number(this.#typed);
    if (!Number.isInteger(participant) || participant < 1 || participant > kMostParticipant) {
      this.#refusal = this.words.wrongNumber(kMostParticipant);
      this.changed();
      return;
    }
    if (device === "headset") {
      this.headset.enter(); // browsers want it in the click itself
    }
    await this.#alone(async () => {
      try {
        await this.#open(participant, device);
      } catch (error) {
        this.#refusal = inOwnWords((error as CaseError).message);
        this.headset.leave();
      }
    });
  }

  /** To the next step. */
  advance(): void {
    this.#goTo(this.#at + 1);
  }

  /** To another item of a questionnaire. */
  turnTo(item: number): void {
    this.#item = item;
    this.changed();
  }

  /** To the item that is asked. */
  answer(value: number): void {
    this.#answers[this.#item] = value;
    this.changed();
  }

  sendAnswers({ mode, questionnaire }: Extract<Step, { kind: "questionnaire" }>): void {
    void this.#record({ kind: "answers", mode, questionnaire, answers: this.#answers });
  }

  sendComment(): void {
    void this.#record({ kind: "comment", text: this.#typed });
  }

  startTask(step: TaskStep): void {
    const { viewer } = this.#around;
    this.#prepare(step.mode, step.task);
    const now = performance.now();
    const measures = new TaskMeasures(step.task.target, viewer.info!.sphere.center, now);
    measures.plane(viewer.cut, now);
    this.#running = { step, measures };
    this.changed();
  }

  async endTask(outcome: "done" | "time"): Promise<void> {
    const running = this.#running;
    if (!running || this.#busy) {
      return;
    }
    const { step, measures } = running;
    const summary = measures.summary(performance.now(), this.#around.displayHz());
    this.#running = null;
    await this.#record({
      kind: "task",
      mode: step.mode,
      task: step.task.name,
      practice: step.practice,
      outcome,
      ...summary,
      restarts: this.#restarts,
    });
  }

  /** Gives all that is recorded of the participant as a file. */
  saveCopy(): void {
    const { session, text } = this.#journal!;
    this.#around.save(`${session}.jsonl`, text);
  }

  takeNext(): void {
    this.headset.leave();
    this.#journal?.dispose();
    this.#journal = null;
    this.changed();
  }

  async #open(participant: number, device: Device): Promise<void> {
    const { plan } = this;
    const { store } = this.#around;
    const resumed = await Journal.resume(plan, participant, store);
    const journal = resumed ?? Journal.begin(participant, store);
    journal.changed = () => this.changed();
    this.#refusal = null;
    this.#typed = "";
    this.#device = resumed ? (journal.entries[0]!["device"] as Device) : device;
    this.#steps = stepsOf(plan, participant);
    this.#journal = journal;
    if (resumed) {
      await journal.send();
      await this.#go(resumeAt(this.#steps, journal.entries.length - 1));
    } else {
      await journal.add({
        kind: "session",
        format: 1,
        plan: plan.name,
        digest: plan.digest,
        participant,
        order: modesOf(plan, participant).map(({ mode }) => mode),
        device,
      });
      this.#goTo(0);
    }
  }

  /** What is done meanwhile cannot be done twice. */
  async #alone(work: () => Promise<void>): Promise<void> {
    if (this.#busy) {
      return;
    }
    this.#busy = true;
    this.changed();
    await work();
    this.#busy = false;
    if (!this.#ended) {
      this.changed();
    }
  }

  /** Goes on when it is recorded. */
  async #record(entry: Entry): Promise<void> {
    await this.#alone(async () => {
      await this.#journal!.add(entry);
      await this.#go(this.#at + 1);
    });
  }

  /** Who is thanked has all recorded, the end as well. */
  async #go(at: number): Promise<void> {
    if (this.#steps[at]!.kind === "thanks") {
      await this.#journal!.add({ kind: "end" });
    }
    this.#goTo(at);
  }

  #goTo(at: number): void {
    this.#at = at;
    this.#item = 0;
    this.#answers = [];
    this.#typed = "";
    this.#restarts = 0;
    this.#around.viewer.store.setMarks([]);
    const step = this.#steps[at]!;
    this.#restUntil = step.kind === "pause" ? performance.now() + 1000 * this.plan.pause : null;
    if (step.kind === "mode" || step.kind === "task") {
      this.#prepare(step.kind === "mode" ? step.mode.mode : step.mode, null);
    }
    this.changed();
  }

  /** The plane, the view and the marks that a task begins with. */
  #prepare(mode: "uniaxial" | "arbitrary", task: Task | null): void {
    const { viewer, actions } = this.#around;
    viewer.store.setMode("arbitrary");
    actions.reset();
    viewer.store.setMode(mode);
    viewer.store.setHandle(true);
    const marked = task?.marked ? task.target.points : [];
    viewer.store.setMarks(marked.map((point) => makeMark({ kind: "point", points: [point], normal: null })));
    if (task?.view) {
      viewer.store.setView({ ...task.view, pan: new Vector3(), back: 0 });
    }
    actions.forget();
  }

  /** Time goes by. */
  #tick(): void {
    const { limit } = this.plan;
    if (limit && this.measures && this.measures.seconds(performance.now()) >= limit) {
      void this.endTask("time");
    } else if ((limit && this.#running) || this.#restUntil !== null) {
      this.changed();
    }
  }
}
