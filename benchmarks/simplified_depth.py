"""How well the simplified depth image S ranks what is near: rank correlation of S with 1 / depth, by flow and gain.

The paper's method stands on S. Where the correlation is near 0, S tells a network nothing; below 0, it misleads.
Judged at the pixels Eq. (1) embeds, below 100 m, image by image; the error of flow is taken over the same ground.

    python benchmarks/simplified_depth.py DATASET [--split test] [--pairs 128]
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from scenegen_datasets.loader import PREVIOUS, PairDataset
from scenegen_trainers.inputs.knobs import InputKnobs
from scenegen_trainers.inputs.look import look
from scenegen_trainers.inputs.simplify import simplified_depth
from scenegen_trainers.training.samples import spread

VARIANTS: dict[str, dict[str, Any]] = {
    "Farneback, 1st to 99th percentile": {},
    "Farneback, least to most": {"gain": "minmax"},
    "Farneback, CLAHE": {"gain": "clahe"},
    "DIS, 1st to 99th percentile": {"flow": "dis"},
    "DIS, CLAHE": {"flow": "dis", "gain": "clahe"},
    "true flow": {"flow": "truth"},
}
CAP_M = 100.0
LEAST_PIXELS = 40
"""Embedded pixels below the cap that an image needs for a correlation to mean anything."""


def measured(sample: dict[str, Any], knobs: InputKnobs) -> tuple[float, float, float] | None:
    """Rank correlation of S with nearness, median error of flow [px], median length of true flow [px]."""
    some = slice(None, None, knobs.interval)
    near = sample["depth"] < CAP_M
    grid = near[some, some]
    if grid.sum() < LEAST_PIXELS:
        return None
    truth = np.nan_to_num(sample["flow_back"])
    seen = look(sample["thermal"], sample[PREVIOUS], knobs, truth)
    assert seen.flow is not None
    shown = simplified_depth(seen.flow, knobs)[some, some][grid]
    if shown.min() == shown.max():
        return 0.0, float("nan"), float("nan")
    rank = float(spearmanr(shown, 1.0 / sample["depth"][some, some][grid]).statistic)
    error = np.linalg.norm(seen.flow - truth, axis=-1)[near]
    return rank, float(np.median(error)), float(np.median(np.linalg.norm(truth, axis=-1)[near]))


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("dataset")
    parser.add_argument("--split", default="test")
    parser.add_argument("--pairs", type=int, default=128)
    options = parser.parse_args()
    dataset = PairDataset(Path(options.dataset), options.split, ("thermal", PREVIOUS, "depth", "flow_back"))
    samples = [dataset[i] for i in spread(len(dataset), options.pairs).tolist()]
    print(
        "| flow and gain | rank correlation, median | above 0.5 | below 0 | error of flow [px] |\n|---|---|---|---|---|"
    )
    for name, keys in VARIANTS.items():
        found = [m for m in (measured(s, InputKnobs.model_validate(keys)) for s in samples) if m is not None]
        rank, error, length = np.array(found).T
        cells = [f"{np.median(rank):.2f}", f"{(rank > 0.5).mean():.0%}", f"{(rank < 0.0).mean():.0%}"]
        print(f"| {name} | {' | '.join(cells)} | {np.nanmedian(error):.2f} of {np.nanmedian(length):.2f} |")
    print(f"\n{len(found)} of {len(samples)} images of split {options.split}")


if __name__ == "__main__":
    main()
