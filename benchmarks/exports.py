"""Export real pairs to every format, read them back as their consumers do, and print the largest errors.

    python benchmarks/exports.py DATASET WORK [--split val --split test] [--to kitti ...]

Every pair of the chosen splits is compared with the dataset; a value beyond the documented loss ends the run. Prints
frames, processor time and bytes per frame of the export, and the largest error of each kind. Each export is removed
before the next one is made.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
import time
from pathlib import Path

os.environ["HF_DATASETS_DISABLE_PROGRESS_BARS"] = "1"
sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import numpy as np

from consumers import CONSUMERS, check
from scenegen_datasets.exports.engine import export
from scenegen_datasets.exports.plan import Request
from scenegen_datasets.job import SPLITS


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("work", type=Path)
    parser.add_argument("--split", action="append", choices=SPLITS)
    parser.add_argument("--to", action="append", choices=list(CONSUMERS))
    arguments = parser.parse_args()
    splits = tuple(arguments.split or SPLITS)
    print(
        f"python {platform.python_version()}, numpy {np.__version__}, {arguments.dataset.name}, {' '.join(splits)}"
    )
    print(f"{'format':12}{'compared':>9}{'CPU ms/frame':>14}{'kB/frame':>10}  largest errors")
    for name in arguments.to or CONSUMERS:
        root = arguments.work / name
        if root.exists():
            sys.exit(f"{root} is there already and would not be timed; remove it or give another WORK")
        began = time.process_time()
        outcome = export(Request(arguments.dataset, root, name, splits=splits))
        spent = time.process_time() - began
        compared, errors = check(name, root, arguments.dataset, splits)
        worst = ", ".join(f"{what} {error:.3g}" for what, error in errors.items() if error)
        print(
            f"{name:12}{compared:>9,}{1e3 * spent / outcome.frames:>14.1f}"
            f"{1e-3 * outcome.bytes / outcome.frames:>10,.0f}  {worst or 'none'}",
            flush=True,
        )
        shutil.rmtree(root)
        shutil.rmtree(arguments.work / "hf-cache", ignore_errors=True)


if __name__ == "__main__":
    main()
