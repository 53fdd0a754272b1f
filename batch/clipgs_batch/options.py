"""What a row may say, and the commands of a build's steps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from clipgs_batch.table import Case

# Options of clipgs build, and which of its steps takes each where they are made apart.
_VOLUME = (
    "series frame gaps hu modality region keep-table deface crop soften-metal bias denoise-volume"
).split()
_LOOK = "preset rig exposure tone gradient-opacity as-scanned labels label-table".split()
_PICTURES = (
    "size train-frames test-frames test-size uncut-frames close-frames cut-views test-noise-db "
    "test-masked-noise-db denoise"
).split()
_LEARNING = "budget sh-degree".split()
OPTIONS: dict[str, tuple[str, ...]] = {
    "quality": ("dataset", "train", "refine"),
    "title": ("pack",),
    "seed": ("dataset", "train", "refine"),
    "model": (),
    **{option: ("dataset",) for option in _VOLUME + _LOOK + _PICTURES},
    **{option: ("train",) for option in _LEARNING},
    "steps": (),
    "section-size": ("dataset", "pack"),
    "no-section": ("dataset",),
    "section-quality": ("pack",),
    "max-mb": ("pack",),
}
FLAGS = {"as-scanned", "keep-table", "deface", "bias", "cut-views", "denoise", "no-section"}
PATHS = {"preset", "rig", "labels", "label-table"}
NOT_OF_INSTANT = {"model", "seed", "steps", *_PICTURES, *_LEARNING}

USUAL_QUALITY = "standard"
SEED_POINTS = 150000  # of clipgs dataset; a build has as many as Gaussians, if those are more
SLAB_DEPTH = "0.08"  # as deep as the neural model's adjustment reaches
STEPS = ("needs", "build", "dataset", "train", "bake", "refine", "pack", "eval")


def work_of(name: str) -> str:
    """The work folder of a case, where clipgs build has it."""
    return f"{name}.clipgs-work"


def command_of(step: str, case: Case, apart: bool) -> list[str]:
    """What clipgs is told for a step of a case, in the folder of the cases. `apart`: the build is
    made of single steps."""
    work = PurePath(work_of(case.name))
    dataset, scene = str(work / "dataset"), str(work / "scene.ply")
    layered, model = str(work / "layered.ply"), str(work / "model.ply")
    output = f"{case.name}.sog"
    if step == "needs":
        return ["build", case.volume, "-o", output, *_of_build(_unpacked(case)), "--needs"]
    if step == "build":
        return ["build", case.volume, "-o", output, *_of_build(case)]
    if step == "dataset":
        return ["dataset", case.volume, "-o", dataset, *_given(step, case), *_of_dataset(case)]
    if step == "train":
        learnt = ["-o", model, "--model", "clipgs", "--no-section"] if case.is_neural else []
        return [
            "train",
            dataset,
            *(learnt or ["-o", scene]),
            *_given(step, case),
            *_steps(step, case),
        ]
    if step == "bake":
        return ["bake", model, "-o", layered, "--slab-depth", SLAB_DEPTH]
    if step == "refine":
        given = [*_given(step, case), *_steps(step, case)]
        return ["refine", layered, "--dataset", dataset, "-o", scene, *given]
    if step == "pack":
        return ["pack", scene, "-o", output, *_given(step, case)]
    if step == "eval":
        beside = [] if not case.is_neural else ["--model", model]
        if case.is_neural and apart:
            beside += ["--with", layered]
        report = ["--json", f"{case.name}.figures", "--report", f"overview/{case.name}.html"]
        return ["eval", output, "--dataset", dataset, "--clip", "exact", *beside, *report]
    raise ValueError(step)


def _words(option: str, value: str) -> list[str]:
    if option in FLAGS:
        return [f"--{option}"] if value == "yes" else []
    # As one word: a title may begin with a dash.
    return [f"--{option}={value}"]


def _unpacked(case: Case) -> Case:
    """Without what changes the last step alone: with other needs all is looked at again."""
    options = {o: value for o, value in case.options.items() if OPTIONS[o] != ("pack",)}
    return replace(case, options=options)


def _of_build(case: Case) -> list[str]:
    left_out = NOT_OF_INSTANT if case.is_instant else set()
    words = []
    for option, value in {"quality": USUAL_QUALITY, **case.options}.items():
        if option not in left_out:
            words += _words(option, value)
    return words


def _given(step: str, case: Case) -> list[str]:
    words = []
    for option, value in {"quality": USUAL_QUALITY, **case.options}.items():
        if step in OPTIONS[option]:
            words += _words(option, value)
    return words


def _of_dataset(case: Case) -> list[str]:
    words = ["--one-sided"] if case.is_neural else []
    budget = case.options.get("budget", "0")
    if budget.isdigit() and int(budget) > SEED_POINTS:
        words += ["--points", budget]
    return words


def _steps(step: str, case: Case) -> list[str]:
    """Of the papers' way the model has half of them, refinement the other half."""
    steps = case.options.get("steps", "")
    if not case.is_neural or not steps.isdigit():
        return [f"--steps={steps}"] if steps else []
    half = int(steps) // 2
    return [f"--steps={max(1, half if step == 'train' else int(steps) - half)}"]
