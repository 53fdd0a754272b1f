import { texts } from "../text/text";
import type { CaseSummary } from "./case_list";

/** A case among those of its volume. */
export interface Look {
  case: CaseSummary;
  /** What tells it from the others. */
  name: string;
}

/** The cases of one volume, or a case alone. */
export interface CaseGroup {
  title: string;
  looks: readonly Look[];
}

function areDistinct(names: readonly string[]): boolean {
  return new Set(names).size === names.length && names.every((name) => name !== "");
}

/** Of a case its title; of several what no two have: what presets are called, else the titles, else names. */
function namesOf(cases: readonly CaseSummary[]): string[] {
  if (cases.length === 1) {
    return [cases[0]!.title];
  }
  const presets = cases.map((one) => one.look?.title ?? "");
  const titles = cases.map((one) => one.title);
  return [presets, titles].find(areDistinct) ?? cases.map((one) => one.name);
}

/** The words that all titles begin with. */
function commonTitle(titles: readonly string[]): string {
  const [first = [], ...others] = titles.map((title) => title.split(/\s+/));
  const differs = first.findIndex((word, i) => others.some((words) => words[i] !== word));
  const common = first.slice(0, differs < 0 ? first.length : differs).join(" ");
  return common.replace(/[\s,;:·(–-]+$/u, "");
}

/** The cases in their order, those of one volume together where the first of them is. */
export function groupCases(cases: readonly CaseSummary[]): CaseGroup[] {
  const groups = new Map<string, CaseSummary[]>();
  for (const one of cases) {
    // What one case's alone is called has a character that no volume has.
    const key = one.look?.volume || `/${one.name}`;
    const members = groups.get(key);
    if (members) {
      members.push(one);
    } else {
      groups.set(key, [one]);
    }
  }
  return [...groups.values()].map((members) => {
    const names = namesOf(members);
    return {
      title: commonTitle(members.map((one) => one.title)) || texts().menu.oneVolume,
      looks: members.map((one, i) => ({ case: one, name: names[i]! })),
    };
  });
}

/** The looks of the volume that the case of this name shows; none where it has no others. */
export function looksOf(cases: readonly CaseSummary[], name: string | null): readonly Look[] {
  const group = groupCases(cases).find(({ looks }) => looks.some((look) => look.case.name === name));
  return group && group.looks.length > 1 ? group.looks : [];
}

/** Of a volume: "3 looks". */
export function countText({ looks }: CaseGroup): string {
  return texts().menu.looks(looks.length);
}
