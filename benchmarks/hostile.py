"""Give hundreds of hostile datasets to everything that reads one, and count what becomes of them.

    python benchmarks/hostile.py DIR [--mutants 300] [--seed 0] [--log FILE]

DIR is a sound dataset of a few clips (`scenegen render --size 64x64 --pairs 16` with four clips a world is plenty).
Each mutant is drawn from its own seed, so that ``--seed S --mutants 1`` repeats one. With `--log`, what was found is
kept there line by line, and the same command goes on where it was stopped. Exits with 1 if a reader raised anything
but a refusal, hung, ran out of its memory or time, died, printed what no terminal should get, or touched anything
outside the dataset.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
from hostile.campaign import Campaign, Read
from hostile.mutants import MUTANTS
from hostile.readers import READERS

TELL_EVERY_S = 20.0


def known(log: Path | None) -> dict[int, Read]:
    """Mutants that were read already; a torn last line counts for nothing."""
    found: dict[int, Read] = {}
    if log is not None and log.exists():
        for line in log.read_text("utf-8").split("\n")[:-1]:
            read = Read(**json.loads(line))
            found[read.seed] = read
    return found


def summary(reads: Iterable[Read]) -> str:
    """Reader by reader, and kind by kind, what became of the mutants."""
    by_reader: dict[str, Counter[str]] = {}
    for read in reads:
        for name, what in read.found.items():
            by_reader.setdefault(name, Counter())[what.partition(":")[0]] += 1
    lines = [f"{'reader':16s} {'read':>6s} {'refused':>8s} {'wrong':>6s}"]
    for name, counts in sorted(by_reader.items()):
        lines.append(f"{name:16s} {counts['sound']:6d} {counts['refused']:8d} {counts['WRONG']:6d}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--mutants", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", choices=sorted(MUTANTS), help="this kind alone")
    parser.add_argument(
        "--readers",
        nargs="+",
        choices=READERS,
        default=[],
        help="these alone, whether or not it is their turn",
    )
    parser.add_argument("--log", type=Path)
    options = parser.parse_args()
    wanted = range(options.seed, options.seed + options.mutants)
    done = {seed: read for seed, read in known(options.log).items() if seed in wanted}
    told = 0.0
    with tempfile.TemporaryDirectory() as folder, Campaign(options.dataset, Path(folder)) as campaign:
        for seed in wanted:
            if seed in done:
                continue
            read = done[seed] = campaign.read(seed, options.kind, tuple(options.readers))
            for reader, what in read.wrong.items():
                print(f"seed {seed}, {read.kind}, {reader}: {what}", flush=True)
            if options.log is not None:
                with options.log.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(asdict(read)) + "\n")
            if time.monotonic() - told > TELL_EVERY_S:
                told = time.monotonic()
                print(f"{len(done)} of {len(wanted)} mutants, {read.peak_MiB} MiB", file=sys.stderr)
    wrong = sum(len(read.wrong) for read in done.values())
    peak = max((read.peak_MiB for read in done.values()), default=0)
    print(summary(done.values()))
    readings = sum(len(read.found) for read in done.values())
    print(f"{len(done)} mutants, {readings} readings, {wrong} wrong; peak memory of the reader {peak} MiB")
    sys.exit(int(wrong > 0))


if __name__ == "__main__":
    main()
