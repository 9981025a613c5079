"""A smooth displacement of the plane that keeps areas: shear waves and swirls. It turns rows into winding streets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

_WAVE_M = (330.0, 620.0)
_STEEPNESS = 0.42
_SWIRL_RAD = 0.75


@dataclass(frozen=True, eq=False)
class Warp:
    """First swirls, then shear waves, one after the other; each keeps areas, and so does their composition.

    Attributes
    ----------
    centre : float64 (swirls, 2)
        [m].
    turn_rad, reach_m : float64 (swirls,)
        Rotation about the centre, and the distance at which it has fallen to 1/e.
    wave_vector : float64 (waves, 2)
        [rad/m]; points shift at right angles to it.
    phase : float64 (waves,)
        [rad].
    shift_m : float64 (waves,)
        At a crest.
    """

    centre: Float64[np.ndarray, "swirls 2"]
    turn_rad: Float64[np.ndarray, "swirls"]
    reach_m: Float64[np.ndarray, "swirls"]
    wave_vector: Float64[np.ndarray, "waves 2"]
    phase: Float64[np.ndarray, "waves"]
    shift_m: Float64[np.ndarray, "waves"]

    @staticmethod
    def draw(curvature: float, extent_m: float, rng: np.random.Generator) -> Warp:
        """Draw a warp: 0 leaves the plane alone, 1 turns streets by up to some 40 degrees.

        Parameters
        ----------
        curvature : float
        extent_m : float
            Side of the square that is warped.
        rng : numpy.random.Generator
        """
        swirls, waves = 2, 3
        heading = rng.uniform(0.0, np.pi) + np.pi * np.arange(waves) / waves + rng.uniform(-0.3, 0.3, waves)
        length = rng.uniform(*_WAVE_M, waves)
        number = 2 * np.pi / length
        steep = curvature * _STEEPNESS * rng.uniform(0.6, 1.0, waves)
        turn = rng.choice([-1.0, 1.0], swirls) * rng.uniform(0.5, 1.0, swirls)
        return Warp(
            centre=rng.uniform(-0.38, 0.38, (swirls, 2)) * extent_m,
            turn_rad=curvature * _SWIRL_RAD * turn,
            reach_m=rng.uniform(110.0, 190.0, swirls),
            wave_vector=number[:, None] * np.column_stack([np.cos(heading), np.sin(heading)]),
            phase=rng.uniform(0.0, 2 * np.pi, waves),
            shift_m=steep / number,
        )

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points 2"]:
        """Displaced points [m]."""
        for centre, turn, reach in zip(self.centre, self.turn_rad, self.reach_m, strict=True):
            arm = xy - centre
            angle = turn * np.exp(-(arm**2).sum(axis=1) / reach**2)
            c, s = np.cos(angle), np.sin(angle)
            xy = centre + np.column_stack([c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1]])
        for vector, phase, shift in zip(self.wave_vector, self.phase, self.shift_m, strict=True):
            across = np.array([-vector[1], vector[0]]) / np.linalg.norm(vector)
            xy = xy + (shift * np.sin(xy @ vector + phase))[:, None] * across
        return np.asarray(xy)
