import { itemsOf } from "./questionnaires";
import type { Step } from "./schedule";
import type { Button, Screen } from "./screen";
import type { Study } from "./study";

const kMostComment = 4000; // bytes

/** What a study shows now. */
export function screenOf(study: Study): Screen {
  const { plan, journal, step, busy, words } = study;
  const why = journal?.trouble;
  const blank: Screen = {
    key: `${journal?.session ?? ""} ${study.at} ${study.item} ${study.running !== null}`,
    title: plan.title,
    text: [],
    question: null,
    entry: null,
    slides: false,
    aside: false,
    remaining: null,
    buttons: [],
    trouble: why ? words.trouble(why) : null,
  };
  if (busy && why) {
    // For the experimenter, where nothing else helps.
    const copy = { text: words.copy, enabled: !study.headset.worn, press: () => study.saveCopy() };
    return { ...blank, key: "trouble", buttons: [copy] };
  }
  return { ...blank, ...(step ? stepScreen(study, step) : start(study)) };
}

function button(study: Study, text: string, press: () => void): Button {
  return { text, enabled: !study.busy, press };
}

function start(study: Study): Partial<Screen> {
  const { words, refusal, typed, headset } = study;
  return {
    text: [refusal ?? words.forExperimenter],
    entry: { label: words.participant, kind: "number", value: typed, set: (value) => study.type(value) },
    buttons: [
      button(study, words.atDesk, () => void study.begin("desk")),
      ...(headset.offered ? [button(study, words.inHeadset, () => void study.begin("headset"))] : []),
    ],
  };
}

function stepScreen(study: Study, step: Step): Partial<Screen> {
  const { plan, words, headset } = study;
  const goOn = button(study, words.goOn, () => study.advance());
  const atDesk = step.kind === "comment" || step.kind === "thanks";
  if (study.device === "headset" && !headset.worn && !atDesk) {
    return { text: [words.headsetIsOff], buttons: [button(study, words.putOn, () => headset.enter())] };
  }
  switch (step.kind) {
    case "welcome":
      return { text: plan.welcome, buttons: [goOn] };
    case "mode":
      return { title: step.mode.title, text: [step.mode.text], buttons: [goOn] };
    case "pause": {
      const remaining = study.secondsOfRest;
      return {
        title: words.rest,
        text: [words.afterRest],
        remaining,
        buttons: [{ ...goOn, enabled: remaining === 0 }],
      };
    }
    case "task":
      return taskScreen(study, step);
    case "questionnaire":
      return questionScreen(study, step);
    case "comment":
      return commentScreen(study);
    case "thanks":
      return {
        title: words.thanks,
        text: [words.end],
        buttons: [button(study, words.nextParticipant, () => study.takeNext())],
      };
  }
}

function taskScreen(study: Study, step: Extract<Step, { kind: "task" }>): Partial<Screen> {
  const { words } = study;
  const alike = study.steps.filter((one) => one.kind === "task" && one.mode === step.mode && !one.practice);
  const title = step.practice ? words.practice : words.task(alike.indexOf(step) + 1, alike.length);
  const text = [step.task.text];
  if (!study.running) {
    return { title, text, buttons: [button(study, words.start, () => study.startTask(step))] };
  }
  const done = button(study, words.done, () => void study.endTask("done"));
  return {
    title,
    text,
    aside: true,
    slides: true,
    remaining: study.secondsOfTask,
    buttons: [{ ...done, enabled: done.enabled && study.isCut }],
  };
}

function questionScreen(study: Study, step: Extract<Step, { kind: "questionnaire" }>): Partial<Screen> {
  const { words, item: at, answers, busy } = study;
  const items = itemsOf(step.questionnaire, words);
  const isLast = at === items.length - 1;
  const chosen = answers[at] ?? null;
  const onwards = isLast
    ? button(study, words.send, () => study.sendAnswers(step))
    : button(study, words.next, () => study.turnTo(at + 1));
  return {
    title: items.length > 1 ? words.question(at + 1, items.length) : words.oneQuestion,
    question: { ...items[at]!, chosen, enabled: !busy, choose: (value) => study.answer(value) },
    buttons: [
      ...(at > 0 ? [button(study, words.back, () => study.turnTo(at - 1))] : []),
      { ...onwards, enabled: onwards.enabled && chosen !== null },
    ],
  };
}

function commentScreen(study: Study): Partial<Screen> {
  const { words, typed, headset } = study;
  if (headset.worn) {
    return {
      text: [words.headsetIsOn],
      buttons: [button(study, words.takeOff, () => headset.leave())],
    };
  }
  const fits = new TextEncoder().encode(typed).length <= kMostComment;
  const send = button(study, fits ? words.send : words.tooLong, () => study.sendComment());
  return {
    title: words.comment,
    text: [words.commentHint],
    entry: { label: words.commentField, kind: "text", value: typed, set: (value) => study.type(value) },
    buttons: [{ ...send, enabled: send.enabled && fits }],
  };
}
