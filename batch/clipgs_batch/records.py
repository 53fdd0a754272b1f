"""What became of each step of each case, a small JSON file a step, written whole or not at all.

They lie in NAME.clipgs-work/batch/STEP.json beside STEP.log, and `clipgs overview` reads them.
"""

from __future__ import annotations

import json
import os
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from clipgs_batch.options import STEPS, work_of

Record = dict[str, Any]
DONE, FAILED, RUNNING = "done", "failed", "running"


def folder_of(out: Path, name: str) -> Path:
    return out / work_of(name) / "batch"


def now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="seconds")


def read_record(folder: Path, step: str) -> Record:
    """Empty if there is none that can be read."""
    try:
        record = json.loads((folder / f"{step}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return record if isinstance(record, dict) else {}


def write_json(path: Path, value: object) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f"{path.name}.{os.getpid()}.part")
    beside.write_text(json.dumps(value, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    os.replace(beside, path)


def write_record(folder: Path, step: str, record: Record) -> None:
    write_json(folder / f"{step}.json", {"step": step, **record})


def record_failure(folder: Path, step: str, why: str) -> None:
    """For steps that ended without a word of their own, or never began."""
    known = {"began": now(), **read_record(folder, step)}
    write_record(folder, step, {**known, "status": FAILED, "last_line": why})


def end_running(out: Path, names: list[str]) -> None:
    """When nothing runs any more: what says that it does was killed."""
    for name in names:
        folder = folder_of(out, name)
        for step in STEPS:
            if read_record(folder, step).get("status") == RUNNING:
                why = "was ended from outside: killed, or out of memory or of time"
                record_failure(folder, step, why)
