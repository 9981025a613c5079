"""How good is the flow a drone can compute itself? Farneback's and DIS against the stored truth.

On weak thermal texture dense flow may *invert*: far things get the longer flow, and what was meant as a hint at depth
says the opposite. Three figures tell a frame: the end-point error; the *order*, Spearman's correlation of flow length
with 1/depth, beside that of the true flow, which rotation lowers; and the *heading*, the mean cosine between both.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, UInt8

from scenegen_datasets.audits.geometry import even_ground
from scenegen_datasets.audits.rank import spearman
from scenegen_datasets.audits.steps import Step
from scenegen_datasets.audits.verdict import Verdict, skipped
from scenegen_datasets.dense_flow import DIS_SMALLEST_PX, dis, farneback
from scenegen_render.sensor.agc import percentile_agc
from scenegen_render.sensor.scale import counts_to_brightness_K

Estimator = Callable[
    [UInt8[np.ndarray, "rows columns"], UInt8[np.ndarray, "rows columns"]],
    Float32[np.ndarray, "rows columns 2"],
]

ESTIMATORS: Mapping[str, Estimator] = {"Farneback": farneback, "DIS": dis}

INVERTED_NOTE = 0.1
"""Share of frames with inverted flow from which on it is worth a note."""

ORDERED = 0.2
"""The true flow must order depths this clearly before an estimate can be called inverted."""

_MOVING_PX = 0.5
_PIXELS = 6000
_FEWEST_PIXELS = 50
_GAIN_PERCENT = (1.0, 99.0)


@dataclass(frozen=True)
class FlowScore:
    """One estimator on one frame.

    Attributes
    ----------
    key : str
    sun_elevation_deg : float
    texture_K : float
        Median contrast of single surfaces: standard deviation of brightness temperature over 7 x 7 pixels.
    error_px : float
        Median end-point error.
    true_px : float
        Median length of the true flow.
    order, true_order : float or None
        Spearman's correlation with 1/depth.
    heading : float or None
        Mean cosine between estimate and truth where the truth is longer than half a pixel.
    """

    key: str
    sun_elevation_deg: float
    texture_K: float
    error_px: float
    true_px: float
    order: float | None
    true_order: float | None
    heading: float | None

    @property
    def inverted(self) -> bool:
        """Whether far things got the longer flow, or flow points backwards."""
        if self.heading is not None and self.heading < 0.0:
            return True
        return self.order is not None and self.order < 0.0 and (self.true_order or 0.0) > ORDERED


@dataclass(frozen=True)
class Group:
    """Some frames, one estimator.

    Attributes
    ----------
    estimator, frames : str
    count : int
    error_px, true_px, order, true_order, heading : float or None
        Medians over the frames.
    inverted_share : float
    """

    estimator: str
    frames: str
    count: int
    error_px: float | None
    true_px: float | None
    order: float | None
    true_order: float | None
    heading: float | None
    inverted_share: float


@dataclass(frozen=True)
class FlowQuality:
    """Result of the audit: groups for the table, scores for the chart."""

    verdict: Verdict
    groups: tuple[Group, ...]
    scores: Mapping[str, tuple[FlowScore, ...]]


class FlowAudit:
    """Estimates flow step by step.

    Parameters
    ----------
    rng : numpy.random.Generator
        Picks the pixels that are ranked.
    estimators : mapping of str to callable
        From two grey frames to flow.
    """

    def __init__(self, rng: np.random.Generator, estimators: Mapping[str, Estimator] = ESTIMATORS) -> None:
        self._rng, self._estimators = rng, estimators
        self._scores: dict[str, list[FlowScore]] = {name: [] for name in estimators}

    def see(self, step: Step) -> None:
        """Judge all estimators on one step; both frames share one gain."""
        now = step.now
        if now.flow is None:
            return
        judged = np.isfinite(now.depth) & np.isfinite(now.flow).all(axis=-1)
        if now.covisible is not None:
            judged &= now.covisible
        if np.count_nonzero(judged) < _FEWEST_PIXELS:
            return
        first, second = grey_pair(now.counts, step.next.counts)
        texture = _texture_K(step)
        for name, estimate in self._estimators.items():
            if name == "DIS" and min(first.shape) < DIS_SMALLEST_PX:
                continue
            score = self._score(step, estimate(first, second), now.flow, judged, texture)
            self._scores[name].append(score)

    def _score(
        self,
        step: Step,
        flow: Float32[np.ndarray, "rows columns 2"],
        truth: Float32[np.ndarray, "rows columns 2"],
        judged: Bool[np.ndarray, "rows columns"],
        texture_K: float,
    ) -> FlowScore:
        guess, true = flow[judged].astype(np.float64), truth[judged].astype(np.float64)
        near = 1.0 / step.now.depth[judged].astype(np.float64)
        length, true_length = np.linalg.norm(guess, axis=1), np.linalg.norm(true, axis=1)
        some = self._rng.integers(0, len(near), min(_PIXELS, len(near)))
        moving = (true_length > _MOVING_PX) & (length > 1e-6)
        cosine = np.sum(guess[moving] * true[moving], axis=1) / (length * true_length)[moving]
        return FlowScore(
            step.key,
            float(step.facts["sun_elevation_deg"]),
            texture_K,
            float(np.median(np.linalg.norm(guess - true, axis=1))),
            float(np.median(true_length)),
            spearman(length[some], near[some]),
            spearman(true_length[some], near[some]),
            float(cosine.mean()) if len(cosine) >= _FEWEST_PIXELS else None,
        )

    def result(self) -> FlowQuality:
        """Medians by estimator: over all frames, by day and night, by strong and weak texture."""
        scores = {name: tuple(found) for name, found in self._scores.items() if found}
        groups = tuple(
            _group(name, words, chosen)
            for name, found in scores.items()
            for words, chosen in _parts(found)
            if chosen
        )
        return FlowQuality(_verdict(groups), groups, scores)


def grey_pair(
    now: np.ndarray, next: np.ndarray
) -> tuple[UInt8[np.ndarray, "rows columns"], UInt8[np.ndarray, "rows columns"]]:
    """Both frames as 8-bit grey under one gain, black and white at 1 and 99 % of the two together."""
    grey = percentile_agc(np.concatenate([now, next]), *_GAIN_PERCENT)
    return np.ascontiguousarray(grey[: len(now)]), np.ascontiguousarray(grey[len(now) :])


def _texture_K(step: Step) -> float:
    """Median roughness of what shows one surface, the camera's noise included."""
    kelvin = counts_to_brightness_K(step.now.counts, step.scale)
    centred = kelvin - np.float32(kelvin.mean())
    mean, square = cv2.blur(centred, (7, 7)), cv2.blur(centred * centred, (7, 7))
    rough = np.sqrt(np.maximum(square - mean * mean, 0.0))
    even = even_ground(step.now.depth, 1.1)
    return float(np.median(rough[even])) if even.any() else 0.0


def _parts(scores: Sequence[FlowScore]) -> Sequence[tuple[str, list[FlowScore]]]:
    middle = float(np.median([s.texture_K for s in scores]))
    return (
        ("all", list(scores)),
        ("by day", [s for s in scores if s.sun_elevation_deg > 0.0]),
        ("by night", [s for s in scores if s.sun_elevation_deg <= 0.0]),
        (f"texture above {middle:.2f} K", [s for s in scores if s.texture_K > middle]),
        (f"texture below {middle:.2f} K", [s for s in scores if s.texture_K <= middle]),
    )


def _group(estimator: str, words: str, scores: Sequence[FlowScore]) -> Group:
    def median(name: str) -> float | None:
        values = [value for score in scores if (value := getattr(score, name)) is not None]
        return float(np.median(values)) if values else None

    inverted = sum(score.inverted for score in scores) / len(scores)
    return Group(
        estimator,
        words,
        len(scores),
        median("error_px"),
        median("true_px"),
        median("order"),
        median("true_order"),
        median("heading"),
        inverted,
    )


def _verdict(groups: Sequence[Group]) -> Verdict:
    whole = {group.estimator: group for group in groups if group.frames == "all"}
    if not whole:
        return skipped("The dataset stores no flow that estimates could be held against.")
    words = " ".join(
        f"{name} errs by {group.error_px:.2f} px at the median (the true flow is {group.true_px:.1f} px long) and is "
        f"inverted in {100 * group.inverted_share:.0f} % of the frames."
        for name, group in whole.items()
    )
    best = max((group.heading for group in whole.values() if group.heading is not None), default=None)
    if best is not None and best < 0.0:
        return Verdict("fault", "The stored flow points against what the pictures show.", words)
    bad = [name for name, group in whole.items() if group.inverted_share > INVERTED_NOTE]
    if bad:
        return Verdict("note", f"{' and '.join(bad)} may say near where it is far.", words)
    return Verdict("fine", "Flow estimated from the pictures orders near and far as the truth does.", words)
