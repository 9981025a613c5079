"""People who stay where they are: at kerbs and bus stops, on paths and lawns. Those who walk are movers."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come
from scenegen.maps.city.park import ParkPlan
from scenegen.maps.city.stops import Stops
from scenegen.maps.city.streets import KERB_M, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.people.stand import stand

_AT_KERB_M = (0.45, 0.95)
"""How far from the kerb people wait to cross: out of the way of those who walk past."""
_ROOM_M = 0.42
"""Radius that one person takes."""
_EDGE_M = 4.0
_GROUP_M = 0.95
_WAITING_M = (-2.6, -3.2, 3.3)
"""Places beside a shelter, along it."""


def build_people(
    plan: StreetPlan,
    parks: dict[int, ParkPlan],
    stops: Stops,
    taken: np.ndarray,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], np.ndarray]:
    """People as parts, and where they stand (for trees to keep clear of).

    Parameters
    ----------
    plan : StreetPlan
    parks : mapping
        Parks by block index.
    stops : Stops
    taken : array of shapely geometries
        What they must not stand in: vehicles, posts, furniture.
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    crossing, waiting, strolling, bodies = rng.spawn(4)
    count = round(rng.uniform(*shop.knobs.people_standing))
    rows = np.concatenate(
        [
            _at_crossings(plan, count // 2, crossing),
            _at_stops(stops, waiting),
            _in_parks(parks, count - count // 2, strolling),
        ]
    )
    spots = shapely.buffer(shapely.points(rows[:, :2]), _ROOM_M, quad_segs=2)
    keep = clear_of(spots, taken, 0.05)
    keep[np.flatnonzero(keep)] = first_come(spots[keep])
    rows = rows[keep]
    parts = []
    walking = bodies.uniform(size=len(rows)) < 0.25
    for posture, some in (("standing", rows[~walking]), ("walking", rows[walking])):
        position = np.column_stack([some[:, :2], shop.relief(some[:, :2]) + KERB_M])
        parts += stand(position, some[:, 2], posture, shop, bodies)
    return parts, rows[:, :2]


def _at_crossings(plan: StreetPlan, count: int, rng: np.random.Generator) -> Float64[np.ndarray, "people 3"]:
    """At the kerb beside the ends of links, looking across the street."""
    link = rng.integers(len(plan.links), size=count)
    end, right = rng.integers(2, size=count), rng.choice([-1.0, 1.0], count)
    back, aside = rng.uniform(0.6, 2.6, count), rng.uniform(*_AT_KERB_M, count)
    rows = [np.zeros((0, 3))]
    for k in range(count):
        stretch = plan.links[int(link[k])]
        street = plan.streets[stretch.street]
        mark = stretch.start_m + back[k] if end[k] else stretch.end_m - back[k]
        xy, heading = along(
            street.line, np.array([mark]), np.array([right[k] * (street.width_m / 2 + aside[k])])
        )
        rows.append(np.column_stack([xy, heading + right[k] * 0.5 * np.pi]))
    table = np.concatenate(rows)
    table[:, 2] += rng.normal(0.0, 0.3, count)
    blocks = shapely.STRtree(np.asarray(plan.blocks, dtype=object))
    on_kerb = np.zeros(count, bool)
    on_kerb[blocks.query(shapely.points(table[:, :2]), predicate="within")[0]] = True
    return np.asarray(table[on_kerb])


def _at_stops(stops: Stops, rng: np.random.Generator) -> Float64[np.ndarray, "people 3"]:
    """Beside shelters, looking for the bus."""
    rows = [np.zeros((0, 3))]
    for x, y, heading in stops.shelters:
        count = int(rng.integers(0, len(_WAITING_M) + 1))
        at = rng.permutation(_WAITING_M)[:count, None]
        xy = np.array([x, y]) + at * np.array([np.cos(heading), np.sin(heading)])
        rows.append(np.column_stack([xy, heading + np.pi + rng.normal(0.0, 0.6, count)]))
    return np.concatenate(rows)


def _in_parks(
    parks: dict[int, ParkPlan], count: int, rng: np.random.Generator
) -> Float64[np.ndarray, "people 3"]:
    """In groups of one to three, on paths more than on lawns, away from the sidewalks."""
    if not parks or not count:
        return np.zeros((0, 3))
    plans = list(parks.values())
    area = np.array([p.lawn.area for p in plans])
    park = rng.choice(len(plans), count, p=area / area.sum())
    rows = [np.zeros((0, 3))]
    for k in range(len(plans)):
        paths, inner = (
            shapely.union_all(np.array(plans[k].paths, dtype=object)),
            plans[k].lawn.buffer(-_EDGE_M),
        )
        walkable = (
            shapely.intersection(paths.buffer(-0.3), inner),
            shapely.intersection(plans[k].free(), inner),
        )
        for area_of, share in zip(walkable, (0.7, 0.3), strict=True):
            wanted = round(float(share * (park == k).sum()))
            if area_of.is_empty or not wanted:
                continue
            x0, y0, x1, y1 = area_of.bounds
            cloud = rng.uniform((x0, y0), (x1, y1), (40 * wanted, 2))
            cloud = cloud[shapely.contains_xy(area_of, cloud)][: (wanted + 1) // 2]
            mate = cloud + _GROUP_M * _unit(rng.uniform(0.0, 2 * np.pi, len(cloud)))
            both = np.concatenate([cloud, mate])
            heading = np.arctan2(*(np.concatenate([mate, cloud]) - both).T[::-1])
            inside = shapely.contains_xy(area_of, both)
            rows.append(np.column_stack([both, heading])[inside])
    return np.concatenate(rows)


def _unit(angle: np.ndarray) -> np.ndarray:
    return np.column_stack([np.cos(angle), np.sin(angle)])
