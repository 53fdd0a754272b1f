#!/usr/bin/env python3
"""Makes the synthetic data that the analysis of studies is tried with; nobody ever answered these questions.

    python3 bench/synthetic_study.py            writes presets/study/synthetic-paper.csv and synthetic-items.csv
    python3 bench/synthetic_study.py --check    only says whether they are what it would write

ClipGS-VR (arXiv 2601.19310) reports, of ten participants, SUS 71.80 ± 14.41 (uniaxial) and 88.20 ± 9.35 (arbitrary),
t(9) = -2.988, p = .015, and efficiency 3.40 ± .70 and 4.70 ± .48, Z = -2.739, p = .006. The first file has scores of
which these are the statistics, to the printed digits. Those of ten complete questionnaires they cannot be: their sum
would be a multiple of 2.5, and 718 and 882 are none (clipgs study --check 71.80,10,2.5). The second file has answers
to the ten items, and comes as near as ten questionnaires can.

Both are found by hill climbing from a fixed seed, in whole steps of a score; the same files come out everywhere.
"""

import math
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "presets" / "study"
MODES = ("uniaxial", "arbitrary")
PARTICIPANTS = 10

# What the paper prints.
SD = (14.41, 9.35)
T = -2.988
# 3.40 ± .70 and 4.70 ± .48: one difference of 0, five of 1, four of 2, none the other way: W = 0, Z = -2.739.
EFFICIENCY = [(2, 4), (3, 4), (3, 5), (3, 5), (3, 5), (4, 4), (4, 5), (4, 5), (4, 5), (4, 5)]


class Draws:
    """Numbers by chance, the same with every version of Python (Numerical Recipes' generator)."""

    def __init__(self, seed):
        self.state = seed

    def below(self, n):
        self.state = (self.state * 1664525 + 1013904223) % 2**32
        return (self.state >> 8) * n >> 24

    def shuffled(self, items):
        items = list(items)
        for i in range(len(items) - 1, 0, -1):
            j = self.below(i + 1)
            items[i], items[j] = items[j], items[i]
        return items


def mean(values):
    return sum(values) / len(values)


def sd(values):
    middle = mean(values)
    return math.sqrt(sum((value - middle) ** 2 for value in values) / (len(values) - 1))


def paired_t(first, second):
    differences = [a - b for a, b in zip(first, second)]
    return mean(differences) * math.sqrt(len(differences)) / sd(differences)


def distance(scores):
    """How far SDs and t are from the paper's."""
    return abs(sd(scores[0]) - SD[0]) + abs(sd(scores[1]) - SD[1]) + abs(paired_t(*scores) - T)


def find_scores(draws, step, sums, longest, steps):
    """Scores of both modes, multiples of `step` from 30 to 100 with these sums, as near to the paper as `steps` moves
    of up to `longest` steps from one participant to another, and exchanges, bring them."""
    scores = []
    for total, spread in zip(sums, (3, 2)):
        # Evenly spread around the mean, in whole steps, the rest given to the first.
        middle = round(total / PARTICIPANTS / step)
        counts = [middle + round(spread * (i - 4.5) * 2.5 / step) // 2 for i in range(PARTICIPANTS)]
        counts[0] += round(total / step) - sum(counts)
        scores.append(draws.shuffled(counts))

    def values(counts):
        return [[count * step for count in mode] for mode in counts]

    nearest = distance(values(scores))
    for _ in range(steps):
        before = [list(mode) for mode in scores]
        mode = scores[draws.below(2)]
        one, other = draws.below(PARTICIPANTS), draws.below(PARTICIPANTS)
        if draws.below(3) == 0:  # of another participant: t changes, and nothing else
            mode[one], mode[other] = mode[other], mode[one]
        else:
            moved = 1 + draws.below(longest)
            mode[one] -= moved
            mode[other] += moved
        now = distance(values(scores))
        if now <= nearest and min(mode) * step >= 30 and max(mode) * step <= 100:
            nearest = now
        else:
            scores = before
    return values(scores)


def answers_of(draws, score):
    """Ten answers with this SUS score, alike but not the same."""
    gains = [0] * 10
    for _ in range(round(score / 2.5)):
        least = min(gains)
        open_items = [i for i in range(10) if gains[i] <= least + 1 and gains[i] < 4]
        gains[open_items[draws.below(len(open_items))]] += 1
    return [gain + 1 if i % 2 == 0 else 5 - gain for i, gain in enumerate(gains)]


def figures(scores):
    return "SUS {:.2f} ± {:.2f} and {:.2f} ± {:.2f}, t(9) = {:.3f}".format(
        mean(scores[0]), sd(scores[0]), mean(scores[1]), sd(scores[1]), paired_t(*scores))


def table(comments, header, rows):
    return "".join(f"# {line}\n" for line in comments) + ",".join(header) + "\n" + "".join(
        ",".join(str(cell) for cell in row) + "\n" for row in rows)


def paper_table():
    draws = Draws(8)
    scores = find_scores(draws, 0.1, (718, 882), 40, 40000)
    efficiency = draws.shuffled(EFFICIENCY)
    rows = [(participant + 1, MODES[mode], f"{scores[mode][participant]:.1f}", efficiency[participant][mode])
            for participant in range(PARTICIPANTS) for mode in (0, 1)]
    return table(
        ["SYNTHETIC: made by bench/synthetic_study.py; nobody answered these questions.",
         "Its statistics are those that ClipGS-VR (arXiv 2601.19310) prints, of ten participants:",
         f"{figures(scores)}; efficiency 3.40 ± .70 and 4.70 ± .48, Z = -2.739.",
         "SUS is given as scores in steps of 0.1: ten complete questionnaires cannot have these means, for their sums",
         "718 and 882 are no multiples of 2.5 (clipgs study --check 71.80,10,2.5). See synthetic-items.csv."],
        ["participant", "mode", "sus", "efficiency"], rows)


def items_table():
    draws = Draws(8)
    scores = find_scores(draws, 2.5, (717.5, 882.5), 3, 40000)
    efficiency = draws.shuffled(EFFICIENCY)
    rows = [(participant + 1, MODES[mode], *answers_of(draws, scores[mode][participant]), efficiency[participant][mode])
            for participant in range(PARTICIPANTS) for mode in (0, 1)]
    return table(
        ["SYNTHETIC: made by bench/synthetic_study.py; nobody answered these questions.",
         "As near to what ClipGS-VR (arXiv 2601.19310) prints as ten complete questionnaires come, whose SUS sums are",
         "multiples of 2.5:",
         f"{figures(scores)}",
         "in place of SUS 71.80 ± 14.41 and 88.20 ± 9.35, t(9) = -2.988; efficiency as there."],
        ["participant", "mode", *(f"q{i}" for i in range(1, 11)), "efficiency"], rows)


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    for name, text in (("synthetic-paper.csv", paper_table()), ("synthetic-items.csv", items_table())):
        path = FOLDER / name
        if not sys.argv[1:]:
            path.write_text(text, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != text:
            sys.exit(f"synthetic_study: {path} is not what this script writes; run it without --check")


if __name__ == "__main__":
    main()
