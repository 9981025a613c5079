"""What verifying a dataset costs, and what 8,000 pairs of its size come to on two cores.

    python benchmarks/verify.py DIR [DIR ...] [--jobs 1]

CPU time of all processes; the wall time of a quiet machine is that over the number of cores. Run it twice: the first
run also fetches the files from the disk.
"""

from __future__ import annotations

import argparse
import os
import time
from pathlib import Path

import frames as source

from scenegen_datasets.codecs import single_threaded
from scenegen_datasets.description import read_description
from scenegen_datasets.store import DATASET
from scenegen_datasets.verify import verify

PAIRS, CORES = 8000, 2


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("datasets", type=Path, nargs="+")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    print(source.machine())
    single_threaded()
    print(
        f"{'dataset':24s} {'size':>9s} {'pairs':>6s}  CPU ms a pair   {PAIRS:,} pairs on {CORES} cores   findings"
    )
    for root in options.datasets:
        told = read_description(root / DATASET)
        pairs, grid = told["counts"]["pairs"], told["grid"]
        before = os.times()
        began = time.perf_counter()
        report = verify(root, options.jobs)
        wall = time.perf_counter() - began
        after = os.times()
        cpu = sum(b - a for a, b in zip(before[:4], after[:4], strict=True))
        each = cpu / pairs
        size = f"{grid['width_px']}x{grid['height_px']}"
        print(
            f"{root.name:24s} {size:>9s} {pairs:6d}  {each * 1e3:13.1f}   {each * PAIRS / CORES:22.0f} s   "
            f"{len(report.findings)}  (wall {wall:.1f} s)"
        )


if __name__ == "__main__":
    main()
