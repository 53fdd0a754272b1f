"""What a step asks its scheduler for: memory and time, from what `clipgs build --needs` says."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

THREADS_MEASURED = 2  # that the seconds are told for
LEAST_MINUTES = 10
# Of a build in one, and of what --needs does not name, these are the steps.
PARTS = {"build": ("dataset", "train", "refine", "pack"), "bake": ("train",)}


@dataclass(frozen=True)
class Request:
    mem_mb: int
    minutes: int


def request_of(
    step: str, needs_file: str, threads: int, attempt: int, memory_factor: float, time_factor: float
) -> Request:
    """A second attempt gets twice as much. Raises FileNotFoundError."""
    with open(needs_file, encoding="utf-8") as file:
        steps: dict[str, dict[str, float]] = json.load(file)["steps"]
    parts = [step] if step in steps else [part for part in PARTS.get(step, ()) if part in steps]
    memory = max(steps[part]["memory_mb"] for part in parts)
    seconds = sum(steps[part]["seconds"] for part in parts)
    speed = max(1, threads) / THREADS_MEASURED
    minutes = math.ceil(time_factor * seconds / speed / 60)
    return Request(
        mem_mb=math.ceil(memory_factor * memory) * attempt,
        minutes=max(LEAST_MINUTES, minutes) * attempt,
    )
