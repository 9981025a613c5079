"""Do labels, poses and pictures tell the same story? Every stored step is predicted from the rest and compared.

Four tests, from exact to telling:

* *flow by pose*: depth and both poses say where a pixel of something that stands still must go; the stored flow says
  where it went. Sky must go as a point at infinity does.
* *depth by pose*: the same prediction for z, read from the next frame's depth where its neighbours show one surface.
* *flow cycle*: forward flow, then the backward flow found there, must lead back.
* *warp residual*: the next thermal frame, read where the flow points, must look like this one, up to noise; beside it
  the same without following the flow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64

from scenegen.classes import Semantic
from scenegen.radiometry.planck import band_radiance_slope
from scenegen_datasets.audits.geometry import between, centres, even_ground, landing
from scenegen_datasets.audits.histogram import Histogram, Spread, log_edges
from scenegen_datasets.audits.steps import Step, Still
from scenegen_datasets.audits.verdict import Verdict, skipped
from scenegen_render.sensor.scale import CountScale, counts_to_radiance

MOVERS = (Semantic.CAR, Semantic.LARGE_VEHICLE, Semantic.BOAT, Semantic.PERSON, Semantic.TREE, Semantic.SHRUB)
"""Classes that may move of themselves, or be moved by the wind; what stands still is judged by its pose."""

FLOW_BAR_PX, DEPTH_BAR, CYCLE_BAR_PX = 0.05, 0.01, 0.1
"""Medians above these are a fault: an error of any convention exceeds them many times, rounding stays far below."""

_KEPT = 4000
_REFERENCE_K = 290.0


@dataclass(frozen=True)
class LabelConsistency:
    """Result of the audit.

    Attributes
    ----------
    verdict : Verdict
    steps : int
    flow_px : Spread
        Distance between stored flow and that of depth and poses, over surfaces that stand still [px].
    sky_px : Spread
        The same for sky.
    depth_share : Spread
        Relative difference between predicted and stored depth.
    cycle_px : Spread
        Distance from the start after one step forth and back; no values without backward flow.
    warped_mK, still_mK : Spread
        Difference of brightness temperature between this frame and the next, read where the flow points, and read at
        the same pixel.
    clean_mK : Spread
        As `warped_mK`, of the noise-free radiance.
    noise_mK : float
        What two frames of a perfect camera of this NETD differ by: the median of ``|N(0, 2 NETD^2)|``.
    flow_histogram, warped_histogram, still_histogram : Histogram or None
        For the charts.
    """

    verdict: Verdict
    steps: int
    flow_px: Spread
    sky_px: Spread
    depth_share: Spread
    cycle_px: Spread
    warped_mK: Spread
    still_mK: Spread
    clean_mK: Spread
    noise_mK: float
    flow_histogram: Histogram | None
    warped_histogram: Histogram | None
    still_histogram: Histogram | None


class LabelAudit:
    """Collects residuals step by step; of each at most some thousands of values a frame.

    Parameters
    ----------
    rng : numpy.random.Generator
        Picks the pixels that are kept.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._found: dict[str, list[Float32[np.ndarray, "values"]]] = {}
        self._steps, self._netd_mK = 0, 0.0

    def see(self, step: Step) -> None:
        """Judge one step."""
        now, next = step.now, step.next
        if now.flow is None:
            return
        self._steps += 1
        self._netd_mK = float(step.facts["sensor"].get("netd_mk", 0.0))
        seen = now.covisible if now.covisible is not None else np.isfinite(now.flow).all(axis=-1)
        ahead = landing(now, next, step.K)
        error = np.linalg.norm(now.flow - ahead.flow, axis=-1)
        solid, sky = np.isfinite(now.depth), np.isinf(now.depth)
        stands = solid & _stands(now)
        self._keep("flow_px", error, stands & seen)
        self._keep("sky_px", error, sky)
        place = centres(now.depth.shape) + now.flow
        even = even_ground(now.depth) & seen & (np.nan_to_num(between(_mask(next.depth), place)) > 0.999)
        there = between(np.where(np.isfinite(next.depth), next.depth, np.float32(0.0)), place)
        self._keep("depth_share", np.abs(there / ahead.depth - 1.0), even & stands)
        if next.flow is not None:
            back = between(np.nan_to_num(next.flow), place)
            self._keep("cycle_px", np.linalg.norm(now.flow + back, axis=-1), even)
        self._warp(step, place, even)

    def _warp(
        self, step: Step, place: Float64[np.ndarray, "rows columns 2"], even: Bool[np.ndarray, "rows columns"]
    ) -> None:
        mK = 1000.0 / float(band_radiance_slope(np.array(_REFERENCE_K), step.scale.band_um))
        first, second = (_radiance(still, step.scale) for still in (step.now, step.next))
        self._keep("warped_mK", mK * np.abs(between(second, place) - first), even)
        self._keep("still_mK", mK * np.abs(second - first), even)
        if step.now.radiance is not None and step.next.radiance is not None:
            self._keep("clean_mK", mK * np.abs(between(step.next.radiance, place) - step.now.radiance), even)

    def _keep(self, name: str, values: np.ndarray, where: Bool[np.ndarray, "rows columns"]) -> None:
        chosen = values[where & np.isfinite(values)].astype(np.float32)
        if len(chosen) > _KEPT:
            chosen = chosen[self._rng.integers(0, len(chosen), _KEPT)]
        self._found.setdefault(name, []).append(chosen)

    def result(self) -> LabelConsistency:
        """What all steps together say."""
        values = {
            name: np.concatenate(self._found.get(name) or [np.zeros(0, np.float32)])
            for name in ("flow_px", "sky_px", "depth_share", "cycle_px", "warped_mK", "still_mK", "clean_mK")
        }
        spreads = {name: Spread.of(found) for name, found in values.items()}
        heat = log_edges(5.0, 20_000.0, 48)
        return LabelConsistency(
            verdict=_verdict(self._steps, spreads),
            steps=self._steps,
            **spreads,
            noise_mK=0.6745 * np.sqrt(2.0) * self._netd_mK,
            flow_histogram=_histogram(values["flow_px"], log_edges(1e-8, 10.0, 54)),
            warped_histogram=_histogram(values["warped_mK"], heat),
            still_histogram=_histogram(values["still_mK"], heat),
        )


def _verdict(steps: int, spread: dict[str, Spread]) -> Verdict:
    if not steps:
        return skipped("The dataset stores no flow, so labels cannot be held against each other.")
    wrong = []
    if (spread["flow_px"].median or 0.0) > FLOW_BAR_PX:
        wrong.append(f"the stored flow misses that of depth and poses by {spread['flow_px'].median:.2f} px")
    if (spread["depth_share"].median or 0.0) > DEPTH_BAR:
        wrong.append(
            f"depths of neighbouring frames disagree by {100 * (spread['depth_share'].median or 0):.1f} %"
        )
    if (spread["cycle_px"].median or 0.0) > CYCLE_BAR_PX:
        wrong.append(f"forth and back misses the start by {spread['cycle_px'].median:.2f} px")
    warped, still = spread["warped_mK"].median, spread["still_mK"].median
    if warped is not None and still is not None and warped > 1.05 * still:
        wrong.append("following the flow explains the next picture worse than not following it")
    if wrong:
        return Verdict("fault", "Labels contradict each other.", f"{'; '.join(wrong).capitalize()}.")
    said = [f"flow agrees with depth and poses to {_small(spread['flow_px'].median)} px"]
    if spread["depth_share"].median is not None:
        said.append(f"depth to {_small(100 * spread['depth_share'].median)} %")
    if spread["cycle_px"].median is not None:
        said.append(f"forth and back closes to {_small(spread['cycle_px'].median)} px")
    words = f"At the median, {', '.join(said)}."
    if warped is not None and still is not None:
        words += f" Read where the flow points, the next frame differs by {warped:.0f} mK; unmoved by {still:.0f} mK."
    return Verdict("fine", "Flow, depth, poses and pictures agree.", words)


def _small(value: float | None) -> str:
    return "-" if value is None else "less than 0.001" if value < 0.001 else f"{value:.2g}"


def _stands(still: Still) -> Bool[np.ndarray, "rows columns"]:
    if still.semantic is None:
        return np.ones(still.depth.shape, bool)
    return ~np.isin(still.semantic, MOVERS)


def _mask(depth: Float32[np.ndarray, "rows columns"]) -> Float32[np.ndarray, "rows columns"]:
    return even_ground(depth).astype(np.float32)


def _radiance(still: Still, scale: CountScale) -> Float32[np.ndarray, "rows columns"]:
    return counts_to_radiance(still.counts, scale)


def _histogram(values: Float32[np.ndarray, "values"], edges: tuple[float, ...]) -> Histogram | None:
    return Histogram.of(values, edges) if len(values) else None
