#!/usr/bin/env python3
"""Runs one step of one case and writes down what became of it: `step.py NAME STEP DONE -- COMMAND`.

Standard error and output go to NAME.clipgs-work/batch/STEP.log; of `needs`, output goes to DONE.
Ends with the command's status, and with one line on standard error if that is not 0. DONE is made
if it is.
"""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import FrameType

from clipgs_batch import records

PR_SET_PDEATHSIG = 1


def die_with_parent(signal_number: int) -> None:
    """A killed scheduler must leave no step behind that holds the case's work folder."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal_number)


def last_line(log: Path, begin: int) -> str:
    """What the program said last, its own error before others' words."""
    with log.open("rb") as file:
        file.seek(begin)
        lines = [line.strip() for line in file.read().decode(errors="replace").splitlines()]
    lines = [line for line in lines if line and not line.startswith("Run with --help")]
    own = [line for line in lines if line.startswith("clipgs: ")]
    return (own or lines or ["it said nothing"])[-1][:1000]


def end_of(status: int, log: Path, begin: int) -> str:
    if status >= 0:
        return last_line(log, begin)
    name = signal.Signals(-status).name
    hint = ", perhaps for want of memory" if -status == signal.SIGKILL else ""
    return f"was ended by {name}{hint}"


def run(command: list[str], log: Path, out: Path | None) -> int:
    """The command's status; −N if signal N ended it. Signals to end are passed on."""
    with log.open("ab") as errors, out.open("wb") if out else open(os.devnull, "wb") as output:
        child = subprocess.Popen(
            command,
            stdout=output if out else errors,
            stderr=errors,
            preexec_fn=lambda: die_with_parent(signal.SIGKILL),
        )

        def pass_on(number: int, _frame: FrameType | None) -> None:
            child.send_signal(number)

        signal.signal(signal.SIGTERM, pass_on)
        signal.signal(signal.SIGINT, pass_on)
        return child.wait()


def main(arguments: list[str]) -> int:
    name, step, done = arguments[:3]
    command = arguments[4:]
    die_with_parent(signal.SIGTERM)
    folder = records.folder_of(Path.cwd(), name)
    folder.mkdir(parents=True, exist_ok=True)
    Path("overview").mkdir(exist_ok=True)
    log = folder / f"{step}.log"
    before = records.read_record(folder, step)
    unfinished = before.get("status") != records.DONE
    record: records.Record = {
        "status": records.RUNNING,
        "attempts": 1 + (before.get("attempts", 0) if unfinished else 0),
        "seconds": before.get("seconds", 0) if unfinished else 0,
        "began": records.now(),
    }
    records.write_record(folder, step, record)
    if record["attempts"] == 1:
        log.unlink(missing_ok=True)
    begin = log.stat().st_size if log.exists() else 0
    start = time.monotonic()
    partial = Path(f"{done}.part") if step == "needs" else None
    status = run(command, log, partial)
    record["seconds"] += round(time.monotonic() - start, 2)
    record["peak_mb"] = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1000
    if status == 0:
        if partial:
            os.replace(partial, done)
        else:  # of another text each time: Snakemake takes files of the same bytes for unchanged
            Path(done).write_text(f"{time.time_ns()}\n")
        records.write_record(folder, step, {**record, "status": records.DONE})
        return 0
    why = end_of(status, log, begin)
    records.write_record(folder, step, {**record, "status": records.FAILED, "last_line": why})
    print(f"{name}: {step}: {why}", file=sys.stderr)
    return status if status > 0 else 128 - status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
