"""How well depth was estimated: RMSE, Rel and threshold accuracy, streamed image by image.

With truth g and estimate p over N valid pixels: RMSE = sqrt(mean (g - p)^2), Rel = mean |g - p| / g, and delta_n is the
share of pixels with max(p / g, g / p) < 1.25^n, n = 1, 2, 3 (Eigen, Puhrsch and Fergus, NeurIPS 2014).
All pixels of a data set are pooled, as the equations say; means over images stand beside them because much of the
literature reports those, and so do median-aligned scores, which forgive a wrong scale. The four never belong in one
column.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Float64

from scenegen.foundation.errors import InputError

RANGES_M = (20.0, 50.0)
"""Where the ranges of `DepthReport.by_range` are cut [m]."""
_DELTA = 1.25


@dataclass(frozen=True)
class ValidDepth:
    """Which pixels are judged.

    Attributes
    ----------
    nearest_m, furthest_m : float
        A pixel counts where ``nearest_m <= truth < furthest_m``.
    beyond_as_furthest : bool
        Judge sky and everything beyond too, as if it stood at `furthest_m`, and clip estimates there: what a network
        trained on 8-bit depth pictures with a cap is asked to do. Off by default: sky has no depth.
    """

    nearest_m: float = 0.5
    furthest_m: float = 100.0
    beyond_as_furthest: bool = False

    def __post_init__(self) -> None:
        if not 0.0 < self.nearest_m < self.furthest_m < math.inf:
            raise InputError(
                f"valid depth from {self.nearest_m:g} to {self.furthest_m:g} m is no range; "
                "give 0 < nearest_m < furthest_m"
            )

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Cut at `RANGES_M`: from and below a distance [m], near to far."""
        cuts = [self.nearest_m, *(c for c in RANGES_M if self.nearest_m < c < self.furthest_m)]
        return tuple(itertools.pairwise([*cuts, math.inf if self.beyond_as_furthest else self.furthest_m]))


@dataclass(frozen=True)
class DepthScores:
    """The five figures of one set of pixels.

    Attributes
    ----------
    rmse_m : float
        Root mean square error [m].
    rel : float
        Mean absolute relative error.
    delta : (float, float, float)
        Share of pixels within 1.25, 1.25^2 and 1.25^3 of the truth.
    """

    rmse_m: float
    rel: float
    delta: tuple[float, float, float]


@dataclass(frozen=True)
class DepthReport:
    """Scores of all images seen.

    Attributes
    ----------
    pooled : DepthScores
        Over all valid pixels of all images: the equations as written.
    per_image : DepthScores
        Mean over images of each image's own scores.
    pooled_aligned, per_image_aligned : DepthScores
        The same after each estimate was scaled to its truth's median.
    by_range : tuple of (float, float, DepthScores or None)
        Pooled and unaligned, from and below a distance [m]; None where no pixel fell.
    images : int
        Images with at least one valid pixel.
    skipped : int
        Images without any.
    pixels : int
        Valid pixels.
    missing : int
        Valid pixels whose estimate was NaN or infinite. Such a pixel is scored as the worst answer within the valid
        range, its near or far end, and fails every threshold: a hole is never better than a guess.
    """

    pooled: DepthScores
    per_image: DepthScores
    pooled_aligned: DepthScores
    per_image_aligned: DepthScores
    by_range: tuple[tuple[float, float, DepthScores | None], ...]
    images: int
    skipped: int
    pixels: int
    missing: int


@dataclass
class _Sums:
    """Running sums of squared error, relative error and threshold hits."""

    count: int = 0
    sums: Float64[np.ndarray, "5"] = field(default_factory=lambda: np.zeros(5))

    def add(self, terms: Float64[np.ndarray, "5 pixels"]) -> None:
        self.count += terms.shape[1]
        self.sums = self.sums + terms.sum(axis=1)

    def add_scores(self, scores: DepthScores) -> None:
        self.count += 1
        self.sums = self.sums + np.array([scores.rmse_m, scores.rel, *scores.delta])

    def scores(self) -> DepthScores:
        """Of pooled pixels."""
        mean = (self.sums / self.count).tolist()
        return DepthScores(math.sqrt(mean[0]), mean[1], (mean[2], mean[3], mean[4]))

    def mean_scores(self) -> DepthScores:
        """Of images added by `add_scores`."""
        mean = (self.sums / self.count).tolist()
        return DepthScores(mean[0], mean[1], (mean[2], mean[3], mean[4]))


class DepthMeter:
    """Collects images and reports; keeps sums only, so that a data set of any size costs nothing.

    Parameters
    ----------
    valid : ValidDepth
    """

    def __init__(self, valid: ValidDepth | None = None) -> None:
        self.valid = ValidDepth() if valid is None else valid
        self._pooled, self._aligned = _Sums(), _Sums()
        self._images, self._images_aligned = _Sums(), _Sums()
        self._ranges = [_Sums() for _ in self.valid.ranges]
        self._skipped = self._missing = 0

    @property
    def pixels(self) -> int:
        """Valid pixels so far; without any there is no `report`."""
        return self._pooled.count

    def add(
        self, estimate_m: Float[np.ndarray, "height width"], truth_m: Float[np.ndarray, "rows columns"]
    ) -> DepthScores | None:
        """Judge one image.

        Parameters
        ----------
        estimate_m, truth_m : float (rows, columns)
            Planar depth [m]; sky is +inf in the truth.

        Returns
        -------
        DepthScores or None
            The image's own scores, unaligned; None if it has no valid pixel.

        Raises
        ------
        InputError
            If the two differ in shape, or the truth is NaN anywhere.
        """
        truth, estimate = self._valid_pixels(estimate_m, truth_m)
        if len(truth) == 0:
            self._skipped += 1
            return None
        known = np.isfinite(estimate)
        self._missing += int((~known).sum())
        terms = self._terms(estimate, truth)
        self._pooled.add(terms)
        own = _own_scores(terms)
        self._images.add_scores(own)
        for sums, (low, high) in zip(self._ranges, self.valid.ranges, strict=True):
            sums.add(terms[:, (truth >= low) & (truth < high)])
        aligned = self._terms(estimate * _median_scale(estimate[known], truth[known]), truth)
        self._aligned.add(aligned)
        self._images_aligned.add_scores(_own_scores(aligned))
        return own

    def report(self) -> DepthReport:
        """Scores of everything added so far.

        Raises
        ------
        InputError
            If no image had a valid pixel: there is nothing to average.
        """
        if self._pooled.count == 0:
            raise InputError(
                f"no pixel with a true depth of {self.valid.nearest_m:g} to {self.valid.furthest_m:g} m in "
                f"{self._skipped} images; check the units of the truth (metres) or widen the valid range"
            )
        ranges = zip(self.valid.ranges, self._ranges, strict=True)
        return DepthReport(
            pooled=self._pooled.scores(),
            per_image=self._images.mean_scores(),
            pooled_aligned=self._aligned.scores(),
            per_image_aligned=self._images_aligned.mean_scores(),
            by_range=tuple((low, high, s.scores() if s.count else None) for (low, high), s in ranges),
            images=self._images.count,
            skipped=self._skipped,
            pixels=self._pooled.count,
            missing=self._missing,
        )

    def _valid_pixels(
        self, estimate_m: Float[np.ndarray, "height width"], truth_m: Float[np.ndarray, "rows columns"]
    ) -> tuple[Float64[np.ndarray, "pixels"], Float64[np.ndarray, "pixels"]]:
        if estimate_m.shape != truth_m.shape:
            raise InputError(
                f"the estimate has {estimate_m.shape} pixels, the truth {truth_m.shape}; resize the estimate first"
            )
        if np.isnan(truth_m).any():
            raise InputError("the true depth is NaN in places; mark sky as +inf and repair the rest")
        truth = truth_m.astype(np.float64)
        if self.valid.beyond_as_furthest:
            mask = truth >= self.valid.nearest_m
            return np.minimum(truth[mask], self.valid.furthest_m), estimate_m[mask].astype(np.float64)
        mask = (truth >= self.valid.nearest_m) & (truth < self.valid.furthest_m)
        return truth[mask], estimate_m[mask].astype(np.float64)

    def _terms(
        self, estimate: Float64[np.ndarray, "pixels"], truth: Float64[np.ndarray, "pixels"]
    ) -> Float64[np.ndarray, "5 pixels"]:
        """Squared error, relative error and the three threshold hits of each pixel."""
        near, far = self.valid.nearest_m, self.valid.furthest_m
        known = np.isfinite(estimate)
        worst = np.where(far - truth > truth - near, far, near)
        filled = np.where(known, estimate, worst)
        if self.valid.beyond_as_furthest:
            filled = np.minimum(filled, far)
        error = np.abs(filled - truth)
        positive = known & (filled > 0.0)
        safe = np.where(positive, filled, 1.0)
        ratio = np.where(positive, np.maximum(safe / truth, truth / safe), np.inf)
        return np.stack(
            [error**2, error / truth, *((ratio < _DELTA**n).astype(np.float64) for n in (1, 2, 3))]
        )


def _own_scores(terms: Float64[np.ndarray, "5 pixels"]) -> DepthScores:
    sums = _Sums()
    sums.add(terms)
    return sums.scores()


def _median_scale(estimate: Float64[np.ndarray, "known"], truth: Float64[np.ndarray, "known"]) -> float:
    """Ratio of the medians; 1 where the estimate has no positive median to scale."""
    middle = float(np.median(estimate)) if len(estimate) else 0.0
    return float(np.median(truth)) / middle if middle > 0.0 else 1.0
