#!/usr/bin/env python3
"""Gives a job of Snakemake's to Slurm, and says its number: `submit.py JOBSCRIPT`.

The job is called CASE.STEP, so that what became of it can be written down if it cannot do that
itself. One that the cluster refuses, for more memory than any node has, fails in one line, and the
rest goes on.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from clipgs_batch import records  # noqa: E402

MARK = "# properties = "


def properties_of(jobscript: Path) -> dict[str, Any]:
    for line in jobscript.read_text(encoding="utf-8").splitlines():
        if line.startswith(MARK):
            properties: dict[str, Any] = json.loads(line[len(MARK) :])
            return properties
    raise SystemExit(f"{jobscript}: is no job of Snakemake's")


def sbatch_words(name: str, folder: Path, job: dict[str, Any]) -> list[str]:
    resources = job["resources"]
    words = ["--parsable", f"--job-name={name}", f"--cpus-per-task={job['threads']}"]
    words += [f"--mem={resources['mem_mb']}M", f"--time={resources['minutes']}"]
    words += [f"--output={folder}/slurm.log", "--open-mode=append"]
    for option in ("partition", "account"):
        if f"slurm_{option}" in resources:
            words.append(f"--{option}={resources[f'slurm_{option}']}")
    return words


def main(jobscript: str) -> int:
    job = properties_of(Path(jobscript))
    case, step = job["wildcards"]["case"], job["rule"]
    folder = records.folder_of(Path.cwd(), case)
    folder.mkdir(parents=True, exist_ok=True)
    words = sbatch_words(f"{case}.{step}", folder, job)
    submitted = subprocess.run(
        ["sbatch", *words, jobscript], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    if submitted.returncode == 0:
        print(submitted.stdout.strip().split(";")[0])
        return 0
    said = (submitted.stderr.strip().splitlines() or ["it said nothing"])[-1]
    asked = f"{job['resources']['mem_mb']} MB, {job['threads']} threads"
    why = f"Slurm refuses a job of {asked}: {said.removeprefix('sbatch: ').removeprefix('error: ')}"
    records.record_failure(folder, step, why)
    print(f"{case}: {step}: {why}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[-1]))
