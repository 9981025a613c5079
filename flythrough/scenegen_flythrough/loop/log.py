"""What is kept of a flight while it lasts."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64


class FlightLog:
    """Path, length, closest approach and delays of one flight.

    Attributes
    ----------
    length_m : float
        Way flown.
    closest_m : float
        Least distance to anything so far; +inf if nothing was near.
    nearest_goal_m : float
        Least distance to the goal so far.
    decisions : int
    """

    def __init__(self, start_m: Float64[np.ndarray, "3"], goal_m: Float64[np.ndarray, "3"]) -> None:
        self._goal = goal_m
        self._path = [(0.0, *start_m.tolist())]
        self._last = start_m
        self._latency_s = 0.0
        self.length_m = 0.0
        self.closest_m = float("inf")
        self.nearest_goal_m = self.way_m = float(np.linalg.norm(goal_m - start_m))
        self.decisions = 0

    def decided(self, latency_s: float) -> None:
        """Count a decision and its delay."""
        self.decisions += 1
        self._latency_s += latency_s

    def moved(self, place_m: Float64[np.ndarray, "3"], closest_m: float) -> None:
        """Add a small step to `place_m`."""
        self.length_m += float(np.linalg.norm(place_m - self._last))
        self.nearest_goal_m = min(self.nearest_goal_m, float(np.linalg.norm(self._goal - place_m)))
        self.closest_m = min(self.closest_m, closest_m)
        self._last = place_m

    def mark(self, time_s: float) -> None:
        """Keep where the drone is now as a point of the path."""
        if time_s > self._path[-1][0]:
            self._path.append((time_s, *self._last.tolist()))

    @property
    def path(self) -> Float64[np.ndarray, "k 4"]:
        """Time [s] and place [m] of the points kept."""
        return np.array(self._path, np.float64)

    @property
    def latency_s(self) -> float:
        """Mean delay of its decisions."""
        return self._latency_s / max(self.decisions, 1)

    @property
    def progress(self) -> float:
        """Share of the way to the goal that was gained, at best."""
        return 1.0 - self.nearest_goal_m / self.way_m
