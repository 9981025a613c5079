"""Does brightness give depth away? If it did, a network would learn a look-up table in place of seeing.

Simple regressors guess the logarithm of depth: from the brightness of the pixel alone, from the brightness of its
surroundings by a plane, from the row of the image, and from row and brightness together. Each is fitted on some
worlds and judged on others, so what counts is what holds everywhere. The row may well tell depth: the ground of any
drone that looks ahead lies further away higher up, in real pictures too. What brightness tells should be little.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float32, Int64

from scenegen_datasets.audits.information import mutual_information, unrelated_information
from scenegen_datasets.audits.regressors import Curve, Features, Plane, Regressor, Sum, Values
from scenegen_datasets.audits.steps import Step
from scenegen_datasets.audits.verdict import Verdict, skipped

LEAKS, TELLS = 0.5, 0.2
"""Share of the variance of log depth from which on brightness gives depth away, or tells part of it."""

_COUNTS, _GREY, _AROUND, _ROUGH, _ROW = range(5)
_PER_FRAME = 1500
_FOLDS = 5
_FEWEST_SAMPLES = 500
_AROUND_PX = 7


@dataclass(frozen=True)
class Explained:
    """R^2 of log depth on what was not fitted; below 0 is worse than a constant.

    Attributes
    ----------
    one_pixel : float
        Of the best curve from the counts of a pixel.
    one_pixel_grey : float
        The same from its grey level after the gain of its frame, which is what networks are shown.
    linear : float
        Of a plane over counts, grey, and mean and roughness of the surroundings.
    row : float
        Of the best curve from the row of the pixel.
    row_and_grey : float
        Of any function of row and grey level together.
    """

    one_pixel: float
    one_pixel_grey: float
    linear: float
    row: float
    row_and_grey: float

    @property
    def brightness(self) -> float:
        """The best guess from brightness alone."""
        return max(self.one_pixel, self.one_pixel_grey, self.linear)


@dataclass(frozen=True)
class Information:
    """Mutual information with depth [bit].

    Attributes
    ----------
    grey, row, grey_given_row : float
        Of the grey level, of the row, and of the grey level in a known row.
    grey_unrelated, row_unrelated, grey_given_row_unrelated : float
        The same with grey levels and rows of other pictures: what would be found where there is nothing.
    """

    grey: float
    row: float
    grey_given_row: float
    grey_unrelated: float
    row_unrelated: float
    grey_given_row_unrelated: float


@dataclass(frozen=True)
class Lookup:
    """Depth [m] by grey level, over all worlds: geometric mean, and 16 and 84 % around it."""

    grey: tuple[float, ...]
    mean_m: tuple[float, ...]
    low_m: tuple[float, ...]
    high_m: tuple[float, ...]


@dataclass(frozen=True)
class DepthLeak:
    """Result of the audit.

    Attributes
    ----------
    verdict : Verdict
    samples : int
        Pixels with a surface.
    held_out : {"worlds", "clips"}
        What was kept from the fit.
    groups : int
        How many of them there are.
    explained : Explained or None
        None, like all below, where there is too little to judge.
    information : Information or None
    lookup : Lookup or None
    """

    verdict: Verdict
    samples: int
    held_out: str
    groups: int
    explained: Explained | None = None
    information: Information | None = None
    lookup: Lookup | None = None


_FITS: Mapping[str, Callable[[Features, Values], Regressor]] = {
    "one_pixel": lambda x, y: Curve.fit(x, y, _COUNTS),
    "one_pixel_grey": lambda x, y: Curve.fit(x, y, _GREY),
    "linear": lambda x, y: Plane.fit(x, y, (_COUNTS, _GREY, _AROUND, _ROUGH)),
    "row": lambda x, y: Curve.fit(x, y, _ROW),
    "row_and_grey": lambda x, y: Sum.fit(x, y, (_ROW, _GREY)),
}


class LeakAudit:
    """Collects pixels step by step.

    Parameters
    ----------
    rng : numpy.random.Generator
        Picks them.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._features: list[Features] = []
        self._answers: list[Values] = []
        self._worlds: list[str] = []
        self._clips: list[str] = []

    def see(self, step: Step) -> None:
        """Take some pixels of the first frame."""
        still = step.now
        rows, columns = np.nonzero(np.isfinite(still.depth))
        if not len(rows):
            return
        pick = self._rng.integers(0, len(rows), min(_PER_FRAME, len(rows)))
        rows, columns = rows[pick], columns[pick]
        maps = feature_maps(still.counts.astype(np.float32))
        values = [image[rows, columns] for image in maps]
        features = np.stack([*values, (rows + 0.5) / still.depth.shape[0]], axis=1).astype(np.float64)
        self._features.append(features)
        self._answers.append(np.log(still.depth[rows, columns].astype(np.float64)))
        self._worlds.append(step.world)
        self._clips.append(step.clip)

    def result(self) -> DepthLeak:
        """Fit, judge and say it in words."""
        held_out, names = ("worlds", self._worlds) if len(set(self._worlds)) > 1 else ("clips", self._clips)
        groups, samples = len(set(names)), sum(map(len, self._answers))
        if groups < 2 or samples < _FEWEST_SAMPLES:
            why = "There are too few worlds and surfaces to fit on some and judge on others."
            return DepthLeak(skipped(why), samples, held_out, groups)
        x, y = np.concatenate(self._features), np.concatenate(self._answers)
        fold = _folds(names, [len(part) for part in self._answers])
        explained = Explained(**{name: _held_out_r2(fit, x, y, fold) for name, fit in _FITS.items()})
        picture = np.repeat(np.arange(len(self._answers)), [len(part) for part in self._answers])
        return DepthLeak(
            _verdict(explained, held_out),
            samples,
            held_out,
            groups,
            explained,
            _information(x[:, _GREY], x[:, _ROW], y, picture),
            _lookup(x[:, _GREY], y),
        )


def feature_maps(
    counts: Float32[np.ndarray, "rows columns"],
) -> tuple[Float32[np.ndarray, "rows columns"], ...]:
    """Counts, grey level between 1 and 99 % of the frame, and its mean and roughness over 7 x 7 pixels."""
    low, high = np.percentile(counts, (1.0, 99.0))
    grey = np.clip((counts - np.float32(low)) / np.float32(max(high - low, 1.0)), 0.0, 1.0).astype(np.float32)
    size = (_AROUND_PX, _AROUND_PX)
    mean = np.asarray(cv2.blur(grey, size), np.float32)
    square = np.asarray(cv2.blur(grey * grey, size), np.float32)
    return counts, grey, mean, np.sqrt(np.maximum(square - mean * mean, 0.0)).astype(np.float32)


def _information(grey: Values, row: Values, y: Values, picture: Int64[np.ndarray, "samples"]) -> Information:
    return Information(
        mutual_information(grey, y),
        mutual_information(row, y),
        mutual_information(grey, y, given=row),
        unrelated_information(grey, y, picture),
        unrelated_information(row, y, picture),
        unrelated_information(grey, y, picture, given=row),
    )


def _folds(names: list[str], sizes: list[int]) -> Int64[np.ndarray, "samples"]:
    """Fold of every sample: groups are dealt out one by one."""
    of = {name: k % _FOLDS for k, name in enumerate(dict.fromkeys(names))}
    return np.repeat(np.array([of[name] for name in names], np.int64), sizes)


def _held_out_r2(
    fit: Callable[[Features, Values], Regressor], x: Features, y: Values, fold: Int64[np.ndarray, "samples"]
) -> float:
    """Share of the scatter around the fitted part's mean that is explained, over all folds."""
    wrong = scatter = 0.0
    for k in np.unique(fold):
        out = fold == k
        answer = fit(x[~out], y[~out])(x[out])
        wrong += float(np.sum((y[out] - answer) ** 2))
        scatter += float(np.sum((y[out] - y[~out].mean()) ** 2))
    return 1.0 - wrong / scatter if scatter > 0.0 else 0.0


def _verdict(found: Explained, held_out: str) -> Verdict:
    bright, row = found.brightness, max(found.row, 0.0)
    percent, more = f"{100 * max(bright, 0.0):.0f} %", found.row_and_grey - row
    words = (
        f"In {held_out} it was not fitted on, the best simple guess from brightness explains {percent} of the scatter "
        f"of (log) depth. The image row alone explains {100 * row:.0f} %, as it does in any picture of a ground that "
        f"runs away from the camera; knowing brightness as well {_adds(more)}."
    )
    if bright >= LEAKS:
        return Verdict("fault", "Yes: brightness gives depth away.", words)
    if bright >= TELLS:
        return Verdict("note", "In part: brightness tells some of the depth.", words)
    return Verdict("fine", "No: brightness does not give depth away.", words)


def _adds(more: float) -> str:
    if more < 0.005:
        return "adds nothing that holds elsewhere"
    return f"adds {100 * more:.0f} point{'s' if round(100 * more) != 1 else ''}"


def _lookup(grey: Values, log_depth: Values, bins: int = 24) -> Lookup:
    parts = np.array_split(np.argsort(grey, kind="stable"), bins)
    around = [np.exp(np.quantile(log_depth[part], (0.16, 0.84))) for part in parts]
    return Lookup(
        tuple(float(grey[part].mean()) for part in parts),
        tuple(float(np.exp(log_depth[part].mean())) for part in parts),
        tuple(float(low) for low, _ in around),
        tuple(float(high) for _, high in around),
    )
