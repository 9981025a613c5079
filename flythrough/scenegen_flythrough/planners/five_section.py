"""Five upright bands of the depth image; fly towards the one whose nearest point is furthest.

After ``PythonClient/multirotor/navigate.py`` of Microsoft AirSim (MIT licence), which was read, not copied; the family
is that of planners that "divide the image from the depth camera into five horizontal sections". Its grey levels
become metres (255 levels for 100 m): a band must beat the middle one by 30 levels, 11.8 m, before the drone turns, and
below 20 levels, 7.8 m, it stops. Two rules are ours, since the script has no goal: where no band beats the middle, the
drone turns towards the goal by one band at most, if that band is no nearer than the stop distance; and a drone that
stands turns in place, towards the furthest band.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64

from scenegen_flythrough.loop.pilot import Command, Observation
from scenegen_flythrough.planners.straight import towards

BANDS = 5
TURN_DEG = (36.0, 18.0, 0.0, -18.0, -36.0)
"""Turn for each band, from the left; positive is counter-clockwise."""
RANGE_M = 100.0
"""What the image calls infinitely far."""
SWITCH_M = 30.0 / 255.0 * RANGE_M
STOP_M = 20.0 / 255.0 * RANGE_M
_HOLD_PER_S = 0.7
"""How quickly the height of the goal is sought [1/s]."""


@dataclass(frozen=True)
class FiveSection:
    """See the module.

    Attributes
    ----------
    cruise_mps : float
        Speed of flight; AirSim's script flies 1 m/s.
    switch_m, stop_m : float
        How much further a band must be than the middle one, and how near the middle one may be [m].
    """

    cruise_mps: float = 6.0
    switch_m: float = SWITCH_M
    stop_m: float = STOP_M
    name: str = "five_section"

    def memory(self) -> None:
        """Every picture is judged by itself."""

    def plan(
        self, depth_m: Float32[np.ndarray, "n rows columns"], seen: Observation, memory: Sequence[None]
    ) -> Command:
        """One decision for each flight."""
        nearest = band_depths(depth_m)
        middle = BANDS // 2
        best = nearest.argmax(axis=1)
        row = np.arange(len(best))
        switch = nearest[row, best] > nearest[:, middle] + self.switch_m
        wanted = np.where(switch, best, self._towards_goal(nearest, seen))
        stopped = nearest[:, middle] < self.stop_m
        wanted = np.where(stopped & ~switch & (best != middle), best, wanted)
        yaw = seen.yaw_rad + np.deg2rad(np.array(TURN_DEG))[wanted]
        straight, _ = towards(seen, self.cruise_mps)
        speed = np.where(stopped, 0.0, np.maximum(np.hypot(straight[:, 0], straight[:, 1]), 1.0))
        rise = _HOLD_PER_S * (seen.goal_m[:, 2] - seen.position_m[:, 2])
        rise = np.where(stopped, 0.0, np.clip(rise, -0.3 * self.cruise_mps, 0.3 * self.cruise_mps))
        return Command(np.stack([speed * np.cos(yaw), speed * np.sin(yaw), rise], axis=1), yaw)

    def _towards_goal(
        self, nearest: Float64[np.ndarray, "n 5"], seen: Observation
    ) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        """Middle band, or the one beside it on the goal's side if it is free."""
        way = seen.goal_m - seen.position_m
        off = np.angle(np.exp(1j * (np.arctan2(way[:, 1], way[:, 0]) - seen.yaw_rad)))
        middle = BANDS // 2
        side = np.where(np.abs(off) < np.deg2rad(9.0), middle, np.where(off > 0.0, middle - 1, middle + 1))
        free = nearest[np.arange(len(side)), side] >= self.stop_m
        return np.where(free, side, middle)


def band_depths(depth_m: Float32[np.ndarray, "n rows columns"]) -> Float64[np.ndarray, "n 5"]:
    """Nearest depth [m] of each band of the upper half of the image, at most `RANGE_M`; NaN counts as touching."""
    upper = depth_m[:, : depth_m.shape[1] // 2]
    safe = np.where(upper >= 0.0, np.minimum(upper, RANGE_M), 0.0).astype(np.float64)
    edges = np.round(np.linspace(0, upper.shape[2], BANDS + 1)).astype(int)
    return np.stack([safe[:, :, a:b].min(axis=(1, 2)) for a, b in itertools.pairwise(edges.tolist())], axis=1)
