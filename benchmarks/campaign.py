"""How far apart oracle and blind are on each map, and what a decision costs.

    python benchmarks/campaign.py [--map city field] [--flights 50] [--jobs 2] [--out DIR] [--again]

Flies the same missions with both pilots at 256x144 and prints, for each map, collision rates with their intervals,
decisions a second of the oracle, and where its time goes. `--again` flies everything a second time with one worker
and compares what was written, byte by byte. DIR is kept and resumed; without it a temporary one is used.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections import defaultdict
from pathlib import Path

from frames import machine

from scenegen.maps.registry import MAPS
from scenegen_datasets.resolve import Source
from scenegen_trainers.campaign.recipe import resolve_flights
from scenegen_trainers.campaign.results import gather, write
from scenegen_trainers.campaign.run import Campaign, Progress, run
from scenegen_trainers.campaign.store import BASE_POINT
from scenegen_trainers.pilots.spec import parse_pilot

WORLD = ("build", "load", "airspace", "plan", "expose", "heat classes", "missions", "pilot setup")
"""Stages that are paid once per world or batch, not per decision."""


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", nargs="+", default=list(MAPS), choices=list(MAPS))
    parser.add_argument("--flights", type=int, default=50)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--again", action="store_true")
    asked = parser.parse_args()
    print(machine())
    with tempfile.TemporaryDirectory() as scratch:
        for name in asked.map:
            root = (asked.out or Path(scratch)) / name
            measure(campaign(name, asked.flights, root, asked.jobs))
            if asked.again:
                print("  " + compare(root, campaign(name, asked.flights, Path(scratch) / f"{name}-again", 1)))


def campaign(name: str, flights: int, root: Path, jobs: int) -> Campaign:
    recipe = resolve_flights([Source("", {"map": name, "camera": {"width_px": 256, "height_px": 144}})])
    pilots = tuple(parse_pilot(word, "waypoint") for word in ("oracle", "blind"))
    return Campaign(recipe, {BASE_POINT: recipe}, pilots, flights, root, jobs)


def measure(asked: Campaign) -> None:
    root = asked.root
    root.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter()
    failed = run(asked, _quiet)
    wall_s = time.perf_counter() - began
    results = gather(asked)
    write(asked, results)
    rates = ", ".join(
        f"{line.pilot} {100 * line.collision.share:.2f} % "
        f"({100 * line.collision.low:.1f}-{100 * line.collision.high:.1f})"
        for line in results.lines
    )
    print(f"{root.name}: {asked.flights} flights each, collisions: {rates}; {len(failed)} batches failed")
    batches = [json.loads(text) for text in (root / "run.log.jsonl").read_text("utf-8").splitlines()]
    oracle = [event for event in batches if event["event"] == "batch" and "/oracle" in event["batch"]]
    decisions = sum(event["decisions"] for event in oracle)
    cpu: dict[str, float] = defaultdict(float)
    for event in oracle:
        for stage, (_, seconds) in event["stages"].items():
            cpu[stage] += seconds
    flying = {stage: seconds for stage, seconds in cpu.items() if stage not in WORLD}
    rate, whole = decisions / sum(flying.values()), decisions / sum(cpu.values())
    shares = ", ".join(f"{stage} {1e3 * s / decisions:.2f}" for stage, s in flying.items())
    print(
        f"  oracle: {decisions} decisions, {rate:.0f} per CPU second in the air, {whole:.0f} with worlds and missions"
    )
    print(
        f"  so on two cores {2 * whole:.0f} a second; CPU ms a decision: {shares}; this run {wall_s:.0f} s (wall)"
    )


def compare(root: Path, other: Campaign) -> str:
    """Whether another run wrote the same flights."""
    other.root.mkdir()
    run(other, _quiet)
    write(other, gather(other))
    names = sorted(p.relative_to(other.root) for p in other.root.glob("flights/**/*.json"))
    names += [Path("flights.csv"), Path("results.json")]
    differ = [str(name) for name in names if (root / name).read_bytes() != (other.root / name).read_bytes()]
    return (
        f"flown again by one worker: {len(names) - len(differ)} of {len(names)} files identical {differ[:3]}"
    )


def _quiet(progress: Progress) -> None:
    return None


if __name__ == "__main__":
    main()
