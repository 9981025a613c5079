"""What networks make of the things a drone runs into: near, and at flight height or above it.

Scores are means over pixels, most of which show ground. This looks at pixels nearer than 8 m that a level camera sees
less than so many degrees below the horizon, and says how many of them are taken for much too far, or too near.

    python benchmarks/near_things.py DATASET CHECKPOINT [CHECKPOINT ...] [--split test]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from scenegen_datasets.loader import PairDataset
from scenegen_trainers.evaluation.answers import answers
from scenegen_trainers.evaluation.scores import markdown
from scenegen_trainers.models.checkpoint import read_checkpoint
from scenegen_trainers.training.samples import Samples

NEAR_M = 8.0
BELOW_HORIZON_DEG = 7.0
FACTORS = (2.0, 1.5)
"""Estimate over truth from which on it is much too far; the smaller one, upside down, is too near."""
HEAD = (
    "network",
    "pixels",
    "twice too far",
    "1.5 times too far",
    "1.5 times too near",
    "median of estimate / truth",
)


def ratios(checkpoint: Path, dataset: Path, split: str) -> np.ndarray:
    """Estimate over truth of every near pixel at flight height or above."""
    network = read_checkpoint(checkpoint).network
    camera = PairDataset(dataset, split, ("depth",)).intrinsics
    lowest = camera[1, 2] + camera[1, 1] * np.tan(np.radians(BELOW_HORIZON_DEG))
    found = []
    for answer in answers(network.metres, Samples(dataset, split, network.inputs)):
        high = np.arange(len(answer.truth_m))[:, None] + 0.5 < lowest
        near = high & (answer.truth_m < NEAR_M)
        found.append(answer.estimate_m[near] / answer.truth_m[near])
    return np.concatenate(found)


def row(name: str, ratio: np.ndarray) -> list[str]:
    """In words."""
    shares = [(ratio > FACTORS[0]).mean(), (ratio > FACTORS[1]).mean(), (ratio < 1.0 / FACTORS[1]).mean()]
    return [
        name,
        f"{ratio.size:,}",
        *(f"{100.0 * share:.1f} %" for share in shares),
        f"{np.median(ratio):.2f}",
    ]


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("dataset", type=Path)
    parser.add_argument("checkpoints", type=Path, nargs="+")
    parser.add_argument("--split", default="test")
    options = parser.parse_args()
    rows = [row(str(path), ratios(path, options.dataset, options.split)) for path in options.checkpoints]
    print(markdown(HEAD, rows))


if __name__ == "__main__":
    main()
