"""People: walking and running on sidewalks, standing about in gardens and on driveways."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, KERB_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.people.stand import stand

_RADIUS_M = 0.4
_OUTDOORS = 0.55
"""Share of people who are on the sidewalks."""


def people(
    plan: StreetPlan,
    parcels: Sequence[Parcel],
    obstacles: np.ndarray,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], np.ndarray]:
    """All people as parts, and where they stand.

    Parameters
    ----------
    plan, parcels
        What was drawn so far.
    obstacles : array of shapely geometries
        Houses, sheds, cars, posts, fences, pools.
    shop : NeighborhoodWorkshop
    rng : numpy.random.Generator
    """
    wanted = int(rng.poisson(rng.uniform(*shop.knobs.people_per_100_lots) * len(parcels) / 100))
    walkers = _on_sidewalks(plan, round(_OUTDOORS * wanted), rng)
    idlers = _at_home(parcels, wanted - len(walkers), rng)
    rows = np.concatenate([walkers, idlers])
    shapes = shapely.buffer(shapely.points(rows[:, :2]), _RADIUS_M, quad_segs=2)
    keep = first_come(shapes) & clear_of(shapes, obstacles, 0.1)
    keep[: len(walkers)] &= clear_of(shapes[: len(walkers)], np.array([plan.carriageway], dtype=object))
    moving = np.arange(len(rows)) < len(walkers)
    running = moving & (rng.uniform(size=len(rows)) < 0.15)
    parts: list[Part] = []
    for posture, mine in (("walking", moving & ~running), ("running", running), ("standing", ~moving)):
        at = rows[mine & keep]
        position = np.column_stack([at[:, :2], shop.relief(at[:, :2]) + KERB_M])
        parts += stand(position, at[:, 2], posture, shop, rng)
    return parts, rows[keep]


def _on_sidewalks(plan: StreetPlan, count: int, rng: np.random.Generator) -> np.ndarray:
    """Along the streets, in proportion to their length, in both directions."""
    length = np.array([np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in plan.lines])
    street = rng.choice(len(length), count, p=length / length.sum())
    rows = [np.zeros((0, 3))]
    for k in street:
        side = 1.0 if rng.uniform() < 0.5 else -1.0
        right = CARRIAGEWAY_M / 2 + plan.verge_m + plan.walk_m * rng.uniform(0.35, 0.65)
        at = np.array([rng.uniform(6.0, max(length[k] - 6.0, 6.1))])
        xy, heading = along(plan.lines[int(k)], at, np.array([side * right]))
        turn = (np.pi if rng.uniform() < 0.5 else 0.0) + rng.normal(0.0, 0.15)
        rows.append(np.column_stack([xy, heading + turn]))
    return np.concatenate(rows)


def _at_home(parcels: Sequence[Parcel], count: int, rng: np.random.Generator) -> np.ndarray:
    """In gardens: anywhere on the lot; what stands there already is sorted out later."""
    if not parcels or count <= 0:
        return np.zeros((0, 3))
    rows = []
    for k in rng.integers(0, len(parcels), count):
        room = parcels[int(k)].lot.area
        x0, y0, x1, y1 = room.bounds
        for xy in rng.uniform((x0, y0), (x1, y1), (6, 2)):
            if room.contains(shapely.Point(xy)):
                rows.append([*xy, rng.uniform(0.0, 2 * np.pi)])
                break
    return np.array(rows).reshape(-1, 3)
