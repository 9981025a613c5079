"""Where the time of a job goes: reads the run log of a dataset, or makes one first.

    python benchmarks/job.py DATASET                 break an existing job down
    python benchmarks/job.py DATASET --pairs 8000    make it first, timed from start to verified dataset

World stages (build, load, expose, ...) are spread over all frames of the job; the rest is per frame or per clip anyway.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

WORLD = ("build", "load", "expose", "heat classes", "airspace")
CLIP = ("weather", "fly", "look closer", "solve", "bake", "light", "commit")
FRAME = ("trace", "sense", "encode", "write")


def clips_of(dataset: Path) -> list[dict]:
    lines = (dataset / "run.log.jsonl").read_text(encoding="utf-8").splitlines()
    return [event for event in map(json.loads, lines) if event["event"] == "clip"]


def totals(clips: list[dict]) -> dict[str, tuple[float, float]]:
    """Wall and CPU seconds of each stage, added up over workers."""
    spent: defaultdict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])
    for clip in clips:
        for stage, (wall, cpu) in clip["stages"].items():
            spent[stage][0] += wall
            spent[stage][1] += cpu
    return {stage: (wall, cpu) for stage, (wall, cpu) in spent.items()}


def report(dataset: Path) -> None:
    clips = clips_of(dataset)
    if not clips:
        sys.exit(f"{dataset}/run.log.jsonl tells of no clip")
    lock = json.loads((dataset / "recipe.lock.json").read_text(encoding="utf-8"))
    frames = len(clips) * (lock["recipe"]["pairs_per_clip"] + 1)
    spent = totals(clips)
    exposed = sum("expose" in clip["stages"] for clip in clips)
    print(f"{frames} frames in {len(clips)} clips; {exposed} worlds exposed\n")
    print(f"{'stage':<14}{'CPU s':>9}{'wall s':>9}{'CPU ms/frame':>14}{'CPU s each':>12}")
    for group, count in ((WORLD, exposed), (CLIP, len(clips)), (FRAME, frames)):
        for stage in group:
            wall, cpu = spent.get(stage, (0.0, 0.0))
            print(
                f"{stage:<14}{cpu:>9.2f}{wall:>9.2f}{1e3 * cpu / frames:>14.2f}{cpu / max(count, 1):>12.4f}"
            )
    cpu = sum(cpu for _, cpu in spent.values())
    print(f"{'all':<14}{cpu:>9.2f}{sum(w for w, _ in spent.values()):>9.2f}{1e3 * cpu / frames:>14.2f}")
    print(f"\npeak memory of a worker {max(clip['memory'].get('peak', 0) for clip in clips)} MiB")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--pairs", type=int, help="make the dataset first")
    options, more = parser.parse_known_args()
    if options.pairs:
        command = ["render", "--pairs", str(options.pairs), "--out", str(options.dataset), *more]
        began = time.perf_counter()
        subprocess.run([sys.executable, "-m", "scenegen_cli.main", *command], check=True)
        seconds = time.perf_counter() - began
        print(f"start to verified dataset: {seconds:.1f} s, {options.pairs / seconds:.1f} pairs/s\n")
    report(options.dataset)


if __name__ == "__main__":
    main()
