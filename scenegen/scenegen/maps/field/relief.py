"""Rolling land with levelled platforms: pitches, car parks and ponds lie flat, hills rise in the distance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.relief import Relief, WaveRelief, draw_relief
from scenegen.maps.field.frame import Plot

_RAMP_M = 14.0
_NEAR_M, _FAR_M = 260.0, 1500.0


@dataclass(frozen=True, eq=False)
class RollingLand:
    """Waves nearby and hills that grow with distance.

    Attributes
    ----------
    waves, hills : WaveRelief
    lift_m : float
        How much the far land lies above the near one on average [m]: places seem to lie in a basin.
    """

    waves: WaveRelief
    hills: WaveRelief
    lift_m: float

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Height [m] at plan points."""
        far = _smooth((np.linalg.norm(xy, axis=1) - _NEAR_M) / (_FAR_M - _NEAR_M))
        return np.asarray(self.waves(xy) + far * (self.hills(xy) + self.lift_m))


@dataclass(frozen=True, eq=False)
class LevelledRelief:
    """Land with platforms cut into it, each joined to the land by a ramp.

    Inside a platform the height is that platform's level; between platforms levels blend by inverse square
    distance, so that each stays level however close its neighbour lies.

    Attributes
    ----------
    land : callable
    platforms : tuple of Plot
        Disjoint.
    level_m : float64 (platforms,)
    """

    land: Relief
    platforms: tuple[Plot, ...]
    level_m: Float64[np.ndarray, "platforms"]

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Height [m] at plan points."""
        height = np.asarray(self.land(xy))
        distance = np.stack([p.distance(xy) for p in self.platforms])
        near = distance.min(axis=0) < _RAMP_M
        gap = distance[:, near]
        cover = 1.0 - _smooth(gap / _RAMP_M)
        weight = cover / (gap + 1e-3) ** 2
        level = (weight * self.level_m[:, None]).sum(axis=0) / np.maximum(weight.sum(axis=0), 1e-12)
        height[near] += cover.max(axis=0) * (level - height[near])
        return height


def draw_land(amplitude_m: float, hills_m: float, rng: np.random.Generator) -> RollingLand:
    """Draw the land before anything is levelled."""
    return RollingLand(
        draw_relief(rng, amplitude_m, (170.0, 700.0)),
        draw_relief(rng, hills_m, (900.0, 3200.0)),
        hills_m * rng.uniform(0.2, 0.7),
    )


def level(land: Relief, platforms: tuple[Plot, ...]) -> LevelledRelief:
    """Level platforms at the mean height of the land below them: cut and fill balance."""
    steps = np.linspace(-1.0, 1.0, 7)
    unit = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    mean = [land(p.frame.world(unit * np.array([p.half_x_m, p.half_y_m]))).mean() for p in platforms]
    return LevelledRelief(land, platforms, np.array(mean))


def _smooth(t: np.ndarray) -> np.ndarray:
    """Smooth step from 0 to 1, with slope 0 at both ends."""
    t = np.clip(t, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))
