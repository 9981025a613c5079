"""The elevated railway as geometry: girder, barriers, rails, piers, masts and wires."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.boxes import boxes
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along
from scenegen.geometry.sweep import sweep
from scenegen.geometry.template import Template, place
from scenegen.maps.city.streets import StreetPlan
from scenegen.maps.city.viaduct import GIRDER_M, Viaduct
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.fixtures.wires import wires
from scenegen.parts.skin import Skin

_HALF_WIDTH_M, _CAP_M = 4.3, 1.2
_BARRIER_M, _BED_M, _RAIL_M = 1.0, 0.3, 0.16
_TRACKS_M, _GAUGE_M = (-1.9, 1.9), 1.435
_BURIED_M, _FAR_BURIED_M = 1.0, 4.0
"""How deep piers reach: the land around is coarser."""
_MAST_M, _WIRE_M = 6.4, 5.3
_COLUMN_SITE = 0.55
"""Height of a column's sites in heights of the column: above whatever drives past."""


def build_viaduct(viaduct: Viaduct, plan: StreetPlan, shop: CityWorkshop) -> list[Part]:
    """The railway as parts."""
    concrete = shop.palette.variants("concrete_structure", 2)
    bridge = shop.builder.new_objects()
    return [
        _girder(viaduct, bridge, concrete[0], shop),
        *_rails(viaduct, bridge, shop),
        *_piers(viaduct, plan, bridge, concrete[1], shop),
        *_line_gear(viaduct, shop),
    ]


def _girder(viaduct: Viaduct, bridge: int, concrete: int, shop: CityWorkshop) -> Part:
    """Box girder with cantilevers, barriers on its edges, and a bed of ballast."""
    w, t, b = _HALF_WIDTH_M, 0.25, _BED_M
    half = [(1.5, -GIRDER_M), (w, -0.55), (w, 0.0), (w, _BARRIER_M), (w - t, _BARRIER_M), (w - t, 0.0), (3.5, 0.0),
            (3.2, b)]  # fmt: skip
    other = [(-x, z) for x, z in half[::-1]]
    profile = np.array([*half, (0.0, b), *other, half[0]])
    barrier = np.isin(np.arange(len(profile) - 1), [2, 3, 4, 11, 12, 13])
    ballast = np.isin(np.arange(len(profile) - 1), [6, 7, 8, 9])
    guard = shop.builder.new_objects()
    stone = shop.palette.only("granite")
    return sweep(
        viaduct.line,
        profile,
        np.where(ballast, stone, concrete),
        np.where(barrier, int(Semantic.BARRIER), int(Semantic.BRIDGE)),
        np.where(barrier, guard, bridge),
    )


def _rails(viaduct: Viaduct, bridge: int, shop: CityWorkshop) -> list[Part]:
    """Four rails on the bed. Sides and top have sites of their own: one sees hot ballast, the other the sky."""
    steel = shop.palette.only("steel_oxidised")
    parts = []
    for track in _TRACKS_M:
        for side in (-0.5, 0.5):
            x, z = track + side * _GAUGE_M, _BED_M
            profile = np.array(
                [[x + 0.05, z], [x + 0.04, z + _RAIL_M], [x - 0.04, z + _RAIL_M], [x - 0.05, z]]
            )
            skin, label, owner = (np.full(3, v, np.int64) for v in (steel, int(Semantic.BRIDGE), bridge))
            parts.append(sweep(viaduct.line, profile, skin, label, owner))
    return parts


def _piers(viaduct: Viaduct, plan: StreetPlan, bridge: int, concrete: int, shop: CityWorkshop) -> list[Part]:
    """Columns with hammerheads, and a block at each end of the line."""
    piers = viaduct.piers
    line = shapely.LineString(viaduct.line[:, :2])
    at = shapely.line_locate_point(line, shapely.points(piers[:, :2]))
    marks = shapely.line_locate_point(line, shapely.points(viaduct.line[:, :2]))
    top = np.interp(at, marks, viaduct.line[:, 2]) - GIRDER_M + 0.03
    ground = shop.relief(piers[:, :2])
    inside = shapely.contains_xy(plan.outline, piers[:, :2])
    foot = ground - np.where(inside, _BURIED_M, _FAR_BURIED_M)
    count = len(piers)
    skins, owner = np.full((count, 1), concrete), np.full(count, bridge)
    size = np.full(count, viaduct.radius_m)
    columns = place(
        _column(),
        np.column_stack([piers[:, :2], foot]),
        piers[:, 2],
        np.column_stack([size, size, top - 0.1 - foot]),
        skins,
        owner,
    )
    caps = place(
        _hammerhead(viaduct.radius_m), np.column_stack([piers[:, :2], top]), piers[:, 2], np.ones((count, 3)), skins,
        owner,
    )  # fmt: skip
    ends = viaduct.line[[0, -1]]
    heading = np.arctan2(*(viaduct.line[[1, -1], 1::-1] - viaduct.line[[0, -2], 1::-1]).T)
    low = shop.relief(ends[:, :2]) - _FAR_BURIED_M
    blocks = boxes(
        np.column_stack([ends[:, :2], low]),
        np.column_stack([np.full(2, 8.0), np.full(2, 10.0), ends[:, 2] + 1.4 - low]),
        heading,
        np.full(2, concrete),
        np.full(2, int(Semantic.BRIDGE)),
        np.full(2, bridge),
        spacing_m=10.0,
    )
    return [columns, caps, blocks]


def _column() -> Template:
    """A round column of unit radius and height. Slot: 0."""
    model = Modeller()
    model.tube(np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0, 1.0, 0, Semantic.BRIDGE, sides=14, sites=4)
    column = model.finish()
    position = column.site_position.copy()
    position[:, 2] = _COLUMN_SITE
    return replace(column, site_position=position)


def _hammerhead(radius_m: float) -> Template:
    """A cap that widens from a column to the bearings; its top at z = 0. Slot: 0."""
    a, low, high, z = radius_m + 0.1, radius_m + 0.15, 1.9, -_CAP_M
    bottom = [[-a, -low, z], [a, -low, z], [a, low, z], [-a, low, z]]
    top = [[-a, -high, 0.0], [a, -high, 0.0], [a, high, 0.0], [-a, high, 0.0]]
    p = np.array(bottom + top)
    model = Modeller()
    sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [3, 2, 1, 0]]
    model.quads(p[sides], 0, Semantic.BRIDGE)
    return model.finish()


def _line_gear(viaduct: Viaduct, shop: CityWorkshop) -> list[Part]:
    """Masts at the edges of the deck with arms over the tracks, and the wires they carry."""
    steel, cable = shop.palette.variants("steel_galv_post", 2)[0], shop.palette.only("cable_weathered")
    plan_line = viaduct.line[:, :2]
    mark = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(plan_line, axis=0), axis=1))])
    masts = viaduct.masts_m[viaduct.masts_m < mark[-1]]
    count = len(masts)
    xy, heading = along(plan_line, masts, np.zeros(count))
    level = np.interp(masts, mark, viaduct.line[:, 2])
    owner = shop.builder.new_objects(count) + np.arange(count)
    posts = place(
        _portal(),
        np.column_stack([xy, level]),
        heading,
        np.ones((count, 3)),
        np.full((count, 1), steel),
        owner,
    )
    net = np.full(count - 1, shop.builder.new_objects())
    parts = [posts]
    for track in _TRACKS_M:
        right = np.column_stack([np.sin(heading), -np.cos(heading)]) * track
        for up, sag in ((_WIRE_M, 0.05), (_MAST_M - 0.05, 0.75)):
            points = np.column_stack([xy + right, level + up])
            parts.append(
                wires(
                    points[:-1], points[1:], np.full(count - 1, sag), 0.012, cable, int(Semantic.WIRE), net, 6
                )
            )
    return parts


def _portal() -> Template:
    """Two masts on the edges of a deck with a beam between them over the tracks (along y). Slot: 0."""
    skin = Skin(Semantic.POLE)
    side = _HALF_WIDTH_M - 0.55
    for y in (-side, side):
        skin.tube((0.0, y, -0.1), (0.0, y, _MAST_M + 0.3), (0.11, 0.08), 0)
    skin.box((-0.07, -side, _MAST_M - 0.1), (0.07, side, _MAST_M + 0.05), 0)
    for track in _TRACKS_M:
        skin.tube((0.0, track, _MAST_M), (0.0, track, _WIRE_M - 0.03), (0.03, 0.03), 0, 4)
    skin.around(0, (0.0, side, 3.0))
    skin.site(0, (0.0, 0.0, _MAST_M + 0.05), (0.0, 0.0, 1.0))
    skin.site(0, (0.0, 0.0, _MAST_M - 0.1), (0.0, 0.0, -1.0))
    return skin.finish()
