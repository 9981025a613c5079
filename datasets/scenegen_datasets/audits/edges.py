"""What happens to heat at silhouettes, where labels jump from one surface to another and a camera mixes both.

Labels come from the ray through the pixel's centre, heat is the mean over the pixel, blurred by the lens. At each
silhouette the profile of brightness is read across it, from the level of the near side (1) to that of the far side (0),
and averaged over all of them: the edge-spread function of the camera about the edges of the depth map. It says how many
pixels are a mixture of two surfaces, and whether heat and depth lie on top of each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64

from scenegen.radiometry.planck import band_radiance_slope
from scenegen_datasets.audits.steps import Step, Still
from scenegen_datasets.audits.verdict import Verdict, skipped
from scenegen_render.sensor.scale import counts_to_radiance

REACH = 4
"""Pixels read on either side; the outer two of each give its level."""

JUMP = 1.15
"""Ratio of two depths from which on neighbours belong to different surfaces."""

OFFSET_BAR_PX, WIDTH_BAR_PX = 0.5, 4.0
"""Heat this far beside its depth is a fault; a wider edge is worth a note."""

_CONTRAST_K, _REFERENCE_K = 2.0, 290.0
_MIXED = (0.1, 0.9)
_FEWEST = 50  # to read a profile from
_FEW = 400  # fewer may all be of one crown, or one turn: a shift there is no fault yet
_PER_FRAME = 400


@dataclass(frozen=True)
class EdgeMap:
    """Result of the audit.

    Attributes
    ----------
    verdict : Verdict
    edges : int
        Silhouettes whose profile was read.
    silhouette_share : float
        Share of all pixels that touch a silhouette.
    mixed_pixels : float or None
        Pixels per silhouette, across it, whose heat is 10 to 90 % of both sides.
    mixed_share : float or None
        Share of all pixels that are such a mixture, from the two above.
    width_px : float or None
        From 10 to 90 % of the mean profile.
    offset_right_px, offset_down_px : float or None
        Where the mean profile crosses one half, against the edge of depth, across upright and across level edges;
        positive towards the far side.
    places_px : tuple of float
        Of the profile, negative on the near side.
    profile, clean_profile : tuple of float
        Mean share of the near side, of the camera's counts and of the noise-free radiance.
    """

    verdict: Verdict
    edges: int
    silhouette_share: float
    mixed_pixels: float | None = None
    mixed_share: float | None = None
    width_px: float | None = None
    offset_right_px: float | None = None
    offset_down_px: float | None = None
    places_px: tuple[float, ...] = ()
    profile: tuple[float, ...] = ()
    clean_profile: tuple[float, ...] = ()


class EdgeAudit:
    """Collects profiles step by step.

    Parameters
    ----------
    rng : numpy.random.Generator
        Picks them where a frame has many.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._touching: list[float] = []
        self._found: dict[str, list[Float64[np.ndarray, "edges places"]]] = {
            "right": [],
            "down": [],
            "clean": [],
        }

    def see(self, step: Step) -> None:
        """Read the silhouettes of the first frame."""
        still = step.now
        self._touching.append(float(silhouettes(still).mean()))
        kelvin = 1.0 / float(band_radiance_slope(np.array(_REFERENCE_K), step.scale.band_um))
        heat = kelvin * counts_to_radiance(still.counts, step.scale)
        clean = None if still.radiance is None else np.float32(kelvin) * still.radiance
        for name, turn in (("right", False), ("down", True)):
            rows, columns = self._pick(still, turn)
            depth = _turned(still.depth, turn)
            found = _profiles(_turned(heat, turn), depth, rows, columns)
            self._found[name].append(found)
            if clean is not None:
                self._found["clean"].append(_profiles(_turned(clean, turn), depth, rows, columns))

    def _pick(self, still: Still, turn: bool) -> tuple[np.ndarray, np.ndarray]:
        """Lone silhouettes: nothing else jumps within reach."""
        ids = still.instance
        jumps = _jumps(_turned(still.depth, turn), None if ids is None else _turned(ids, turn))
        window = np.lib.stride_tricks.sliding_window_view(jumps, 2 * REACH - 1, axis=1)
        lone = window[..., REACH - 1] & (window.sum(axis=-1) == 1)
        rows, columns = np.nonzero(lone)
        if len(rows) > _PER_FRAME:
            some = self._rng.integers(0, len(rows), _PER_FRAME)
            rows, columns = rows[some], columns[some]
        return rows, columns

    def result(self) -> EdgeMap:
        """The mean profile and what it says."""
        parts = {name: np.concatenate(found) for name, found in self._found.items() if found}
        right, down = (parts.get(name, np.zeros((0, 2 * REACH))) for name in ("right", "down"))
        both = np.concatenate([right, down])
        touching = float(np.mean(self._touching)) if self._touching else 0.0
        if len(both) < _FEWEST:
            why = "Too few silhouettes with a contrast of 2 K to read the camera's edge from."
            return EdgeMap(skipped(why), len(both), touching)
        profile = _mean(both)
        mixed = float(np.mean(np.sum((both > _MIXED[0]) & (both < _MIXED[1]), axis=1)))
        offsets = [_crossing(_mean(part), 0.5) if len(part) >= _FEWEST else None for part in (right, down)]
        width = _width(profile)
        share = min(0.5 * mixed * touching, 1.0)  # a crossing touches one pixel on either side
        clean = parts.get("clean")
        return EdgeMap(
            verdict=_verdict(offsets, width, mixed, share, len(both)),
            edges=len(both),
            silhouette_share=touching,
            mixed_pixels=mixed,
            mixed_share=share,
            width_px=width,
            offset_right_px=offsets[0],
            offset_down_px=offsets[1],
            places_px=tuple(k - REACH + 0.5 for k in range(2 * REACH)),
            profile=tuple(map(float, profile)),
            clean_profile=tuple(map(float, _mean(clean))) if clean is not None and len(clean) else (),
        )


def silhouettes(still: Still) -> Bool[np.ndarray, "rows columns"]:
    """Pixels that touch a silhouette."""
    across = _jumps(still.depth, still.instance)
    down = _jumps(still.depth.T, None if still.instance is None else still.instance.T).T
    touching = np.zeros(still.depth.shape, bool)
    touching[:, :-1] |= across
    touching[:, 1:] |= across
    touching[:-1] |= down
    touching[1:] |= down
    return touching


def _turned(layer: np.ndarray, turn: bool) -> np.ndarray:
    return layer.T if turn else layer


def _jumps(
    depth: Float32[np.ndarray, "rows columns"], instance: np.ndarray | None
) -> Bool[np.ndarray, "rows between"]:
    """Whether a pixel and the one right of it show different surfaces, far apart."""
    known = np.where(np.isfinite(depth), depth, np.float32(1e9))
    ratio = known[:, 1:] / known[:, :-1]
    far = (ratio > JUMP) | (ratio < 1.0 / JUMP)
    return far if instance is None else far & (instance[:, 1:] != instance[:, :-1])


def _profiles(
    heat_K: np.ndarray, depth: np.ndarray, rows: np.ndarray, columns: np.ndarray
) -> Float64[np.ndarray, "edges places"]:
    """Share of the near side across edges that have enough contrast, near side first."""
    if not len(rows):
        return np.zeros((0, 2 * REACH))
    across = columns[:, None] + np.arange(2 * REACH)
    values = heat_K[rows[:, None], across].astype(np.float64)
    swap = depth[rows, columns + REACH - 1] > depth[rows, columns + REACH]
    values[swap] = values[swap, ::-1]
    near, far = values[:, :2].mean(axis=1), values[:, -2:].mean(axis=1)
    clear = np.abs(near - far) > _CONTRAST_K
    return np.asarray((values[clear] - far[clear, None]) / (near - far)[clear, None])


def _mean(profiles: Float64[np.ndarray, "edges places"]) -> Float64[np.ndarray, "places"]:
    """Mean of the middle four fifths: what stands in the way of one edge does not shift all."""
    ordered = np.sort(profiles, axis=0)
    cut = len(ordered) // 10
    return np.asarray(ordered[cut : len(ordered) - cut].mean(axis=0))


def _crossing(profile: Float64[np.ndarray, "places"], level: float) -> float | None:
    """Where a falling profile first goes below a level [px]."""
    below = np.flatnonzero(profile < level)
    if not len(below) or below[0] == 0:
        return None
    k = int(below[0])
    part = (profile[k - 1] - level) / (profile[k - 1] - profile[k])
    return float(k - 1 + part - REACH + 0.5)


def _width(profile: Float64[np.ndarray, "places"]) -> float | None:
    first, last = _crossing(profile, _MIXED[1]), _crossing(profile, _MIXED[0])
    return None if first is None or last is None else last - first


def _verdict(
    offsets: Sequence[float | None], width: float | None, mixed: float, share: float, edges: int
) -> Verdict:
    known = [abs(offset) for offset in offsets if offset is not None]
    aside = max(known, default=0.0)
    wide = "not clearly" if width is None else f"{width:.1f} px"
    words = (
        f"Across a silhouette {mixed:.1f} pixels show a mixture of near and far heat, {100 * share:.1f} % of all "
        f"pixels; the edge is {wide} wide (10 to 90 %) and lies {aside:.2f} px from that of depth. "
        "A loss that trusts every pixel there asks for sharper edges than the camera has."
    )
    if aside > OFFSET_BAR_PX and edges < _FEW:
        return Verdict("note", f"Heat lies beside depth, but at {edges} silhouettes only.", words)
    if aside > OFFSET_BAR_PX:
        return Verdict("fault", "Heat and depth do not lie on top of each other.", words)
    if width is not None and width > WIDTH_BAR_PX:
        return Verdict("note", "Edges of heat are wide.", words)
    return Verdict("fine", "Heat and depth share their edges.", words)
