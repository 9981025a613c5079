"""Memory of a worker that renders the same world ten times, torn down in between.

    python benchmarks/memory.py [--rounds 10] [--frames 8] [more recipe flags, such as --city.extent-m 400]

Bars: peak at most 1.5 GiB; what is left after releasing world k (k >= 2) stays within 2 %.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from scenegen_cli.parse import split_recipe_flags
from scenegen_datasets.plan import plan
from scenegen_datasets.recipe import Recipe, resolve_recipe
from scenegen_datasets.resolve import Source, leaves
from scenegen_datasets.studio import Studio, memory_MiB
from scenegen_datasets.workers import ENVIRONMENT

PEAK_MIB, DRIFT = 1536, 0.02


def as_a_worker() -> None:
    """Start over with a worker's environment: the allocator reads it only once."""
    if any(os.environ.get(name) != value for name, value in ENVIRONMENT.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ENVIRONMENT})


def main() -> None:
    as_a_worker()
    own, flags = split_recipe_flags(sys.argv[1:], [key for key, _, _ in leaves(Recipe)])
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--frames", type=int, default=8)
    options = parser.parse_args(own)
    recipe = resolve_recipe([Source("", {**flags, "clips_per_world": 1, "pairs_per_clip": options.frames})])
    (job,) = plan(recipe.map, 1, options.frames, 1)
    left = []
    with tempfile.TemporaryDirectory() as scratch:
        studio = Studio(recipe, Path(scratch), "benchmark")
        for turn in range(options.rounds):
            studio.make(replace(job, ordinal=turn), lambda _: None)
            studio.leave()
            left.append(memory_MiB()["now"])
            print(f"world {turn + 1:2d}: {left[-1]} MiB left, peak {memory_MiB()['peak']} MiB", flush=True)
    later = left[1:]
    drift = (max(later) - min(later)) / min(later)
    peak = memory_MiB()["peak"]
    print(f"peak {peak} MiB (bar {PEAK_MIB}); left after release varies by {100 * drift:.1f} % (bar 2 %)")
    sys.exit(int(peak > PEAK_MIB or drift > DRIFT))


if __name__ == "__main__":
    main()
