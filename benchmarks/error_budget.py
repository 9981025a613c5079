"""Where a network's squared error sits: ground taken for sky, scale of the whole image, and the rest.

    python benchmarks/error_budget.py DATASET MODEL.pt [MODEL.pt ...] [--split test]

Beside the networks stands the mean depth of each image row, which looks at no image. "Taken for sky" are pixels nearer
than 50 m that are answered with more than 80 m. The spread of scale is the standard deviation over images of the
logarithm of median estimate over median truth; 0.3 means that sizes are a third off, one image with another.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import torch

from scenegen_datasets.loader import PairDataset
from scenegen_trainers.evaluation.answers import answers
from scenegen_trainers.evaluation.baselines import fit_baselines
from scenegen_trainers.models.checkpoint import read_checkpoint
from scenegen_trainers.training.samples import Samples

NEAR_M, FAR_M, CAP_M, NEAREST_M = 50.0, 80.0, 100.0, 0.5

HEAD = (
    "answer",
    "RMSE [m]",
    "taken for sky",
    "their share of the squared error",
    "RMSE without them [m]",
    "sky beyond 80 m",
    "spread of scale",
)


def budget(pairs: Iterable[tuple[np.ndarray, np.ndarray]]) -> list[str]:
    """Cells of a row, of (estimate, truth) image by image [m]."""
    squares, errors, skies, scales = [], [], [], []
    for estimate, truth in pairs:
        judged = (truth >= NEAREST_M) & (truth < CAP_M)
        given, true = estimate[judged], truth[judged]
        squares.append((given - true) ** 2)
        errors.append((given > FAR_M) & (true < NEAR_M))
        skies.append(estimate[np.isinf(truth)] > FAR_M)
        if len(true):
            scales.append(float(np.log(np.median(given) / np.median(true))))
    square, wrong, sky = (np.concatenate(parts) for parts in (squares, errors, skies))
    return [
        f"{np.sqrt(square.mean()):.2f}",
        f"{wrong.mean():.1%}",
        f"{square[wrong].sum() / square.sum():.0%}",
        f"{np.sqrt(square[~wrong].mean()):.2f}",
        f"{sky.mean():.0%}" if len(sky) else "",
        f"{np.std(scales):.2f}",
    ]


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("dataset")
    parser.add_argument("models", nargs="+")
    parser.add_argument("--split", default="test")
    options = parser.parse_args()
    root = Path(options.dataset)
    torch.set_num_threads(1)
    print("\n".join(f"| {' | '.join(cells)} |" for cells in (HEAD, ["---"] * len(HEAD))))
    for path in map(Path, options.models):
        network = read_checkpoint(path).network
        asked = answers(network.metres, Samples(root, options.split, network.inputs))
        name = path.parent.name
        print(f"| {name} | {' | '.join(budget((a.estimate_m, a.truth_m) for a in asked))} |", flush=True)
    trivial = fit_baselines(PairDataset(root, "train", ("depth",)), CAP_M)
    truths = [sample["depth"] for sample in PairDataset(root, options.split, ("depth",))]
    for name, answer in trivial.answers(truths[0].shape).items():
        print(f"| {name}, no image | {' | '.join(budget((answer, truth) for truth in truths))} |")


if __name__ == "__main__":
    main()
