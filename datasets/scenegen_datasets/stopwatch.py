"""What each stage of the work costs, in wall and CPU seconds. Goes into the run log, never into the data."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field


@dataclass
class Stopwatch:
    """Adds up the time spent under each name.

    Attributes
    ----------
    stages : dict of str to [wall, cpu]
        Seconds.
    """

    stages: dict[str, list[float]] = field(default_factory=dict)

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        """Time the block. CPU time is the whole process's, so a stage's helper threads count."""
        wall, cpu = time.perf_counter(), time.process_time()
        try:
            yield
        finally:
            spent = self.stages.setdefault(stage, [0.0, 0.0])
            spent[0] += time.perf_counter() - wall
            spent[1] += time.process_time() - cpu

    def take(self) -> dict[str, list[float]]:
        """Return what was measured, rounded to 0.1 ms, and start anew."""
        stages = {name: [round(wall, 4), round(cpu, 4)] for name, (wall, cpu) in self.stages.items()}
        self.stages = {}
        return stages
