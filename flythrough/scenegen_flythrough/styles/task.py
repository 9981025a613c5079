"""What every style is given, and what it gives back."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float64
from scipy.ndimage import uniform_filter1d

from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.route import Route

BATCH = 32
"""Paths drawn together."""


@dataclass(frozen=True, eq=False)
class Task:
    """A flight that is wanted.

    Attributes
    ----------
    airspace : Airspace
    knobs : FlightKnobs
    way_m : float
        How long the path must be at least.
    """

    airspace: Airspace
    knobs: FlightKnobs
    way_m: float

    @property
    def step_m(self) -> float:
        """Distance of the points that paths are drawn with: fine enough for the clip, no finer than a drone needs."""
        return min(max(self.knobs.spacing_m, 0.5), 2.0)


@dataclass(frozen=True, eq=False)
class Batch:
    """Routes drawn together.

    Attributes
    ----------
    routes : list of Route
    hopeless : int
        Draws that the coarse map already ruled out.
    """

    routes: list[Route]
    hopeless: int = 0


@runtime_checkable
class Style(Protocol):
    """One kind of flight."""

    def draw(self, task: Task, rng: np.random.Generator) -> Iterator[Batch]:
        """Batches of routes with one intent: speed, height and camera angle are drawn first, then paths are tried, so
        that what is hard to find is as likely as what is easy. A style that finds no place yields one hopeless batch.
        """
        ...


def between(span: tuple[float, float], rng: np.random.Generator) -> float:
    """A value of a range, all equally likely."""
    return span[0] + float(rng.uniform()) * (span[1] - span[0])


def common(span: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    """What two ranges share; the end of the second that lies nearest where they share nothing."""
    low, high = max(span[0], other[0]), min(span[1], other[1])
    return (low, high) if low <= high else ((other[0],) * 2 if span[1] < other[0] else (other[1],) * 2)


def clear(task: Task, points: Float64[np.ndarray, "paths points 3"]) -> Bool[np.ndarray, "paths"]:
    """Paths that the coarse map has nothing against."""
    return np.asarray(~task.airspace.blocked(points).any(axis=1))


def over_ground(
    task: Task, xy: Float64[np.ndarray, "paths points 2"], height_m: float | Float64[np.ndarray, "paths 1"]
) -> Float64[np.ndarray, "paths points 3"]:
    """Lift plans to a height above ground, smoothly and no steeper than flights climb."""
    ground = task.airspace.world.ground.at(xy.reshape(-1, 2)).reshape(xy.shape[:2])
    return lifted(xy, ground + height_m, math.radians(task.knobs.climb_deg))


def lifted(
    xy: Float64[np.ndarray, "paths points 2"],
    least_m: Float64[np.ndarray, "paths points"],
    climb_rad: float,
) -> Float64[np.ndarray, "paths points 3"]:
    """The lowest heights nowhere below `least_m` nor steeper than `climb_rad`, then smoothed over five points."""
    steps = np.linalg.norm(np.diff(xy, axis=1), axis=2)
    rise = np.concatenate([np.zeros((len(xy), 1)), np.cumsum(steps, axis=1)], axis=1) * math.tan(climb_rad)
    # Upper envelope of cones: climbing ahead of an obstacle, sinking behind it.
    behind = np.maximum.accumulate(least_m + rise, axis=1) - rise
    ahead = np.maximum.accumulate((least_m - rise)[:, ::-1], axis=1)[:, ::-1] + rise
    height = uniform_filter1d(np.maximum(behind, ahead), 5, axis=1, mode="nearest")
    return np.concatenate([xy, uniform_filter1d(height, 5, axis=1, mode="nearest")[..., None]], axis=2)


def directions(angle: Float64[np.ndarray, "*many"]) -> Float64[np.ndarray, "*many 2"]:
    """Unit vectors of headings, from east towards north."""
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)
