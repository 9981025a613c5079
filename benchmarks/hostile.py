"""Give hundreds of hostile datasets to everything that reads one, and count what becomes of them.

    python benchmarks/hostile.py DIR [--mutants 300] [--seed 0]

DIR is a sound dataset of a few clips. Each mutant is drawn from its own seed, so that ``--seed S --mutants 1`` repeats
one. Exits with 1 if a reader raised anything but a refusal, hung, ran out of its memory limit, died, or if anything
outside the dataset changed.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
from hostile_campaign import Campaign

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("dataset", type=Path)
parser.add_argument("--mutants", type=int, default=300)
parser.add_argument("--seed", type=int, default=0)


def main() -> None:
    options = parser.parse_args()
    counts: Counter[str] = Counter()
    wrong = 0
    with tempfile.TemporaryDirectory() as folder, Campaign(options.dataset, Path(folder)) as campaign:
        for seed in range(options.seed, options.seed + options.mutants):
            kind, found = campaign.read(seed)
            for reader, what in found.items():
                counts[f"{reader}: {what.partition(':')[0]}"] += 1
                if what.startswith("WRONG"):
                    wrong += 1
                    print(f"seed {seed}, {kind}, {reader}: {what}", flush=True)
        peak = campaign.peak_MiB
    for what, count in sorted(counts.items()):
        print(f"{what:24s} {count}")
    print(f"{options.mutants} mutants, {wrong} wrong, peak memory of the reader {peak} MiB")
    sys.exit(int(wrong > 0))


if __name__ == "__main__":
    main()
