"""Gentle terrain: a few long waves, as a function of plan position and as a height field."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.world import HeightField

Relief = Callable[[Float64[np.ndarray, "points 2"]], Float64[np.ndarray, "points"]]
"""Height of the terrain [m] at plan points."""


@dataclass(frozen=True, eq=False)
class WaveRelief:
    """Sum of plane waves; smooth, cheap, defined everywhere.

    Attributes
    ----------
    wave_vector : float64 (waves, 2)
        [rad/m].
    phase : float64 (waves,)
        [rad].
    amplitude_m : float64 (waves,)
    """

    wave_vector: Float64[np.ndarray, "waves 2"]
    phase: Float64[np.ndarray, "waves"]
    amplitude_m: Float64[np.ndarray, "waves"]

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Height [m] at plan points."""
        angle = (xy[:, :1] * self.wave_vector[:, 0]) + (xy[:, 1:] * self.wave_vector[:, 1]) + self.phase
        return np.asarray((self.amplitude_m * np.sin(angle)).sum(axis=1))


def draw_relief(
    rng: np.random.Generator, amplitude_m: float, wavelength_m: tuple[float, float], waves: int = 6
) -> WaveRelief:
    """Draw a relief whose height has about the given amplitude (half of top to bottom).

    Parameters
    ----------
    rng : numpy.random.Generator
    amplitude_m : float
    wavelength_m : (float, float)
        Shortest and longest wave; longer waves are higher in proportion.
    waves : int
    """
    length = np.exp(rng.uniform(np.log(wavelength_m[0]), np.log(wavelength_m[1]), waves))
    heading = rng.uniform(0.0, 2 * np.pi, waves)
    vector = (2 * np.pi / length)[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    share = length / length.sum()
    return WaveRelief(vector, rng.uniform(0.0, 2 * np.pi, waves), 1.6 * amplitude_m * share)


def sample_height_field(relief: Relief, half_m: float, cell_m: float) -> HeightField:
    """Sample a relief on a square grid centred at the origin."""
    count = round(2 * half_m / cell_m) + 1
    axis = np.linspace(-half_m, half_m, count)
    east, north = np.meshgrid(axis, axis)
    height = relief(np.column_stack([east.ravel(), north.ravel()])).reshape(count, count)
    return HeightField((-half_m, -half_m), 2 * half_m / (count - 1), height.astype(np.float32))


def slopes(relief: Relief, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points 2"]:
    """Rise of the ground per metre east and north."""
    step = 0.5
    east, north = np.array([step, 0.0]), np.array([0.0, step])
    return np.column_stack([relief(xy + d) - relief(xy - d) for d in (east, north)]) / (2 * step)
