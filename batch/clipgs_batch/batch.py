"""One batch: its cases, its folder and the command lines of its steps."""

from __future__ import annotations

import fcntl
import os
import shlex
import shutil
import sys
from pathlib import Path
from typing import IO, Any

from clipgs_batch import records
from clipgs_batch.needs import Request, request_of
from clipgs_batch.options import PATHS, command_of, work_of
from clipgs_batch.table import Case, TableError, read_table

STEP = Path(__file__).resolve().parent.parent / "step.py"
LOCK = ".clipgs-batch.lock"


class Batch:
    """What the configuration (batch/config.yaml) says. Raises TableError, in one line."""

    def __init__(self, config: dict[str, Any]) -> None:
        if not config.get("cases"):
            raise TableError("config: name the CSV of cases: --config cases=cases.csv out=cases")
        if config["steps"] not in ("whole", "apart"):
            raise TableError(f'config: steps is whole or apart, not "{config["steps"]}"')
        self.apart: bool = config["steps"] == "apart"
        self.threads = int(config["threads"])
        self.out = Path(config["out"]).resolve()
        self._config = config
        self.program = _program(str(config["clipgs"]))
        table = read_table(Path(config["cases"]).resolve(), config.get("options"))
        self.cases: dict[str, Case] = table.cases
        self.refused = table.refused
        self._lock: IO[str] | None = None

    def begin(self) -> None:
        """Once, before anything is built: nobody else builds here, and what was taken away since is
        made again. Raises TableError."""
        self.out.mkdir(parents=True, exist_ok=True)
        self._lock = (self.out / LOCK).open("w", encoding="utf-8")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise TableError(f"{self.out}: another batch works there; wait for it") from None
        for name in self.cases:
            if not (self.out / f"{name}.sog").exists():
                self._forget(name, "build", "pack", "eval")
            if not (self.out / f"{name}.figures").exists():
                self._forget(name, "eval")
        for folder in self.out.glob(work_of("line-*")):  # rows that have been put right since
            if folder.name not in map(work_of, self.refused):
                shutil.rmtree(folder)
        listed = [{"name": name, "last": step} for name, step in self._last_steps()]
        records.write_json(self.out / "batch.json", {"cases": listed})

    def end(self) -> None:
        """When nothing runs any more."""
        records.end_running(self.out, list(self.cases))

    def _forget(self, name: str, *steps: str) -> None:
        """Of what is missing Snakemake makes only what something else that is missing needs."""
        for step in steps:
            (records.folder_of(self.out, name) / f"{step}.done").unlink(missing_ok=True)

    def targets(self) -> list[str]:
        """All that is to be there in the end."""
        return [self.done(name, step) for name, step in self._last_steps()]

    def _last_steps(self) -> list[tuple[str, str]]:
        """Of an instant case nothing is traced that it could be measured by."""
        ends = [(case.name, "build" if case.is_instant else "eval") for case in self.cases.values()]
        return ends + [(name, "check") for name in self.refused]

    def files(self, name: str) -> list[str]:
        """What a case is made of."""
        case = self.cases[name]
        return [case.volume, *(case.options[o] for o in sorted(PATHS) if _is_file(case, o))]

    def done(self, name: str, step: str) -> str:
        """The file that says that a step of a case is done, in the folder of the cases."""
        ending = "needs.out" if step == "needs" else f"{step}.done"
        return f"{work_of(name)}/batch/{ending}"

    def scene(self, name: str) -> str:
        """What is packed: of the papers' way the refined scene."""
        return self.done(name, "refine" if self.cases[name].is_neural else "train")

    def case_file(self, name: str) -> str:
        whole = not self.apart or self.cases[name].is_instant
        return self.done(name, "build" if whole else "pack")

    def command(self, name: str, step: str) -> str:
        """What a step runs, for the shell, without the number of threads, which changes no byte."""
        return shlex.join(command_of(step, self.cases[name], self.apart))

    def shell_line(self) -> str:
        """What runs a step, for Snakemake to fill in."""
        return (
            f"{self.step_line()} {shlex.quote(self.program)} --quiet --threads {{threads}} "
            "{params.command}"
        )

    def step_line(self) -> str:
        """The same of any other command, which follows it."""
        run = shlex.join([sys.executable, str(STEP)])
        return f"exec {run} {{wildcards.case}} {{rule}} {{output}} --"

    def overview_line(self) -> str:
        return shlex.join([self.program, "overview", str(self.out)])

    def why_refused(self, name: str) -> str:
        return shlex.quote(self.refused[name].why)

    def request(self, step: str, name: str, threads: int, attempt: int) -> Request:
        """Raises FileNotFoundError as long as needs are not known."""
        config = self._config
        factors = float(config["memory_factor"]), float(config["time_factor"])
        return request_of(step, self.done(name, "needs"), threads, attempt, *factors)


def _is_file(case: Case, option: str) -> bool:
    return os.path.isabs(case.options.get(option, ""))


def _program(name: str) -> str:
    found = shutil.which(os.path.expanduser(name))
    if found is None:
        raise TableError(f"{name}: there is no such program; say where: --config clipgs=PATH")
    return str(Path(found).absolute())
