"""What is to be seen in the frames: classes, depths, heights, contrast, motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from scenegen.classes import CLASSES, SOLID_GROUND, Semantic
from scenegen_datasets.audits.geometry import height_above_ground_m
from scenegen_datasets.audits.histogram import Histogram, Spread, even_edges, log_edges
from scenegen_datasets.audits.steps import Step
from scenegen_datasets.audits.verdict import Verdict, skipped
from scenegen_render.sensor.scale import counts_to_brightness_K

_GROUND = (*SOLID_GROUND, Semantic.WATER)
_GROUND_REACH_M = 30.0
_PER_FRAME = 2000
_FLAT_K, _FLAT_SHARE = 0.5, 0.25


@dataclass(frozen=True)
class ClassShare:
    """How much of one class there is: of all pixels, and of the frames that show any of it."""

    name: str
    pixels: float
    frames: float


@dataclass(frozen=True)
class Contents:
    """Result of the audit, over the sampled frames.

    Attributes
    ----------
    verdict : Verdict
    frames : int
    classes : tuple of ClassShare
        In descending order of their pixels; no entry for classes that never occur.
    sky_share : Spread
        Of the pixels of a frame.
    depth_m, height_m, contrast_K, surface_contrast_K, flow_px : Spread
        Depth of pixels with a surface; height of the camera above the ground it sees; brightness temperature between 1
        and 99 % of a frame, and of its surfaces without the sky; length of the true flow.
    histograms : mapping of str to Histogram
        Of the same quantities.
    """

    verdict: Verdict
    frames: int
    classes: tuple[ClassShare, ...]
    sky_share: Spread
    depth_m: Spread
    height_m: Spread
    contrast_K: Spread
    surface_contrast_K: Spread
    flow_px: Spread
    histograms: Mapping[str, Histogram]


class ContentsAudit:
    """Looks at frames one by one.

    Parameters
    ----------
    rng : numpy.random.Generator
        Picks the pixels whose depth and flow are kept.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._values: dict[str, list[np.ndarray]] = {}
        self._pixels = np.zeros(len(CLASSES), np.int64)
        self._shown = np.zeros(len(CLASSES), np.int64)
        self._frames = 0

    def see(self, step: Step) -> None:
        """Look at the first frame of a step."""
        still = step.now
        self._frames += 1
        solid = np.isfinite(still.depth)
        kelvin = counts_to_brightness_K(still.counts, step.scale)
        self._keep("sky_share", np.array([1.0 - solid.mean()]))
        self._keep("contrast_K", np.array([_span(kelvin)]))
        if solid.any():
            self._keep("surface_contrast_K", np.array([_span(kelvin[solid])]))
            self._keep("depth_m", self._some(still.depth[solid]))
        if still.flow is not None:
            length = np.hypot(still.flow[..., 0], still.flow[..., 1])
            self._keep("flow_px", self._some(length[np.isfinite(length)]))
        if still.semantic is not None:
            counts = np.bincount(still.semantic.ravel(), minlength=len(CLASSES))[: len(CLASSES)]
            self._pixels += counts
            self._shown += counts > 0
            height = height_above_ground_m(
                still, step.K, np.isin(still.semantic, _GROUND) & solid, _GROUND_REACH_M
            )
            if height is not None:
                self._keep("height_m", np.array([height]))

    def _keep(self, name: str, values: np.ndarray) -> None:
        self._values.setdefault(name, []).append(values.astype(np.float64))

    def _some(self, values: np.ndarray) -> np.ndarray:
        if len(values) <= _PER_FRAME:
            return values
        return np.asarray(values[self._rng.integers(0, len(values), _PER_FRAME)])

    def result(self) -> Contents:
        """What was seen."""
        names = ("sky_share", "depth_m", "height_m", "contrast_K", "surface_contrast_K", "flow_px")
        values = {name: np.concatenate(self._values.get(name) or [np.zeros(0)]) for name in names}
        return Contents(
            self._verdict(values["surface_contrast_K"]),
            self._frames,
            self._classes(),
            **{name: Spread.of(found) for name, found in values.items()},
            histograms={name: _histogram(name, found) for name, found in values.items() if len(found)},
        )

    def _classes(self) -> tuple[ClassShare, ...]:
        total = max(int(self._pixels.sum()), 1)
        found = [
            ClassShare(
                kind.name, float(self._pixels[kind.id] / total), float(self._shown[kind.id] / self._frames)
            )
            for kind in CLASSES
            if self._pixels[kind.id]
        ]
        return tuple(sorted(found, key=lambda share: (-share.pixels, share.name)))

    def _verdict(self, contrast: np.ndarray) -> Verdict:
        if not self._frames:
            return skipped("There is no frame to look at.")
        flat = float(np.mean(contrast < _FLAT_K)) if len(contrast) else 0.0
        words = f"{self._frames} frames were looked at."
        if len(contrast):
            words += f" Their surfaces span {np.median(contrast):.1f} K at the median"
            words += f"; {100 * flat:.0f} % span less than {_FLAT_K} K."
        if flat > _FLAT_SHARE:
            return Verdict("note", "Many frames hold hardly any contrast.", words)
        return Verdict("fine", "Frames hold contrast to see by.", words)


def _span(kelvin: np.ndarray) -> float:
    low, high = np.percentile(kelvin, (1.0, 99.0))
    return float(high - low)


def _histogram(name: str, values: np.ndarray) -> Histogram:
    if name == "sky_share":
        return Histogram.of(values, even_edges(0.0, 1.0, 20))
    if name == "height_m":
        return Histogram.of(values, even_edges(0.0, float(np.ceil(values.max() / 10.0) * 10.0), 24))
    low, high = np.quantile(values, (0.002, 0.998))
    return Histogram.of(values, log_edges(max(float(low), 1e-3), max(float(high), 2e-3), 40))
