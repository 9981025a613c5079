"""Boats on waves: heave, roll and pitch laid over a route."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenegen.movers.route import PITCH, ROLL, TRAVELLED, Route, Z


@dataclass(frozen=True)
class Sway:
    """How a boat answers to the sea, a sum of three swings of incommensurate phase each.

    Attributes
    ----------
    heave_m, roll_rad, pitch_rad : float
        About one standard deviation.
    period_s : float
        Of the waves it meets; roll is slower, pitch faster.
    """

    heave_m: float
    roll_rad: float
    pitch_rad: float
    period_s: float

    @staticmethod
    def of(length_m: float, width_m: float, wave_height_m: float, period_s: float) -> Sway:
        """A boat of some size in waves of a significant height: small boats follow the slope of the waves.

        Deep-water waves of period T are ``g T^2 / 2 pi`` long; what is shorter than the boat averages out.
        """
        wave_m = 9.81 * period_s**2 / (2.0 * np.pi)
        steep = np.pi * wave_height_m / wave_m  # amplitude times wave number
        along, across = (1.0 / (1.0 + (2.0 * size / wave_m) ** 2) for size in (length_m, width_m))
        return Sway(0.25 * wave_height_m * along, 0.5 * steep * across, 0.5 * steep * along, period_s)


def swaying(route: Route, sway: Sway, rng: np.random.Generator) -> Route:
    """The route with a sway that closes with its round."""
    rows = route.rows.copy()
    time = (np.arange(len(rows)) - 1) * route.step_s
    for column, size, pace in (
        (Z, sway.heave_m, 1.0), (ROLL, sway.roll_rad, 0.8), (PITCH, sway.pitch_rad, 1.25)
    ):  # fmt: skip
        for share, speed in ((0.8, 1.0), (0.5, 0.77), (0.33, 1.31)):
            turns = max(round(route.round_s * pace * speed / sway.period_s), 1)
            phase = rng.uniform(0.0, 2.0 * np.pi)
            rows[:, column] += (
                np.sqrt(2.0) * share * size * np.sin(2.0 * np.pi * turns * time / route.round_s + phase)
            )
    assert np.allclose(rows[-2:, :TRAVELLED][:, [Z, PITCH, ROLL]], rows[1:3][:, [Z, PITCH, ROLL]])
    return Route(rows, route.step_s, route.start_s)
