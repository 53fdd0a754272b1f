import { Vector3 } from "three";

import type { Actions } from "../actions";
import { makeMark } from "../model/marks";
import type { CaseError } from "../sog/zip";
import type { Viewer } from "../viewer";
import { type Entry, Journal, type Store } from "./journal";
import { TaskMeasures } from "./measures";
import type { Plan, Task } from "./plan";
import { kItems } from "./questionnaires";
import { modesOf, resumeAt, type Step, stepsOf } from "./schedule";
import type { Button, Screen } from "./screen";

const kMostParticipant = 9999;
const kMostComment = 4000; // bytes
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

/** Leads one participant after the other through a plan. */
export class Study {
  /** `screen` is another. */
  changed: () => void = () => {};
  readonly plan: Plan;
  readonly #around: Surroundings;
  #journal: Journal | null = null;
  #device: Device = "desk";
  #steps: readonly Step[] = [];
  #at = 0;
  #typed = "";
  #refusal: string | null = null; // of what was typed
  #busy = false; // something is being recorded, or looked up
  #running: Running | null = null;
  #restarts = 0;
  #answers: number[] = [];
  #item = 0;
  #restUntil: number | null = null;
  #ticking = 0;
  #ended = false;

  constructor(plan: Plan, around: Surroundings) {
    this.plan = plan;
    this.#around = around;
    this.#ticking = window.setInterval(() => this.#tick(), 250);
  }

  dispose(): void {
    this.#ended = true;
    this.#running = null;
    this.#journal?.dispose();
    clearInterval(this.#ticking);
  }

  /** What is measured now; null: nothing is. */
  get measures(): TaskMeasures | null {
    return this.#running?.measures ?? null;
  }

  /** The viewer's state is another, or the headset is put on or taken off. */
  observe(): void {
    const { viewer, headset } = this.#around;
    this.#running?.measures.plane(viewer.cut, performance.now());
    if (this.#running && this.#device === "headset" && !headset.worn) {
      this.#running = null; // begun again when it is worn again
      ++this.#restarts;
    }
    this.changed();
  }

  get screen(): Screen {
    const step = this.#journal ? this.#steps[this.#at]! : null;
    const blank = {
      key: `${this.#journal?.session ?? ""} ${this.#at} ${this.#item} ${this.#running !== null}`,
      title: this.plan.title,
      text: [],
      question: null,
      entry: null,
      slides: false,
      aside: false,
      remaining: null,
      buttons: [],
      trouble: this.#trouble,
    };
    if (this.#busy && blank.trouble) {
      return { ...blank, key: "trouble", buttons: [this.#copyButton] };
    }
    return { ...blank, ...(step ? this.#screenOf(step) : this.#start()) };
  }

  /** For the experimenter, where nothing else helps. */
  get #copyButton(): Button {
    const journal = this.#journal!;
    return {
      text: "Save a copy",
      enabled: !this.#around.headset.worn,
      press: () => this.#around.save(`${journal.session}.jsonl`, journal.text),
    };
  }

  get #trouble(): string | null {
    const trouble = this.#journal?.trouble;
    return trouble ? `Please call the experimenter. Nothing is lost: ${trouble}` : null;
  }

  #start(): Partial<Screen> {
    const { headset } = this.#around;
    const begin = (device: Device) => () => void this.#begin(device);
    return {
      text: this.#refusal ? [this.#refusal] : ["For the experimenter: the participant's number, no name."],
      entry: {
        label: "Participant",
        kind: "number",
        value: this.#typed,
        set: (value) => (this.#typed = value),
      },
      buttons: [
        this.#button("Begin at the desk", begin("desk")),
        ...(headset.offered ? [this.#button("Begin in the headset", begin("headset"))] : []),
      ],
    };
  }

  #screenOf(step: Step): Partial<Screen> {
    const { headset } = this.#around;
    const atDesk = step.kind === "comment" || step.kind === "thanks";
    if (this.#device === "headset" && !headset.worn && !atDesk) {
      return {
        text: ["Put the headset on, and go on there."],
        buttons: [this.#button("Put it on", () => headset.enter())],
      };
    }
    switch (step.kind) {
      case "welcome":
        return { text: this.plan.welcome, buttons: [this.#button("Go on", () => this.#advance())] };
      case "mode":
        return {
          title: step.mode.title,
          text: [step.mode.text],
          buttons: [this.#button("Go on", () => this.#advance())],
        };
      case "pause":
        return this.#pause();
      case "task":
        return this.#task(step);
      case "questionnaire":
        return this.#question(step);
      case "comment":
        return this.#comment();
      case "thanks":
        return this.#thanks();
    }
  }

  #pause(): Partial<Screen> {
    const left = this.#secondsLeft(this.#restUntil);
    return {
      title: "Have a rest",
      text: ["It goes on with the other way of cutting."],
      remaining: left,
      buttons: [{ text: "Go on", enabled: left === 0, press: () => this.#advance() }],
    };
  }

  #task(step: TaskStep): Partial<Screen> {
    const { task, practice } = step;
    const title = practice ? "To practise" : this.#numberOf(step);
    const running = this.#running;
    if (!running) {
      return {
        title,
        text: [task.text],
        buttons: [this.#button("Start", () => this.#startTask(step))],
      };
    }
    const { limit } = this.plan;
    const { viewer } = this.#around;
    return {
      title,
      text: [task.text],
      aside: true,
      slides: true,
      remaining: limit && Math.max(0, Math.ceil(limit - running.measures.seconds(performance.now()))),
      buttons: [
        {
          text: "Done",
          enabled: !this.#busy && viewer.cut !== null,
          press: () => void this.#endTask("done"),
        },
      ],
    };
  }

  /** "Task 2 of 3", in its mode. */
  #numberOf(step: TaskStep): string {
    const tasks = this.#steps.filter((one) => one.kind === "task" && one.mode === step.mode && !one.practice);
    return `Task ${tasks.indexOf(step) + 1} of ${tasks.length}`;
  }

  #question(step: Extract<Step, { kind: "questionnaire" }>): Partial<Screen> {
    const items = kItems[step.questionnaire];
    const item = items[this.#item]!;
    const last = this.#item === items.length - 1;
    const chosen = this.#answers[this.#item] ?? null;
    const back = this.#button("Back", () => this.#turnTo(this.#item - 1));
    return {
      title: items.length > 1 ? `Question ${this.#item + 1} of ${items.length}` : "One more question",
      question: {
        ...item,
        chosen,
        enabled: !this.#busy,
        choose: (value) => {
          this.#answers[this.#item] = value;
          this.changed();
        },
      },
      buttons: [
        ...(this.#item > 0 ? [back] : []),
        {
          text: last ? "Send" : "Next",
          enabled: !this.#busy && chosen !== null,
          press: () => {
            if (last) {
              const { mode, questionnaire } = step;
              void this.#record({ kind: "answers", mode, questionnaire, answers: this.#answers });
            } else {
              this.#turnTo(this.#item + 1);
            }
          },
        },
      ],
    };
  }

  #comment(): Partial<Screen> {
    if (this.#around.headset.worn) {
      return {
        text: ["Please take the headset off: the last question waits at the desk."],
        buttons: [this.#button("Take off", () => this.#around.headset.leave())],
      };
    }
    const bytes = new TextEncoder().encode(this.#typed).length;
    return {
      title: "In your own words",
      text: ["What was good, what was not? Please write no names. It may stay empty."],
      entry: {
        label: "Comment",
        kind: "text",
        value: this.#typed,
        set: (value) => {
          this.#typed = value;
          this.changed();
        },
      },
      buttons: [
        {
          text: bytes > kMostComment ? "Too long" : "Send",
          enabled: !this.#busy && bytes <= kMostComment,
          press: () => void this.#record({ kind: "comment", text: this.#typed }),
        },
      ],
    };
  }

  #thanks(): Partial<Screen> {
    return {
      title: "Thank you",
      text: ["That was all. Your answers are recorded."],
      buttons: [
        this.#button("Next participant", () => {
          this.#around.headset.leave();
          this.#journal?.dispose();
          this.#journal = null;
          this.changed();
        }),
      ],
    };
  }

  #button(text: string, press: () => void): Button {
    return { text, enabled: !this.#busy, press };
  }

  #secondsLeft(until: number | null): number {
    return until === null ? 0 : Math.max(0, Math.ceil((until - performance.now()) / 1000));
  }

  #turnTo(item: number): void {
    this.#item = item;
    this.changed();
  }

  /** Looks for what the participant has done already, and begins, or goes on with it. */
  async #begin(device: Device): Promise<void> {
    const participant = Number(this.#typed);
    if (!Number.isInteger(participant) || participant < 1 || participant > kMostParticipant) {
      this.#refusal = `A participant's number is a whole number from 1 to ${kMostParticipant}.`;
      this.changed();
      return;
    }
    if (device === "headset") {
      this.#around.headset.enter(); // browsers want it in the click itself
    }
    await this.#alone(async () => {
      try {
        await this.#open(participant, device);
      } catch (error) {
        this.#refusal = (error as CaseError).message;
        this.#around.headset.leave();
      }
    });
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

  #advance(): void {
    this.#goTo(this.#at + 1);
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

  #startTask(step: TaskStep): void {
    const { viewer } = this.#around;
    this.#prepare(step.mode, step.task);
    const now = performance.now();
    const measures = new TaskMeasures(step.task.target, viewer.info!.sphere.center, now);
    measures.plane(viewer.cut, now);
    this.#running = { step, measures };
    this.changed();
  }

  async #endTask(outcome: "done" | "time"): Promise<void> {
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

  /** Time goes by. */
  #tick(): void {
    const { limit } = this.plan;
    const running = this.#running;
    if (running && limit && running.measures.seconds(performance.now()) >= limit) {
      void this.#endTask("time");
    } else if ((running && limit) || this.#restUntil !== null) {
      this.changed();
    }
  }
}
