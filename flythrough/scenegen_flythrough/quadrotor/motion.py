"""A flown motion: where the airframe is, how it moves, how it leans and what it feels, at any instant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.quadrotor.attitude import DRAG_PER_S, Attitude, flat_attitude, thrust_mps2
from scenegen_flythrough.quadrotor.spline import UniformSpline

_HOVER_MPS = 0.05
"""Below this speed the way says little about the time: instants are interpolated, not refined."""


@runtime_checkable
class Leaning(Protocol):
    """Whatever knows the attitude of the airframe along a motion."""

    def at(self, t: Float64[np.ndarray, "times"], position: UniformSpline) -> Attitude:
        """Attitude and body rates at instants."""
        ...

    def up(self, t: Float64[np.ndarray, "times"], position: UniformSpline) -> Float64[np.ndarray, "times 3"]:
        """Along the rotor axis, of any length."""
        ...


@dataclass(frozen=True, eq=False)
class FlatLeaning:
    """Leaning as the motion demands, in moving air.

    Attributes
    ----------
    heading : UniformSpline
        Of the nose [rad], one column.
    wind : UniformSpline
        Steady wind and gusts [m/s], three columns.
    """

    heading: UniformSpline
    wind: UniformSpline

    def up(self, t: Float64[np.ndarray, "times"], position: UniformSpline) -> Float64[np.ndarray, "times 3"]:
        """Along the rotor axis: the push of the rotors per mass [m/s^2]."""
        return thrust_mps2(position.at(t, 1), position.at(t, 2), self.wind.at(t))

    def at(self, t: Float64[np.ndarray, "times"], position: UniformSpline) -> Attitude:
        """Attitude and body rates at instants."""
        rate = position.at(t, 3) + DRAG_PER_S * (position.at(t, 2) - self.wind.at(t, 1))
        return flat_attitude(
            self.up(t, position), rate, self.heading.at(t)[:, 0], self.heading.at(t, 1)[:, 0]
        )


@dataclass(frozen=True, eq=False)
class Motion:
    """Position over time, and the attitude that goes with it. Time is the motion's own, in seconds.

    Attributes
    ----------
    position : UniformSpline
        Over time [m], three columns.
    leaning : Leaning
    """

    position: UniformSpline
    leaning: Leaning

    def attitude(self, t: Float64[np.ndarray, "times"]) -> Attitude:
        """Attitude and body rates at instants."""
        return self.leaning.at(t, self.position)

    def times_at_way(
        self, first_m: float, spacing_m: float, count: int, *, at_end: bool = False
    ) -> Float64[np.ndarray, "count"] | None:
        """Instants `spacing_m` of way apart; None where the motion is too short.

        Parameters
        ----------
        first_m : float
            Way before the first of them, or behind the last if `at_end`.
        spacing_m : float
        count : int
        at_end : bool
        """
        spline = self.position
        steps = max(int(np.ceil((spline.end - spline.start) / spline.step * 8)), 8)
        t = np.linspace(spline.start, spline.end, steps + 1)
        way, speed = self._way(t)
        wanted = first_m + np.arange(count) * spacing_m
        if way[-1] < wanted[-1]:
            return None
        if at_end:
            wanted = way[-1] - wanted[::-1]
        guess = np.clip(np.interp(wanted, way, t), spline.start, spline.end)
        for _ in range(2):  # Newton, from the nearest sample below
            k = np.clip(np.searchsorted(t, guess, side="right") - 1, 0, steps)
            now = np.linalg.norm(spline.at(guess, 1), axis=1)
            between = np.linalg.norm(spline.at(0.5 * (t[k] + guess), 1), axis=1)
            reached = way[k] + (speed[k] + 4.0 * between + now) * (guess - t[k]) / 6.0
            step = np.where(now > _HOVER_MPS, (wanted - reached) / np.maximum(now, _HOVER_MPS), 0.0)
            guess = np.clip(guess + step, spline.start, spline.end)
        return np.asarray(guess)

    @property
    def length_m(self) -> float:
        """Way of the whole motion."""
        return self.way_until(self.position.end)

    def way_until(self, t: float) -> float:
        """Way from the beginning to an instant [m]."""
        spline = self.position
        steps = max(int(np.ceil((t - spline.start) / spline.step * 8)), 1)
        return float(self._way(np.linspace(spline.start, t, steps + 1))[0][-1])

    def _way(
        self, t: Float64[np.ndarray, "times"]
    ) -> tuple[Float64[np.ndarray, "times"], Float64[np.ndarray, "times"]]:
        """Way flown until each instant (Simpson's rule between them), and speed."""
        speed = np.linalg.norm(self.position.at(t, 1), axis=1)
        middle = np.linalg.norm(self.position.at(0.5 * (t[1:] + t[:-1]), 1), axis=1)
        pieces = (speed[:-1] + 4.0 * middle + speed[1:]) * np.diff(t) / 6.0
        return np.concatenate([[0.0], np.cumsum(pieces)]), speed
