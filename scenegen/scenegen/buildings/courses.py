"""Walls of all buildings as one table: courses of storeys, shop floors, blank and party walls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from scenegen.buildings.building import Building, Volume
from scenegen.buildings.styles import Kind, Roof, Style
from scenegen.geometry.facade import BLANK, DOOR, WINDOW, Walls

_SHORT_WALL_M = 2.2
_PARTY_PROBE_M = 0.35


@dataclass(frozen=True, eq=False)
class Course:
    """Walls around all rings of a volume between two heights, one window rhythm."""

    building: int
    rings: tuple[np.ndarray, ...]
    floor_m: float
    foundation_m: float
    top_m: float
    storeys: int
    first_storey_m: float
    pitch_m: float
    share: float
    first_sill_m: float
    first_head_m: float
    surface: int
    grounded: bool


def courses_of(buildings: Sequence[Building]) -> list[Course]:
    """One course per volume, or two where shops fill the ground floor."""
    return [c for k, b in enumerate(buildings) for v in b.volumes for c in _volume_courses(k, b, v)]


def _volume_courses(index: int, building: Building, volume: Volume) -> list[Course]:
    style = building.style
    top = volume.eave_m(style) + (style.parapet_m if volume.form is Roof.FLAT else 0.05)
    grounded = volume.foundation_m > 0.1
    if not (style.shops and grounded and volume.storeys > 1):
        return [
            Course(
                index, volume.rings, volume.floor_m, volume.foundation_m, top, volume.storeys,
                style.first_storey_m, style.pitch_m, style.window_share, style.first_sill_m,
                style.first_head_m, style.wall, grounded,
            )
        ]  # fmt: skip
    first_floor = volume.floor_m + style.first_storey_m
    return [
        Course(
            index, volume.rings, volume.floor_m, volume.foundation_m, first_floor, 1, style.first_storey_m,
            5.2, 0.82, 0.45, style.first_storey_m - 0.9, style.base, True,
        ),
        Course(
            index, volume.rings, first_floor, 0.02, top, volume.storeys - 1, style.storey_m,
            style.pitch_m, style.window_share, style.sill_m, style.head_m, style.wall, False,
        ),
    ]  # fmt: skip


@dataclass(frozen=True, eq=False)
class WallTable:
    """Walls with windows, their fillings, and walls without.

    Attributes
    ----------
    walls : Walls
    filling, glass : int64 (cells,)
        What fills each cell, and its pane: rooms nobody heats have panes of their own.
    blank : float64 (blank, 4, 3)
        Corners of blank walls.
    blank_surface, blank_object : int64 (blank,)
    """

    walls: Walls
    filling: np.ndarray
    glass: np.ndarray
    blank: np.ndarray
    blank_surface: np.ndarray
    blank_object: np.ndarray


def wall_table(buildings: Sequence[Building], rng: np.random.Generator) -> WallTable:
    """Lay out the walls of all buildings and fill their window grids."""
    courses = courses_of(buildings)
    start = np.concatenate([r for c in courses for r in c.rings])
    end = np.concatenate([np.roll(r, -1, axis=0) for c in courses for r in c.rings])
    index = np.concatenate([np.full(len(r), k) for k, c in enumerate(courses) for r in c.rings])
    owner = np.array([c.building for c in courses])[index]
    length = np.linalg.norm(end - start, axis=1)
    blank = (length < _SHORT_WALL_M) | _party(start, end, owner, buildings)
    objects = np.array([b.object for b in buildings])
    surface = np.array([c.surface for c in courses])[index]
    low = np.array([c.floor_m - c.foundation_m for c in courses])[index]
    high = np.array([c.top_m for c in courses])[index]
    quads = np.stack(
        [np.column_stack([p, h])[blank] for p, h in ((start, low), (end, low), (end, high), (start, high))],
        axis=1,
    )
    keep = ~blank
    walls = _walls(courses, buildings, start[keep], end[keep], index[keep])
    filling = _filling(walls, courses, buildings, index[keep], rng)
    glass = _panes(walls, [buildings[c.building].style for c in courses], index[keep], rng)
    return WallTable(walls, filling, glass, quads, surface[blank], objects[owner[blank]])


def _party(
    start: np.ndarray, end: np.ndarray, owner: np.ndarray, buildings: Sequence[Building]
) -> np.ndarray:
    """Walls that stand against another building."""
    along = (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
    probe = (start + end) / 2 + _PARTY_PROBE_M * np.column_stack([along[:, 1], -along[:, 0]])
    tree = shapely.STRtree(np.array([b.footprint for b in buildings], dtype=object))
    wall, hit = tree.query(shapely.points(probe), predicate="within")
    party = np.zeros(len(start), bool)
    party[wall[hit != owner[wall]]] = True
    return party


def _walls(
    courses: Sequence[Course],
    buildings: Sequence[Building],
    start: np.ndarray,
    end: np.ndarray,
    index: np.ndarray,
) -> Walls:
    styles = [buildings[c.building].style for c in courses]

    def column(values: list[float]) -> np.ndarray:
        return np.asarray(np.array(values, np.float64)[index])

    def labels(values: list[int]) -> np.ndarray:
        return np.asarray(np.array(values, np.int64)[index])

    length = np.linalg.norm(end - start, axis=1)
    return Walls(
        start=start,
        end=end,
        floor_m=column([c.floor_m for c in courses]),
        foundation_m=column([c.foundation_m for c in courses]),
        top_m=column([c.top_m for c in courses]),
        storeys=labels([c.storeys for c in courses]),
        first_storey_m=column([c.first_storey_m for c in courses]),
        storey_m=column([s.storey_m for s in styles]),
        columns=np.maximum(np.rint(length / column([c.pitch_m for c in courses])).astype(np.int64), 1),
        window_share=column([c.share for c in courses]),
        sill_m=column([s.sill_m for s in styles]),
        head_m=column([s.head_m for s in styles]),
        first_sill_m=column([c.first_sill_m for c in courses]),
        first_head_m=column([c.first_head_m for c in courses]),
        surface=labels([c.surface for c in courses]),
        glass=labels([s.glass for s in styles]),
        door=labels([s.door for s in styles]),
        object=labels([buildings[c.building].object for c in courses]),
        recess_m=column([s.recess_m for s in styles]),
    )


def _filling(
    walls: Walls,
    courses: Sequence[Course],
    buildings: Sequence[Building],
    index: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray:
    """Windows nearly everywhere, whole columns left out on some walls, doors on the ground."""
    wall, column, storey = walls.cells()
    blank_share = np.array([buildings[c.building].style.blank_share for c in courses])[index]
    shed = np.array([buildings[c.building].kind is Kind.SHED for c in courses])[index]
    grounded = np.array([c.grounded for c in courses])[index]
    filling = np.where(rng.uniform(size=len(wall)) < blank_share[wall], BLANK, WINDOW)
    entrance = (rng.uniform(size=len(index)) * walls.columns).astype(np.int64)
    has_door = grounded & (rng.uniform(size=len(index)) < np.where(shed, 0.7, 0.45))
    filling[(storey == 0) & has_door[wall] & (column == entrance[wall])] = DOOR
    gates = shed[wall] & has_door[wall] & (column % 3 == entrance[wall] % 3)
    filling[(storey == 0) & gates] = DOOR
    return filling


def _panes(walls: Walls, styles: Sequence[Style], index: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Palette index of the pane in each cell; two columns on two storeys belong together."""
    wall, column, storey = walls.cells()
    share = np.array([s.cold_share for s in styles])[index]
    cold = np.array([s.glass if s.cold_glass is None else s.cold_glass for s in styles])[index]
    key = (wall * (storey.max(initial=0) + 1) + storey // 2) * (column.max(initial=0) + 1) + column // 2
    rooms, room = np.unique(key, return_inverse=True)
    unheated = rng.uniform(size=len(rooms))[room.ravel()] < share[wall]
    return np.asarray(np.where(unheated, cold[wall], walls.glass[wall]))
