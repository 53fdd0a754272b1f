#!/usr/bin/env python3
"""Says of a job of Slurm's whether it is running, success or failed: `status.py NUMBER`.

Asks slurmctld, which forgets jobs some minutes after their end, and then the accounts, where there
are any. What Slurm ended is written down for the case: the step had no time to.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from clipgs_batch import records  # noqa: E402

ALIVE = set(
    "PENDING RUNNING CONFIGURING COMPLETING SUSPENDED STOPPED REQUEUED REQUEUE_HOLD REQUEUE_FED "
    "RESIZING SIGNALING SPECIAL_EXIT STAGE_OUT".split()
)
FORGOTTEN = "Invalid job id"


def ask(*words: str) -> tuple[str, str]:
    """Standard output and error; of a program that is not there, nothing."""
    try:
        asked = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except FileNotFoundError:
        return "", ""
    return asked.stdout.strip(), asked.stderr.strip()


def field(job: str, name: str) -> str:
    found = re.search(rf"(?:^|\s){name}=(\S*)", job)
    return found.group(1) if found else ""


def note_end(job: str, state: str) -> None:
    """Of a step that ended without a word of its own."""
    case, _, step = field(job, "JobName").rpartition(".")
    folder = records.folder_of(Path(field(job, "WorkDir")), case)
    if case and folder.is_dir():
        own = records.read_record(folder, step).get("status")
        if own != records.FAILED:
            memory = field(job, "MinMemoryNode") or field(job, "MinMemoryCPU")
            limit = field(job, "TimeLimit")
            why = f"Slurm ended it: {state} (it had {memory} of memory and {limit} of time)"
            records.record_failure(folder, step, why)


def status_of(number: str) -> str:
    job, error = ask("scontrol", "show", "job", "-o", number)
    if not job and FORGOTTEN not in error:
        return "running"  # slurmctld does not answer: it may be back soon
    state = field(job, "JobState")
    if not job:
        told, _ = ask("sacct", "-j", number, "-X", "-n", "-P", "-o", "State")
        state = told.split()[0] if told else "FORGOTTEN"
    if state == "COMPLETED":
        return "success"
    if state in ALIVE:
        return "running"
    if job:
        note_end(job, state)
    return "failed"


if __name__ == "__main__":
    print(status_of(sys.argv[1]))
