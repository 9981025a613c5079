"""People who stay where they are: on the beach, on the pier, at the car park, before the huts."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.pier import WIDTH_M
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.parts.people.stand import stand

_ROOM_M, _APART_M = 0.62, 1.7
_POSTURES = ("standing", "walking", "running")


def build_folk(
    layout: Layout, huts: Float64[np.ndarray, "huts 3"], shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[list[Part], int]:
    """People as parts, and their number.

    Parameters
    ----------
    layout : Layout
    huts : float64 (huts, 3)
        Places and headings.
    shop : CoastWorkshop
    rng : numpy.random.Generator
    """
    wanted = round(rng.uniform(*shop.knobs.people))
    on_pier = _on_pier(layout, round(0.2 * wanted), rng)
    sand = _on_sand(3 * wanted, shop, rng)
    before = huts[:, :2] + 2.6 * np.column_stack([np.cos(huts[:, 2]), np.sin(huts[:, 2])])
    before = before + rng.uniform(-0.6, 0.6, before.shape)
    bays = shapely.get_coordinates(layout.car_park.centroid) + np.array(
        [[-1.3, 0.3], [0.2, -0.4], [1.5, 0.5]]
    )
    spots = np.concatenate([before[rng.uniform(size=len(before)) < 0.4], sand])
    free = shop.coast.inside(spots, 3.0) & (shop.relief(spots) > 0.05)
    free[free] = shop.claims.take(shapely.buffer(shapely.points(spots[free]), _ROOM_M), 0.15)
    spots = np.concatenate([bays, spots[free]])[: max(wanted - len(on_pier), 0)]
    ground = np.concatenate([np.column_stack([spots, shop.relief(spots)]), on_pier])
    posture = rng.choice(len(_POSTURES), len(ground), p=(0.6, 0.33, 0.07))  # on the pier they stand
    posture[len(spots) :] = 0
    heading = rng.uniform(0.0, 2 * np.pi, len(ground))
    parts = []
    for k, name in enumerate(_POSTURES):
        mine = posture == k
        parts += stand(ground[mine], heading[mine], name, shop, rng)
    return parts, len(ground)


def _on_pier(layout: Layout, wanted: int, rng: np.random.Generator) -> np.ndarray:
    """Places along the right railing, apart from each other, from benches and from those who walk in the middle."""
    start, end = layout.pier
    length = float(np.linalg.norm(end - start))
    ahead = (end - start) / length
    cell = rng.permutation(int((length - 6.0) / _APART_M))[:wanted]
    mark = 3.0 + _APART_M * cell + rng.uniform(-0.2, 0.2, len(cell))
    side = 0.28 * WIDTH_M + rng.uniform(-0.06, 0.06, len(cell))
    xy = start + mark[:, None] * ahead + side[:, None] * np.array([ahead[1], -ahead[0]])
    return np.column_stack([xy, np.full(len(xy), layout.pier_deck_m)])


def _on_sand(count: int, shop: CoastWorkshop, rng: np.random.Generator) -> np.ndarray:
    """Groups on the sand and along the water's edge, also ankle-deep in it."""
    coast, groups = shop.coast, max(count // 4, 1)
    s = rng.uniform(-1.2, 1.2, groups) * coast.half_m
    edge = rng.uniform(size=groups) < 0.4
    q = np.where(edge, rng.uniform(0.5, 4.0, groups), rng.uniform(0.2, 0.9, groups) * coast.beach(s))
    sandy = (coast.cliff(s) < 0.3) & coast.inside(coast.plan(s, q), 8.0)
    s, q = s[sandy], q[sandy]
    if not len(s):
        return np.zeros((0, 2))
    pick = rng.integers(len(s), size=count)
    return np.asarray(coast.plan(s, q)[pick] + rng.normal(0.0, 1.1, (count, 2)))
