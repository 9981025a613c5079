"""Height of the coast: sea bed, beach, dunes, cliffs, land behind, and what people have levelled or heaped up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.relief import WaveRelief, draw_relief
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.coastline.shape import Coast, Curve
from scenegen.world import HeightField

ROAD_HALF_M = 3.4
"""Half the width of the coastal road [m]."""

_VERGE_M, _BATTER_M = 1.8, 11.0
_DEEPEST_M = 9.0
_DRY_SLOPE = 0.022
_LEDGE_M = 0.55


@dataclass(frozen=True, eq=False)
class Pad:
    """Level ground: a car park, a yard.

    Attributes
    ----------
    outline : shapely.Polygon
    level_m : float
    batter_m : float
        Width of the strip in which the pad runs out into the land [m].
    """

    outline: shapely.Polygon
    level_m: float
    batter_m: float = 9.0


@dataclass(frozen=True, eq=False)
class Mound:
    """The heap of a breakwater: a level crown and two slopes.

    Attributes
    ----------
    line : shapely.LineString
    crown_m, half_m, slope : float
        Height of the crown, half its width [m]; rise over run of the sides.
    """

    line: shapely.LineString
    crown_m: float
    half_m: float
    slope: float


@dataclass(frozen=True, eq=False)
class CoastRelief:
    """Height [m] of the solid ground at plan points; below zero under the sea.

    Attributes
    ----------
    coast : Coast
    rolling, hummocks, face, hills : WaveRelief
        Of the land, the dunes, the faces of cliffs (in s and q) and the far land; amplitude about one, but for
        `rolling`.
    hills_m : float
        Height of the far hills [m].
    bed : Curve or None
        Height of the road along s [m].
    pads : tuple of Pad
    mounds : tuple of Mound
    """

    coast: Coast
    rolling: WaveRelief
    hummocks: WaveRelief
    face: WaveRelief
    hills: WaveRelief
    hills_m: float
    bed: Curve | None = None
    pads: tuple[Pad, ...] = field(default=())
    mounds: tuple[Mound, ...] = field(default=())

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Height [m]."""
        height = self._with_road(xy, self.natural(xy))
        for pad in self.pads:
            near, distance = _near(xy, pad.outline, pad.batter_m)
            share = _smooth(1 - distance / pad.batter_m)
            height[near] += share * (pad.level_m - height[near])
        for mound in self.mounds:
            reach = mound.half_m + (mound.crown_m + _DEEPEST_M) / mound.slope
            near, distance = _near(xy, mound.line, reach)
            heap = mound.crown_m - mound.slope * np.maximum(distance - mound.half_m, 0.0)
            height[near] = np.maximum(height[near], heap)
        return np.asarray(height)

    def natural(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Height [m] before anybody built."""
        coast = self.coast
        sq = coast.offset(xy)
        s, q = sq[:, 0], sq[:, 1]
        cliff, beach, brow = coast.cliff(s), coast.beach(s), coast.brow(s)
        fade = np.clip(1.6 - np.hypot(xy[:, 0], xy[:, 1]) / 1300.0, 0.0, 1.0)
        strand = coast.foreshore * np.minimum(q, coast.wet(s))
        strand = strand + _DRY_SLOPE * np.clip(q - coast.wet(s), 0.0, beach - coast.wet(s))
        steep = (1 + 2.2 * cliff) * strand
        bed = -_DEEPEST_M * (1 - np.exp(np.minimum(steep, 0.0) / _DEEPEST_M))
        behind = np.maximum(q - brow, 0.0)
        inland = 1 - np.exp(-behind / 75.0)
        rise = self._face(s, q, beach, brow, cliff, fade) * coast.cliff_m(s)
        upland = rise + inland * (coast.upland_m(s) - coast.cliff_m(s))
        land = (
            upland
            + self._dune(s, q, xy, fade)
            + self._ledges(s, q, beach, cliff, fade)
            + inland * (1.5 + fade * self.rolling(xy))
        )
        far = np.clip((q - 450.0) / 2200.0, 0.0, 1.0) ** 1.3
        land = land + far * self.hills_m * (1.1 + self.hills(xy))
        land = np.maximum(strand + land, np.minimum(strand, 0.9) - 0.4 * cliff)
        return np.asarray(np.where(q < 0.0, bed + self._ledges(s, q, beach, cliff, fade), land))

    def _face(
        self,
        s: np.ndarray,
        q: np.ndarray,
        beach: np.ndarray,
        brow: np.ndarray,
        cliff: np.ndarray,
        fade: np.ndarray,
    ) -> np.ndarray:
        """Rise of the cliff, 0 at its foot to 1 at its brow: buttresses, gullies, ledges."""
        run = brow - beach
        x = (q - beach) / run
        inner = np.clip(4 * x * (1 - x), 0.0, 1.0)
        push, steep = np.zeros(len(s)), inner * cliff * fade > 0.0
        push[steep] = self.face(np.column_stack([s, 2.5 * q])[steep])
        x = x + fade * cliff * inner * push * np.minimum(0.3, 2.2 / run)
        x = np.clip(
            x
            + cliff
            * (0.03 * np.sin(6 * np.pi * x + 0.05 * s) + 0.018 * np.sin(17 * np.pi * x - 0.03 * s))
            * inner,
            0.0,
            1.0,
        )
        return np.asarray(cliff * x + (1 - cliff) * x * x * (3 - 2 * x))

    def _ledges(
        self, s: np.ndarray, q: np.ndarray, beach: np.ndarray, cliff: np.ndarray, fade: np.ndarray
    ) -> np.ndarray:
        """Rough rock below the cliffs, awash in places."""
        share = np.clip(np.minimum(q + 6.0, beach + 2.0 - q) / 4.0, 0.0, 1.0) * cliff**2 * fade
        rough, rocky = np.zeros(len(s)), share > 0.0
        rough[rocky] = self.face(np.column_stack([s, 0.8 * q])[rocky] + 40.0)
        return np.asarray(_LEDGE_M * share * rough)

    def _dune(self, s: np.ndarray, q: np.ndarray, xy: np.ndarray, fade: np.ndarray) -> np.ndarray:
        """Dune ridge with a steep seaward side, and its hummocks."""
        coast = self.coast
        u = np.clip((q - coast.beach(s)) / (coast.back(s) - coast.beach(s)), 0.0, 1.0)
        ridge = np.sin(np.pi * u**0.75)
        rough, sandy = np.zeros(len(s)), (u > 0.0) & (u < 1.0)
        rough[sandy] = self.hummocks(xy[sandy])
        return np.asarray(coast.dune_m(s) * ridge * (1.0 + 0.22 * fade * rough))

    def _with_road(self, xy: np.ndarray, height: np.ndarray) -> np.ndarray:
        if self.bed is None:
            return height
        st = self.coast.frame.local(xy)
        s = st[:, 0]
        slope = (self.coast.road(s + 4.0) - self.coast.road(s - 4.0)) / 8.0
        distance = np.abs(st[:, 1] - self.coast.road(s)) / np.hypot(1.0, slope)
        share = _smooth(1 - (distance - ROAD_HALF_M - _VERGE_M) / _BATTER_M)
        return np.asarray(height + share * (self.bed(s) - height))


def draw_coast_relief(coast: Coast, knobs: CoastlineKnobs, rng: np.random.Generator) -> CoastRelief:
    """Draw the unbuilt land of a coast."""
    own, rolling, hummocks, face, hills = rng.spawn(5)
    return CoastRelief(
        coast,
        draw_relief(rolling, own.uniform(*knobs.relief_m), (70.0, 420.0), 8),
        draw_relief(hummocks, 1.0, (11.0, 30.0), 10),
        draw_relief(face, 1.0, (5.0, 24.0), 12),
        draw_relief(hills, 0.8, (1500.0, 5200.0), 6),
        own.uniform(30.0, 110.0),
    )


def with_road(relief: CoastRelief, smooth: Callable[[np.ndarray], np.ndarray]) -> CoastRelief:
    """Grade the road along its line.

    Parameters
    ----------
    relief : CoastRelief
    smooth : callable
        From heights of the land every two metres along the road to heights of the road.
    """
    coast = relief.coast
    s = coast.road.stations()
    ground = relief.natural(coast.frame.world(np.column_stack([s, coast.road.values])))
    return replace(relief, bed=Curve(smooth(ground)))


def solid_heights(relief: CoastRelief, half_m: float, cell_m: float) -> HeightField:
    """Height of what is solid or sea, on a square grid centred at the origin: the sea counts as level zero."""
    count = round(2 * half_m / cell_m) + 1
    axis = np.linspace(-half_m, half_m, count)
    east, north = np.meshgrid(axis, axis)
    height = relief(np.column_stack([east.ravel(), north.ravel()])).reshape(count, count)
    return HeightField(
        (-half_m, -half_m), 2 * half_m / (count - 1), np.maximum(height, 0.0).astype(np.float32)
    )


def _near(xy: np.ndarray, shape: shapely.Geometry, reach_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Indices of points within reach of a shape, and their distances."""
    x0, y0, x1, y1 = shape.bounds
    inside = (xy[:, 0] > x0 - reach_m) & (xy[:, 0] < x1 + reach_m)
    inside &= (xy[:, 1] > y0 - reach_m) & (xy[:, 1] < y1 + reach_m)
    index = np.flatnonzero(inside)
    shapely.prepare(shape)
    distance = shapely.distance(shapely.points(xy[index]), shape)
    return index[distance < reach_m], distance[distance < reach_m]


def _smooth(x: np.ndarray) -> np.ndarray:
    x = np.clip(x, 0.0, 1.0)
    return np.asarray(x * x * (3 - 2 * x))
