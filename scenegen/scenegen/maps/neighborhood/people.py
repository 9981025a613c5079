"""People who stand about in gardens and on driveways; those on the sidewalks move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.geometry.placement import clear_of, first_come
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import KERB_M
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.people.stand import stand

_RADIUS_M = 0.4


def people(
    parcels: Sequence[Parcel],
    obstacles: np.ndarray,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], np.ndarray]:
    """All people as parts, and where they stand.

    Parameters
    ----------
    parcels
        What was drawn so far.
    obstacles : array of shapely geometries
        Houses, sheds, cars, posts, fences, pools, ways of walkers.
    shop : NeighborhoodWorkshop
    rng : numpy.random.Generator
    """
    wanted = int(rng.poisson(rng.uniform(*shop.knobs.people_per_100_lots) * len(parcels) / 100))
    rows = _at_home(parcels, wanted, rng)
    shapes = shapely.buffer(shapely.points(rows[:, :2]), _RADIUS_M, quad_segs=2)
    rows = rows[first_come(shapes) & clear_of(shapes, obstacles, 0.1)]
    position = np.column_stack([rows[:, :2], shop.relief(rows[:, :2]) + KERB_M])
    return stand(position, rows[:, 2], "standing", shop, rng), rows


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
