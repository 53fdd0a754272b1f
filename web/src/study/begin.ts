import type { App } from "../app";
import { readSection } from "../model/values";
import { CaseError } from "../sog/zip";
import { englishStudy, type StudyTexts } from "../text/study_en";
import type { Language } from "../text/text";
import { download } from "../ui/download";
import { offeredSurroundings } from "../xr/headset";
import { StudyGuide } from "./guide";
import { fetchPlan } from "./journal";
import { parsePlan, type Plan } from "./plan";
import { Study } from "./study";

/** So often it is looked whether the section is there, ms. */
const kLookMs = 50;

/** The plan that an address names, of those that the server has. Rejects with CaseError. */
export async function loadPlan(name: string): Promise<Plan> {
  return parsePlan(await fetchPlan(name), name);
}

/** What is said in a study in this language. */
async function wordsOf(language: Language): Promise<StudyTexts> {
  return language === "de" ? (await import("../text/study_de")).germanStudy : englishStudy;
}

/** Throws CaseError where a plan's targets are not in the case that is shown. */
function requireTargets(plan: Plan, app: App): void {
  const { section } = app.viewer;
  if (!section) {
    throw new CaseError(
      `${plan.case}: has no section, so nothing can be marked in it; build it without --no-section`,
    );
  }
  for (const { name, target } of [...plan.practice, ...plan.tasks]) {
    if (target.points.some((point) => readSection(section, point) === null)) {
      throw new CaseError(
        `${plan.name}: the target of "${name}" is not in ${plan.case}; is it the plan's case?`,
      );
    }
  }
}

/** Begins a study in an app that shows its case. Rejects with CaseError. */
export async function beginStudy(plan: Plan, app: App): Promise<void> {
  const { viewer, headset } = app;
  while (viewer.openCase?.awaitsSection) {
    await new Promise((resolve) => setTimeout(resolve, kLookMs));
  }
  requireTargets(plan, app);
  const offered = (await offeredSurroundings()).includes("immersive-vr");
  const study = new Study(plan, await wordsOf(plan.language), {
    viewer,
    actions: app.actions,
    store: localStorage,
    headset: {
      offered,
      get worn() {
        return headset.worn;
      },
      enter: () => void app.enterHeadset("immersive-vr"),
      leave: () => queueMicrotask(() => void headset.leave()), // not while a press there is still told of
    },
    displayHz: () => headset.frameRate,
    save: (name, text) => download(new Blob([text], { type: "application/jsonl" }), name),
  });
  app.lead(new StudyGuide(study, app));
}
