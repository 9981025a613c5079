"""Emitter groups: the handful of kinds of neighbour a site can exchange long-wave radiation and reflected sun with.

The number is fixed for all worlds, so that arrays keep their shape. A group is a function of material build and
orientation only, hence of the thermal class.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from jaxtyping import Int64, UInt8

from scenegen.heat.classes import (
    DOWN,
    FIRST_SLOPE,
    FIRST_WALL,
    ORIENTATIONS,
    SLOPE_AZIMUTHS,
    WALL_AZIMUTHS,
    site_orientations,
)
from scenegen.materials.material import Build, Surface
from scenegen.world import World


class _First(IntEnum):
    """First group of each family."""

    DARK_GROUND = 0
    PALE_GROUND = 1
    PLANT_GROUND = 2
    CROWN_TOP = 3
    CROWN_SIDE = 4
    FLAT_ROOF = 5
    SLOPED_ROOF = 6  # four quarters of the compass
    WALL = 10  # eight directions
    WINDOW = 18  # four directions
    UNDERSIDE = 22
    VEHICLE = 23
    WATER = 24
    OTHER = 25


EMITTER_GROUPS = 26
"""Number of groups; the columns of `Exposure.neighbour_share`."""
GROUND_GROUPS = (_First.DARK_GROUND, _First.PALE_GROUND, _First.PLANT_GROUND)
"""What lies below whatever stands or drives."""
WATER_GROUP = _First.WATER
_DARK_ABSORPTANCE = 0.75


def group_sites(world: World) -> tuple[UInt8[np.ndarray, "sites"], int]:
    """Emitter group of each site, and the number of groups (always `EMITTER_GROUPS`)."""
    table = np.array([[group(s, o) for o in range(ORIENTATIONS)] for s in world.palette], dtype=np.uint8)
    return table[world.sites.surface, site_orientations(world)], EMITTER_GROUPS


def group_classes(
    palette: tuple[Surface, ...],
    entry: Int64[np.ndarray, "classes"],
    orientation: Int64[np.ndarray, "classes"],
) -> Int64[np.ndarray, "classes"]:
    """Emitter group of each thermal class."""
    return np.array(
        [group(palette[p], int(o)) for p, o in zip(entry, orientation, strict=True)], dtype=np.int64
    )


def group(surface: Surface, orientation: int) -> int:
    """Emitter group of one palette entry facing one way."""
    build = surface.material.build
    if build is Build.LEAF:
        return _First.CROWN_TOP if orientation < FIRST_WALL and orientation != DOWN else _First.CROWN_SIDE
    if build is Build.VEHICLE:
        return _First.VEHICLE
    if build is Build.WATER:
        return _First.WATER
    if build in (Build.PANEL, Build.HUMAN):
        return _First.OTHER
    if orientation == DOWN:
        return _First.UNDERSIDE
    if orientation >= FIRST_WALL:
        if build is Build.WINDOW:
            return _First.WINDOW + _sector(orientation - FIRST_WALL, WALL_AZIMUTHS, 4)
        return _First.WALL + _sector(orientation - FIRST_WALL, WALL_AZIMUTHS, 8)
    return _level_group(surface, orientation)


def _level_group(surface: Surface, orientation: int) -> int:
    """Group of anything that looks up, flat or sloped."""
    build = surface.material.build
    if build is Build.CANOPY_GROUND:
        return _First.PLANT_GROUND
    if build is Build.GROUND:
        dark = surface.material.solar_absorptance >= _DARK_ABSORPTANCE
        return _First.DARK_GROUND if dark else _First.PALE_GROUND
    if orientation < FIRST_SLOPE:
        return _First.FLAT_ROOF
    return _First.SLOPED_ROOF + _sector((orientation - FIRST_SLOPE) % SLOPE_AZIMUTHS, SLOPE_AZIMUTHS, 4)


def _sector(azimuth: int, fine: int, coarse: int) -> int:
    """Coarse sector of the compass, centred on north, that a fine one belongs to."""
    per = fine // coarse
    return (azimuth + per // 2) // per % coarse
