import type { Mode } from "../api";
import type { Plan, PlannedMode, Task } from "./plan";
import type { Questionnaire } from "./questionnaires";

/** What a participant goes through, one after the other; of those with `recorded` a record is made. */
export type Step =
  | { kind: "welcome"; recorded: false }
  | { kind: "mode"; mode: PlannedMode; recorded: false }
  | { kind: "task"; mode: Mode; task: Task; practice: boolean; recorded: true }
  | { kind: "pause"; recorded: false }
  | { kind: "questionnaire"; mode: Mode; questionnaire: Questionnaire; recorded: true }
  | { kind: "comment"; recorded: true }
  | { kind: "thanks"; recorded: true };

/** Of participant 1, 2, …: every other one begins with the other mode, where the plan wants that. */
export function modesOf({ modes, counterbalanced }: Plan, participant: number): PlannedMode[] {
  return counterbalanced && participant % 2 === 0 ? [...modes].reverse() : [...modes];
}

/** The order of tasks in a participant's first or second (`position` 1) mode: all begin equally often. */
export function tasksOf({ tasks, rotated }: Plan, participant: number, position: number): Task[] {
  const first = rotated ? (Math.floor((participant - 1) / 2) + position) % tasks.length : 0;
  return [...tasks.slice(first), ...tasks.slice(0, first)];
}

export function stepsOf(plan: Plan, participant: number): Step[] {
  const modes = modesOf(plan, participant);
  return [
    { kind: "welcome", recorded: false },
    ...modes.flatMap((mode, position): Step[] => [
      ...(position > 0 && plan.pause > 0 ? [{ kind: "pause", recorded: false } as const] : []),
      { kind: "mode", mode, recorded: false },
      ...plan.practice.map(
        (task) => ({ kind: "task", mode: mode.mode, task, practice: true, recorded: true }) as const,
      ),
      ...tasksOf(plan, participant, position).map(
        (task) => ({ kind: "task", mode: mode.mode, task, practice: false, recorded: true }) as const,
      ),
      ...plan.questionnaires.map(
        (questionnaire) =>
          ({ kind: "questionnaire", mode: mode.mode, questionnaire, recorded: true }) as const,
      ),
    ]),
    ...(plan.comment ? [{ kind: "comment", recorded: true } as const] : []),
    { kind: "thanks", recorded: true },
  ];
}

/** Where a session goes on of which so many steps are recorded: at the first that is not, or what leads to it. */
export function resumeAt(steps: readonly Step[], recorded: number): number {
  let left = recorded;
  for (let i = 0; i < steps.length; ++i) {
    if (steps[i]!.recorded && left-- === 0) {
      const leads = ["welcome", "mode", "pause"].includes(steps[i - 1]?.kind ?? "");
      return leads ? i - 1 : i;
    }
  }
  return steps.length - 1;
}
