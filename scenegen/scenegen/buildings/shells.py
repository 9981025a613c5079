"""Building plans become geometry: walls, balconies, string courses, parapets, roofs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from scenegen.buildings.balconies import build_balconies, plan_balconies
from scenegen.buildings.building import Building
from scenegen.buildings.courses import wall_table
from scenegen.buildings.roofs import PARAPET_WIDTH_M, Storeys, flat_roofs, sloped_roofs
from scenegen.buildings.styles import Roof
from scenegen.classes import Semantic
from scenegen.geometry.facade import facades
from scenegen.geometry.hidden import push_out
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.patch import patches
from scenegen.geometry.rings import inset, strip

_BLANK_SPACING_M = 4.0
_BAND_M = 0.14
_FIRST_SITE_M = 0.15
_PANES_PER_SITE = (2, 2)
_BESIDE_M = 0.5
"""Distance of the sites of pitched roofs from stacks."""


def build_shells(buildings: Sequence[Building], roof_plans: np.ndarray, rng: np.random.Generator) -> Part:
    """Walls with windows, parapets and roofs.

    Parameters
    ----------
    buildings : sequence of Building
    roof_plans : array of shapely.Polygon
        Plan of what will stand on roofs, rectangles.
    rng : numpy.random.Generator
    """
    table = wall_table(buildings, rng)
    wall = np.full(len(table.blank), int(Semantic.WALL))
    blank = patches(table.blank, _BLANK_SPACING_M, table.blank_surface, wall, table.blank_object)
    blank = _sites_above_ground(blank, buildings)
    volumes = [(b, v) for b in buildings for v in b.volumes]
    balconies = plan_balconies(table.walls, table.filling, buildings, rng)
    return concatenate(
        [
            facades(
                table.walls,
                table.filling,
                balconies.walls(len(table.walls.start)),
                _PANES_PER_SITE,
                table.glass,
            ),
            build_balconies(table.walls, balconies),
            blank,
            _trim(volumes),
            flat_roofs(volumes, roof_plans, rng),
            push_out(sloped_roofs(volumes), roof_plans, _BESIDE_M),
        ]
    )


def _sites_above_ground(walls: Part, buildings: Sequence[Building]) -> Part:
    """Lift the sites of the foundation row to just above the floor: below ground they would see nothing."""
    owner = np.zeros(len(walls.site_position), np.int64)
    owner[walls.corner_site.ravel()] = np.repeat(walls.object, 3)
    known = np.array([b.object for b in buildings])
    floors = np.array([b.volumes[0].floor_m for b in buildings])
    order = np.argsort(known)
    floor = floors[order[np.searchsorted(known, owner, sorter=order)]]
    position = walls.site_position.copy()
    position[:, 2] = np.maximum(position[:, 2], floor + _FIRST_SITE_M)
    return replace(walls, site_position=position)


def _trim(volumes: Storeys) -> Part:
    """Parapets of flat roofs and the string courses above shops."""
    quads: list[np.ndarray] = []
    surface: list[np.ndarray] = []
    owner: list[np.ndarray] = []
    for building, volume in volumes:
        style = building.style
        for ring in volume.rings:
            pieces = _parapet(ring, volume.eave_m(style), style.parapet_m) if volume.form is Roof.FLAT else []
            if style.shops and volume.foundation_m > 0.1 and volume.storeys > 1:
                pieces += _band(ring, volume.floor_m + style.first_storey_m)
            for piece in pieces:
                quads.append(piece)
                surface.append(np.full(len(piece), style.wall))
                owner.append(np.full(len(piece), building.object))
    labels = np.full(sum(len(s) for s in surface), int(Semantic.WALL))
    corners = np.concatenate(quads)
    return patches(corners, 9.0, np.concatenate(surface), labels, np.concatenate(owner), lumped_rows=True)


def _parapet(ring: np.ndarray, roof_m: float, height_m: float) -> list[np.ndarray]:
    """Coping and inner side."""
    inner = inset(ring, PARAPET_WIDTH_M)
    top = roof_m + height_m
    inside = strip(inner, roof_m - 0.05, inner, top)[:, [1, 0, 3, 2]]
    return [strip(ring, top, inner, top), inside]


def _band(ring: np.ndarray, height_m: float) -> list[np.ndarray]:
    """A string course that covers the joint between two courses of a facade."""
    outer = inset(ring, -_BAND_M)
    low, high = height_m - 0.2, height_m + 0.15
    return [
        strip(ring, low, outer, low),
        strip(outer, low, outer, high),
        strip(outer, high, ring, high),
    ]
