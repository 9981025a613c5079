"""Answers that need no image: what a network has to beat before anybody calls it one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float32, Float64

from scenegen_datasets.loader import PairDataset
from scenegen_trainers.evaluation.judge import Judge, Standings
from scenegen_trainers.metrics import ValidDepth

CONSTANT, ROW_MEAN, PAINTED_ROW_MEAN = "constant", "row mean", "row mean, sky as cap"
"""Their names in reports. The second is the hardest to beat where sky is left out, the third where it is judged."""


@dataclass(frozen=True, eq=False)
class Baselines:
    """What the training split looks like on average, with depth capped.

    Attributes
    ----------
    constant_m : float
        Median of all pixels below the cap [m].
    row_m : float64 (rows,)
        Mean of each image row over pixels below the cap [m]; where a row has none, the cap.
    painted_row_m : float64 (rows,)
        Mean of each image row with sky and everything beyond the cap as if it stood there [m]: that of depth pictures.
    """

    constant_m: float
    row_m: Float64[np.ndarray, "rows"]
    painted_row_m: Float64[np.ndarray, "rows"]

    def answers(self, shape: tuple[int, int]) -> dict[str, Float32[np.ndarray, "rows columns"]]:
        """Each baseline's answer, the same to every image."""
        rows, painted = (
            np.asarray(np.broadcast_to(mean[:, None], shape), np.float32)
            for mean in (self.row_m, self.painted_row_m)
        )
        return {
            CONSTANT: np.full(shape, self.constant_m, np.float32),
            ROW_MEAN: rows,
            PAINTED_ROW_MEAN: painted,
        }


def fit_baselines(training: PairDataset, cap_m: float) -> Baselines:
    """Look at the depth of a training split.

    Parameters
    ----------
    training : PairDataset
        With layer depth; at least one pair.
    cap_m : float
        Pixels at or beyond it, sky included, are left out, as the scores leave them out [m].
    """
    sums = counts = painted = np.zeros(len(training[0]["depth"]))
    histogram = np.zeros(_BINS, np.int64)
    for sample in training:
        depth = sample["depth"]
        near = depth < cap_m
        sums = sums + np.where(near, depth, 0.0).sum(axis=1, dtype=np.float64)
        counts = counts + near.sum(axis=1)
        painted = painted + np.minimum(depth, cap_m).mean(axis=1, dtype=np.float64)
        histogram += np.histogram(depth[near], _BINS, (0.0, cap_m))[0]
    rows = np.where(counts > 0, sums / np.maximum(counts, 1.0), cap_m)
    painted = painted / len(training)
    if not counts.any():
        return Baselines(cap_m, rows, painted)
    middle = int(np.searchsorted(np.cumsum(histogram), 0.5 * histogram.sum()))
    return Baselines((middle + 0.5) * cap_m / _BINS, rows, painted)


def trivial_answers(root: Path, valid: ValidDepth) -> dict[str, Float32[np.ndarray, "rows columns"]]:
    """Each baseline's answer to every image of a dataset, by name; none where the dataset has no training split."""
    training = PairDataset(root, "train", ("depth",))
    if len(training) == 0:
        return {}
    return fit_baselines(training, valid.furthest_m).answers(training[0]["depth"].shape)


def judge_baselines(root: Path, split: str, valid: ValidDepth) -> dict[str, Standings]:
    """Scores of each baseline over a whole split, by name."""
    rivals = trivial_answers(root, valid)
    judges = {name: Judge(valid, stratified=False) for name in rivals}
    for sample in PairDataset(root, split, ("depth",)) if rivals else ():
        for name, answer in rivals.items():
            judges[name].add(answer, sample["depth"], sample)
    return {name: judge.standings() for name, judge in judges.items()}


_BINS = 4000
"""Steps of the median: 2.5 cm at a cap of 100 m."""
