"""Where an elevated railway runs: over the middle of an arterial, and on over the land around.

Streets run beneath it and cross under it; whoever flies may too. Its piers stand between the lanes, clear of
junctions and crossings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.placement import along, rectangles
from scenegen.maps.city.outskirts import FAR_M, road_lines
from scenegen.maps.city.streets import Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop

GIRDER_M = 1.9
"""Depth of the girder."""
_STATION_M, _FAR_STATION_M = 9.0, 36.0
_CLEAR_M, _END_M = 6.0, 80.0
"""How far piers keep from the ends of links, and the line from the edge of the land."""


@dataclass(frozen=True, eq=False)
class Viaduct:
    """Plan of the railway.

    Attributes
    ----------
    street : int
        Arterial it follows.
    line : float64 (stations, 3)
        Middle of the deck's upper side [m].
    piers : float64 (piers, 3)
        Place and heading [m, m, rad].
    radius_m : float
        Of the columns.
    masts_m : float64 (masts,)
        Distances of the masts along the line.
    """

    street: int
    line: Float64[np.ndarray, "stations 3"]
    piers: Float64[np.ndarray, "piers 3"]
    radius_m: float
    masts_m: Float64[np.ndarray, "masts"]

    def outlines(self, within: shapely.Polygon) -> np.ndarray:
        """Plans of the columns inside a polygon, with the strip of ground they hide, as shapely polygons."""
        size = np.full(len(self.piers), 2 * self.radius_m + 0.4)
        plans = rectangles(self.piers[:, :2], size, size, self.piers[:, 2])
        return np.asarray(plans[shapely.contains(within, plans)])


def plan_viaduct(plan: StreetPlan, shop: CityWorkshop, rng: np.random.Generator) -> Viaduct | None:
    """Lay a railway over the longest arterial and on along the roads at its ends; None where there is none.

    Parameters
    ----------
    plan : StreetPlan
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    knobs = shop.knobs
    chance, clearance = rng.uniform(), rng.uniform(*knobs.viaduct_clearance_m)
    span, radius = rng.uniform(*knobs.viaduct_span_m), rng.uniform(0.6, 0.9)
    arterials = [k for k, s in enumerate(plan.streets) if s.rank is Rank.ARTERIAL]
    if not arterials or chance >= knobs.viaduct_chance:
        return None
    street = max(arterials, key=lambda k: shapely.LineString(plan.streets[k].line).length)
    route, start_m = _route(plan, street)
    length = shapely.LineString(plan.streets[street].line).length
    total = shapely.LineString(route).length
    near = np.arange(start_m - 60.0, start_m + length + 60.0, _STATION_M)
    mark = np.concatenate(
        [
            np.arange(0.0, near[0] - 5.0, _FAR_STATION_M),
            near,
            np.arange(near[-1] + 5.0, total, _FAR_STATION_M),
        ]
    )
    mark = mark[(mark >= 0.0) & (mark <= total)]
    xy, _ = along(route, mark, np.zeros(len(mark)))
    high = clearance + GIRDER_M + _highest(route, mark, total, shop)
    piers = _pier_marks(plan, street, start_m, length, total, span)
    at, heading = along(route, piers, np.zeros(len(piers)))
    masts = np.arange(0.5 * span, total, 1.15 * span)
    return Viaduct(
        street, np.column_stack([xy, high]), np.column_stack([at, heading]), radius, masts[masts < total]
    )


def _route(plan: StreetPlan, street: int) -> tuple[np.ndarray, float]:
    """The arterial with the roads that go on from its ends, and where on it the arterial starts [m]."""
    line = plan.streets[street].line
    inside = shapely.box(*(np.array([-1.0, -1.0, 1.0, 1.0]) * (FAR_M - _END_M)))
    pieces, start_m = [line], 0.0
    for (end, _), road in zip(plan.exits, road_lines(plan), strict=True):
        points = shapely.get_coordinates(shapely.get_parts(shapely.intersection(road, inside))[0])[1:]
        if np.linalg.norm(end - line[0]) < 1e-6:
            pieces.insert(0, points[::-1])
            start_m = float(
                np.linalg.norm(np.diff(np.vstack([points[::-1], line[:1]]), axis=0), axis=1).sum()
            )
        elif np.linalg.norm(end - line[-1]) < 1e-6:
            pieces.append(points)
    return np.concatenate(pieces), start_m


def _highest(route: np.ndarray, mark: np.ndarray, total: float, shop: CityWorkshop) -> np.ndarray:
    """Height of the highest ground within 60 m along the line, smoothed: rails do not follow every rise."""
    fine = np.arange(0.0, total, 10.0)
    ground = shop.relief(along(route, fine, np.zeros(len(fine)))[0])
    padded = np.pad(ground, 12, mode="edge")
    top = np.lib.stride_tricks.sliding_window_view(padded, 13).max(axis=1)
    smooth = np.lib.stride_tricks.sliding_window_view(top, 13).mean(axis=1)
    return np.asarray(np.interp(mark, fine, smooth))


def _pier_marks(
    plan: StreetPlan, street: int, start_m: float, length_m: float, total_m: float, span_m: float
) -> np.ndarray:
    """Distances of piers: evenly between junctions, and outside the city."""
    free = [
        (start_m + k.start_m + _CLEAR_M, start_m + k.end_m - _CLEAR_M)
        for k in plan.links
        if k.street == street
    ]
    free += [(2.0, start_m - 14.0), (start_m + length_m + 14.0, total_m - 2.0)]
    marks = []
    for a, b in free:
        if b - a > 6.0:
            marks.append(np.linspace(a, b, max(round((b - a) / span_m), 1) + 1))
        elif b > a:
            marks.append(np.array([0.5 * (a + b)]))
    found = np.unique(np.concatenate(marks))
    return np.asarray(found[np.concatenate([[True], np.diff(found) > 5.0])])
