"""Terrain graded for building: below houses, patios and pools the ground is level, and it eases back to the slope."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64
from scipy.ndimage import distance_transform_edt

from scenegen.geometry.relief import Relief
from scenegen.world import HeightField

_CELL_M = 1.0
_LEVEL_M, _EASE_M = 1.0, 5.0
"""How far around a pad the ground stays level, and how far from there it eases back to the slope."""
_CALM_M = 4.0
"""Nearer than this to a street, the ground follows the street's slope more and more."""


@dataclass(frozen=True, eq=False)
class Graded:
    """A relief plus a correction sampled on a grid, bilinear in between.

    Attributes
    ----------
    base : callable
        The terrain as it was.
    shift : HeightField
        What to add inside its grid; zero along its border.
    """

    base: Relief
    shift: HeightField

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Height [m] at plan points."""
        return np.asarray(self.base(xy) + self.shift.at(xy))


def grade(relief: Relief, pads: list[shapely.Polygon], street: shapely.Polygon, half_m: float) -> Graded:
    """Level the ground below pads; streets keep their slope.

    Parameters
    ----------
    relief : callable
    pads : list of shapely.Polygon
        Oriented rectangles. Each becomes level at the mean height of the ground below its rim. Where two come closer
        than they can ease, the ground lies between.
    street : shapely.Polygon
        Carriageway and sidewalks.
    half_m : float
        Half the side of the square that is graded [m].
    """
    count = int(np.ceil(2 * half_m / _CELL_M)) + 1
    axis = -half_m + _CELL_M * np.arange(count)
    east, north = np.meshgrid(axis, axis)
    base = relief(np.column_stack([east.ravel(), north.ravel()])).reshape(count, count)
    weight, lift = np.zeros((count, count)), np.zeros((count, count))
    for pad in pads:
        corners = shapely.get_coordinates(pad)[:4]
        middle, along, across = _frame(corners)
        reach = np.linalg.norm(corners - middle, axis=1).max() + _EASE_M + _LEVEL_M
        low, high = (
            np.floor((middle - reach + half_m) / _CELL_M),
            np.ceil((middle + reach + half_m) / _CELL_M),
        )
        j, i = (slice(max(int(a), 1), min(int(b), count - 1)) for a, b in zip(low, high, strict=True))
        x, y = east[i, j] - middle[0], north[i, j] - middle[1]
        u = np.abs(x * along[0] + y * along[1]) - np.linalg.norm(corners[1] - corners[0]) / 2
        v = np.abs(x * across[0] + y * across[1]) - np.linalg.norm(corners[2] - corners[1]) / 2
        distance = np.hypot(np.maximum(u, 0.0), np.maximum(v, 0.0))
        w = _smooth(1.0 - (distance - _LEVEL_M) / _EASE_M)
        ground = float(relief(np.concatenate([corners, (corners + np.roll(corners, 1, axis=0)) / 2])).mean())
        weight[i, j] += w**3
        lift[i, j] += w**4 * (ground - base[i, j])
    outside = ~shapely.contains_xy(street, east.ravel(), north.ravel()).reshape(count, count)
    calm = _smooth(distance_transform_edt(outside) * _CELL_M / _CALM_M)
    shift = lift / np.maximum(weight, 1e-9) * calm
    return Graded(relief, HeightField((-half_m, -half_m), _CELL_M, shift.astype(np.float32)))


def _frame(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Middle and unit axes of a rectangle."""
    along = corners[1] - corners[0]
    along = along / np.linalg.norm(along)
    return corners.mean(axis=0), along, np.array([-along[1], along[0]])


def _smooth(t: np.ndarray) -> np.ndarray:
    """0 to 1 with level ends."""
    t = np.clip(t, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))
