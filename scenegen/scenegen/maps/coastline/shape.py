"""The shape of a coast along its shore: where it runs, where it is cliff and where beach, how high and how wide.

Everything is a curve over the distance along the shore. The plan of the coast is made of lines `t = shore(s) + q(s)`:
they never cross as long as the offsets keep their order, however the shore winds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from scenegen.maps.coastline.knobs import CoastlineKnobs

FAR_M = 9000.0
"""Half the side of the whole world: from 40 m up, the true horizon of a flat sea lies a quarter of a degree higher."""

_STEP_M = 2.0
_REACH_M = 13_500.0
_LEDGE_M = 5.0
_ROAD_BEHIND_M = 14.0
_UPLAND_M = 90.0


@dataclass(frozen=True, eq=False)
class Frame:
    """Coast coordinates: s along the shore with the land to the left, t inland.

    Attributes
    ----------
    heading_rad : float
        Direction of growing s, counter-clockwise from east.
    shift_m : float
        t of the world's origin.
    """

    heading_rad: float
    shift_m: float

    def local(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points 2"]:
        """(s, t) of plan points."""
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return np.asarray(xy @ np.array([[c, -s], [s, c]]) + np.array([0.0, self.shift_m]))

    def world(self, st: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points 2"]:
        """Plan points of (s, t)."""
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return np.asarray((st - np.array([0.0, self.shift_m])) @ np.array([[c, s], [-s, c]]))


@dataclass(frozen=True, eq=False)
class Curve:
    """A function of s, tabulated every two metres; constant beyond its ends."""

    values: Float64[np.ndarray, "samples"]

    def __call__(self, s: Float64[np.ndarray, "points"]) -> Float64[np.ndarray, "points"]:
        """Values at distances along the shore."""
        place = np.clip((s + _REACH_M) / _STEP_M, 0.0, len(self.values) - 1.000001)
        k = place.astype(np.int64)
        return np.asarray(self.values[k] + (place - k) * (self.values[k + 1] - self.values[k]))

    def stations(self) -> Float64[np.ndarray, "samples"]:
        """The distances along the shore at which it is tabulated."""
        return _stations()


@dataclass(frozen=True, eq=False)
class Coast:
    """Curves of one coast; offsets q are metres inland of the shore line, measured along t.

    Attributes
    ----------
    frame : Frame
    half_m : float
        Half the side of the detailed square.
    shore : Curve
        t of the shore line.
    cliff : Curve
        0 on open beaches, 1 on full cliffs.
    wet, beach, brow, back : Curve
        Offsets of the upper edge of wet sand, of the foot of dune or cliff, of the top of the cliff, of the back of
        the dunes.
    foreshore : float
        Slope of the wet beach.
    cliff_m, dune_m, upland_m : Curve
        Height of the cliff, of the dune, and of the land behind [m].
    road : Curve
        t of the centre line of the coastal road.
    """

    frame: Frame
    half_m: float
    shore: Curve
    cliff: Curve
    wet: Curve
    beach: Curve
    brow: Curve
    back: Curve
    foreshore: float
    cliff_m: Curve
    dune_m: Curve
    upland_m: Curve
    road: Curve

    def offset(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points 2"]:
        """(s, q) of plan points."""
        st = self.frame.local(xy)
        return np.column_stack([st[:, 0], st[:, 1] - self.shore(st[:, 0])])

    def plan(
        self, s: Float64[np.ndarray, "points"], q: Float64[np.ndarray, "points"]
    ) -> Float64[np.ndarray, "points 2"]:
        """Plan points of (s, q)."""
        return self.frame.world(np.column_stack([s, self.shore(s) + q]))

    def core(self, margin_m: float = 0.0) -> tuple[float, float, float, float]:
        """Bounds of the detailed square, less a margin."""
        r = self.half_m - margin_m
        return (-r, -r, r, r)

    def inside(self, xy: Float64[np.ndarray, "points 2"], margin_m: float) -> Bool[np.ndarray, "points"]:
        """Which points lie in the detailed square, away from its edge."""
        return np.asarray(np.abs(xy).max(axis=1) < self.half_m - margin_m)


def draw_coast(knobs: CoastlineKnobs, rng: np.random.Generator) -> Coast:
    """Draw a coast."""
    whole, bends, rock, sand, hill = rng.spawn(5)
    half = whole.uniform(*knobs.extent_m) / 2
    frame = Frame(whole.uniform(0.0, 2 * np.pi), whole.uniform(-0.06, 0.12) * half)
    s = _stations()
    cliff = _cliffness(s, half, whole.uniform(*knobs.cliff_share), rock)
    detail = (
        11.0 * _noise(s, 170.0, bends) + 26.0 * _noise(s, 700.0, bends) + 260.0 * _noise(s, 6500.0, bends)
    )
    jag = 2.2 * _noise(s, 26.0, bends) + 1.0 * _noise(s, 11.0, bends)
    near = np.clip(1.6 - np.abs(s) / 1500.0, 0.0, 1.0)
    shore = detail - detail[len(s) // 2] + near * (0.12 + cliff) * jag + 18.0 * (0.5 - cliff)
    wet_m, slope = sand.uniform(*knobs.wet_height_m), sand.uniform(0.055, 0.09)
    width = sand.uniform(*knobs.beach_width_m) * (1 + 0.22 * np.clip(_noise(s, 160.0, sand), -1.5, 1.5))
    wet = np.full(len(s), wet_m / slope) * (1 + 0.18 * np.clip(_noise(s, 24.0, sand), -1.5, 1.5) * near)
    beach = np.maximum(width * (1 - cliff) + (wet + _LEDGE_M) * cliff, wet + 3.0)
    beach += near * cliff * 1.6 * np.clip(_noise(s, 16.0, rock), -1.6, 1.6) + near * 1.2 * _noise(
        s, 30.0, rock
    )
    top = hill.uniform(*knobs.cliff_height_m)
    cliff_m = top * cliff * (0.86 + 0.14 * np.clip(_noise(s, 190.0, hill), -2.0, 1.0))
    run = np.maximum((0.24 + 0.5 * (1 - cliff)) * cliff_m + 22.0 * (1 - cliff), 2.0)
    brow = beach + run * (1 + 0.15 * near * np.clip(_noise(s, 20.0, rock), -1.5, 1.5))
    ridge = np.clip(1 + 0.4 * _noise(s, 70.0, sand), 0.25, 1.7)
    dune_m = sand.uniform(*knobs.dune_height_m) * ridge * (1 - cliff) ** 1.5
    back = np.maximum(brow + 4.0, beach + sand.uniform(38.0, 62.0) * (1 - cliff))
    road = _road(shore + np.maximum(brow + 12.0 * cliff, back) + _ROAD_BEHIND_M)
    upland_m = 0.85 * gaussian_filter1d(cliff_m, _UPLAND_M / _STEP_M)
    return Coast(
        frame=frame,
        half_m=half,
        shore=Curve(shore),
        cliff=Curve(cliff),
        wet=Curve(wet),
        beach=Curve(beach),
        brow=Curve(brow),
        back=Curve(back),
        foreshore=slope,
        cliff_m=Curve(cliff_m),
        dune_m=Curve(dune_m),
        upland_m=Curve(upland_m),
        road=Curve(road),
    )


def _stations() -> np.ndarray:
    return np.arange(-_REACH_M, _REACH_M + _STEP_M / 2, _STEP_M)


def _noise(s: np.ndarray, length_m: float, rng: np.random.Generator) -> np.ndarray:
    """Smooth noise of unit variance whose bumps are about `length_m` apart."""
    knots = np.arange(s[0] - length_m, s[-1] + 2 * length_m, length_m / 2)
    return np.asarray(CubicSpline(knots, rng.standard_normal(len(knots)))(s))


def _cliffness(s: np.ndarray, half_m: float, share: float, rng: np.random.Generator) -> np.ndarray:
    """Smooth steps between beach and cliff so that the wanted share of the detailed shore is cliff."""
    wave = _noise(s, 330.0, rng)
    seen = wave[np.abs(s) < half_m]
    x = np.clip((wave - np.quantile(seen, 1 - share)) / 0.55 + 0.5, 0.0, 1.0)
    return np.asarray(gaussian_filter1d(x * x * (3 - 2 * x), 12.0 / _STEP_M))


def _road(least: np.ndarray) -> np.ndarray:
    """A smooth line that keeps inland of another one."""
    return np.asarray(gaussian_filter1d(maximum_filter1d(least, int(110.0 / _STEP_M)), 45.0 / _STEP_M))
