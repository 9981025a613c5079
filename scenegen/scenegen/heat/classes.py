"""Thermal classes of a world: sites of one palette entry that face the same way share one solution of the day."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int64

from scenegen.materials.material import Build
from scenegen.world import World

WALL_AZIMUTHS = 8
SLOPE_AZIMUTHS = 8
UP, DOWN, FIRST_SLOPE = 0, 1, 2
FIRST_WALL = FIRST_SLOPE + 2 * SLOPE_AZIMUTHS
ORIENTATIONS = FIRST_WALL + WALL_AZIMUTHS
"""Up, down, two steepnesses of roofs and walls, each in eight directions."""

_FLAT_COS, _STEEP_COS, _WALL_COS, _DOWN_COS = 0.978, 0.82, 0.26, -0.5
"""Normals within 12, 35, 75 and beyond 120 degrees of vertical."""


@dataclass(frozen=True, eq=False)
class ThermalClasses:
    """Which sites share a solution.

    Attributes
    ----------
    palette : int64 (classes,)
        Palette index.
    orientation : int64 (classes,)
        Bin of `orientation_bin`.
    normal : float64 (classes, 3)
        Area-weighted mean normal of the members.
    area_m2 : float64 (classes,)
    order : int64 (sites,)
        Sites sorted by class, in site order within each.
    start : int64 (classes + 1,)
        Class c owns ``order[start[c]:start[c + 1]]``.
    """

    palette: Int64[np.ndarray, "classes"]
    orientation: Int64[np.ndarray, "classes"]
    normal: Float64[np.ndarray, "classes 3"]
    area_m2: Float64[np.ndarray, "classes"]
    order: Int64[np.ndarray, "sites"]
    start: Int64[np.ndarray, "starts"]

    @staticmethod
    def of(world: World) -> ThermalClasses:
        """Classes that occur in a world, by palette index, then orientation."""
        sites = world.sites
        key = sites.surface.astype(np.int64) * ORIENTATIONS + site_orientations(world)
        present, member = np.unique(key, return_inverse=True)
        count = present.size
        weight = sites.area.astype(np.float64) + 1e-9  # a site without area still belongs somewhere
        area = np.bincount(member, weights=weight, minlength=count)
        normal = np.stack(
            [
                np.bincount(member, weights=weight * sites.normal[:, axis], minlength=count)
                for axis in range(3)
            ],
            axis=1,
        )
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        return ThermalClasses(
            palette=present // ORIENTATIONS,
            orientation=present % ORIENTATIONS,
            normal=normal / np.maximum(length, 1e-12),
            area_m2=area,
            order=np.argsort(member, kind="stable"),
            start=np.concatenate([[0], np.cumsum(np.bincount(member, minlength=count))]).astype(np.int64),
        )

    def members(self, index: int) -> Int64[np.ndarray, "members"]:
        """Sites of one class."""
        return self.order[self.start[index] : self.start[index + 1]]


def site_orientations(world: World) -> Int64[np.ndarray, "sites"]:
    """Orientation bin of each site: fine for buildings, one of ten for everything smaller.

    Crowns, cars, trunks and kerbs have all directions; a quarter turn is near enough for them, because every site
    keeps its own sun and only the shape of the class's day is shared.
    """
    fine = orientation_bin(world.sites.normal)
    small = np.array([s.material.build not in _BUILDING for s in world.palette], dtype=bool)
    return np.where(small[world.sites.surface], _QUARTERS[fine], fine)


def _quarters() -> Int64[np.ndarray, "orientations"]:
    """For each bin the one that stands for its quarter of the compass; both steepnesses of slopes together."""
    bins = np.arange(ORIENTATIONS)
    for o in range(FIRST_SLOPE, FIRST_WALL):
        bins[o] = FIRST_SLOPE + ((o - FIRST_SLOPE) % SLOPE_AZIMUTHS + 1) // 2 % 4 * 2
    for o in range(FIRST_WALL, ORIENTATIONS):
        per = WALL_AZIMUTHS // 4
        bins[o] = FIRST_WALL + (o - FIRST_WALL + per // 2) // per % 4 * per
    return bins


_QUARTERS = _quarters()
_BUILDING = frozenset({Build.WALL_INSULATED, Build.WINDOW, Build.ROOF_INSULATED, Build.ROOF_VENTILATED})


def orientation_bin(normal: Float32[np.ndarray, "sites 3"]) -> Int64[np.ndarray, "sites"]:
    """Orientation bin of outward unit normals, 0 .. `ORIENTATIONS` - 1; azimuth sectors are centred on north."""
    up = normal[:, 2]
    turn = np.arctan2(normal[:, 0], normal[:, 1]).astype(np.float64) / (2.0 * np.pi)
    wall = FIRST_WALL + np.floor(turn * WALL_AZIMUTHS + 0.5).astype(np.int64) % WALL_AZIMUTHS
    slope = FIRST_SLOPE + np.floor(turn * SLOPE_AZIMUTHS + 0.5).astype(np.int64) % SLOPE_AZIMUTHS
    steep = slope + SLOPE_AZIMUTHS
    return np.select(
        [up > _FLAT_COS, up > _STEEP_COS, up > _WALL_COS, up >= _DOWN_COS],
        [np.full_like(wall, UP), slope, steep, wall],
        DOWN,
    )
