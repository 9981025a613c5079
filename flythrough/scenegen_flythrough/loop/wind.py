"""Gusts: a pure function of time, drawn once per flight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.loop.knobs import WindKnobs

_TONES = 32
_CORRELATION_S = 5.0
"""Turbulence of 50 m length passed at 10 m/s; our choice."""


@dataclass(frozen=True, eq=False)
class Gusts:
    """Sums of tones with the spectrum of a first-order Gauss-Markov process (Dryden's, MIL-F-8785C, along the wind).

    Attributes
    ----------
    mean_mps : float64 (flights, 3)
        Mean wind, level.
    sigma_mps : float
        Standard deviation of each component of a gust.
    omega_rps, phase_rad : float64 (flights, 3, tones)
    """

    mean_mps: Float64[np.ndarray, "flights 3"]
    sigma_mps: float
    omega_rps: Float64[np.ndarray, "flights 3 tones"]
    phase_rad: Float64[np.ndarray, "flights 3 tones"]

    @staticmethod
    def draw(knobs: WindKnobs, rngs: list[np.random.Generator]) -> Gusts:
        """One wind for each generator.

        The spectrum ``1 / (1 + (omega T)^2)`` is cut into slices of equal power; every slice gives one tone of a
        frequency drawn from it. The outermost, half of whose power no autopilot feels, ends at ten times its start.
        """
        drawn = [_tones(rng) for rng in rngs]
        heading = np.array([turn for turn, _, _ in drawn]).reshape(-1)
        level = np.stack([np.cos(heading), np.sin(heading), np.zeros_like(heading)], axis=1)
        shape = (-1, 3, _TONES)
        return Gusts(
            mean_mps=knobs.mean_mps * level,
            sigma_mps=knobs.turbulence * knobs.mean_mps,
            omega_rps=np.array([omega for _, omega, _ in drawn]).reshape(shape),
            phase_rad=np.array([phase for _, _, phase in drawn]).reshape(shape),
        )

    def at(self, time_s: float) -> Float64[np.ndarray, "flights 3"]:
        """Wind less its mean [m/s]."""
        tones = np.cos(self.omega_rps * time_s + self.phase_rad)
        return np.asarray(self.sigma_mps * np.sqrt(2.0 / _TONES) * tones.sum(axis=2))


def _tones(rng: np.random.Generator) -> tuple[float, np.ndarray, np.ndarray]:
    """Heading of the mean wind, frequencies and phases."""
    heading = float(rng.uniform(0.0, 2.0 * np.pi))
    share = (np.arange(_TONES) + rng.uniform(0.0, 1.0, (3, _TONES))) / _TONES
    top = (_TONES - 0.1) / _TONES
    omega = np.tan(0.5 * np.pi * np.minimum(share, top)) / _CORRELATION_S
    return heading, omega, rng.uniform(0.0, 2.0 * np.pi, (3, _TONES))
