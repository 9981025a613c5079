"""The garden behind a house: patio, pool with its coping, shed, vegetable bed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from scenegen.buildings.detached.body import Body, outline
from scenegen.buildings.lots import Lot
from scenegen.maps.neighborhood.streets import StreetPlan

UNDER_M = 1.4
"""How far paving reaches below the house: its edge there would only cut the ground beside the wall."""

_BORDER_M = 1.3
_TRIES = 16
_COPING_M = 1.1


@dataclass(frozen=True, eq=False)
class Garden:
    """Pieces of one garden in the world's plan.

    Attributes
    ----------
    patio, coping, pool, bed : shapely.Polygon or None
        The coping surrounds the pool.
    """

    patio: shapely.Polygon | None = None
    coping: shapely.Polygon | None = None
    pool: shapely.Polygon | None = None
    bed: shapely.Polygon | None = None

    @property
    def paved(self) -> list[shapely.Polygon]:
        """All pieces that are no lawn; a coping stands for its pool."""
        return [g for g in (self.patio, self.coping, self.bed) if g is not None]


def plan_garden(
    lot: Lot,
    bodies: tuple[Body, ...],
    hut: Body | None,
    driveway: shapely.Polygon | None,
    plan: StreetPlan,
    pool: bool,
    rng: np.random.Generator,
) -> tuple[Garden, Body | None]:
    """Lay out one garden.

    Parameters
    ----------
    lot : Lot
    bodies : tuple of Body
        Of the house, in the lot's frame.
    hut : Body or None
        The shed that is wanted, about the origin.
    driveway : shapely.Polygon or None
        In the world.
    plan : StreetPlan
    pool : bool
        Whether a pool is wanted.
    rng : numpy.random.Generator

    Returns
    -------
    garden : Garden
    hut : Body or None
        The shed in its place, in the lot's frame; None if there is no room.
    """
    house = outline(bodies)
    back = max(b.y1_m for b in bodies)
    room = lot.local().buffer(-_BORDER_M, join_style="mitre")
    taken = house.buffer(0.9, join_style="mitre")
    patio = _patio(bodies, room, rng)
    if patio is not None:
        taken = taken.union(patio.buffer(0.5))
    if driveway is not None:
        local = _local(lot, driveway)
        taken = taken.union(local.buffer(0.5))
    free = room.difference(taken)
    basin = None
    if pool:
        basin = _place(free, [_basin(rng) for _ in range(_TRIES)], (back, 1.2, 7.0), _COPING_M + 0.1, rng)
        if basin is not None:
            free = free.difference(basin.buffer(_COPING_M + 0.5))
    stands = None
    if hut is not None:
        box = shapely.box(hut.x0_m, hut.y0_m, hut.x1_m, hut.y1_m)
        spot = _place(free, [box] * _TRIES, (back, 4.0, 30.0), 0.25, rng)
        if spot is not None:
            x0, y0, _, _ = spot.bounds
            stands = hut.moved(x0 - hut.x0_m, y0 - hut.y0_m, False)
            free = free.difference(spot.buffer(0.7))
    bed = None
    if rng.uniform() < 0.3:
        size = rng.uniform((2.0, 2.5), (3.5, 6.0))
        bed = _place(free, [shapely.box(0, 0, *size)] * _TRIES, (back, 2.0, 30.0), 0.2, rng)
    coping = None if basin is None else basin.buffer(_COPING_M, join_style="mitre", quad_segs=3)
    pieces = [None if g is None else _world(lot, g) for g in (patio, coping, basin, bed)]
    return Garden(*pieces), stands


def _patio(
    bodies: tuple[Body, ...], room: shapely.Polygon, rng: np.random.Generator
) -> shapely.Polygon | None:
    """A terrace against the widest free stretch of the back wall of the main body."""
    main = bodies[0]
    behind = [b for b in bodies[1:] if abs(b.y0_m - main.y1_m) < 1e-6]
    a, b = main.x0_m, main.x1_m
    for wing in behind:
        a, b = (wing.x1_m, b) if b - wing.x1_m > wing.x0_m - a else (a, wing.x0_m)
    if b - a < 3.0 or rng.uniform() < 0.12:
        return None
    wide = min(rng.uniform(3.5, 6.5), b - a - 0.3)
    x = rng.uniform(a + 0.1, b - 0.1 - wide)
    deep = rng.uniform(2.4, 4.2)
    open_part = shapely.box(x, main.y1_m, x + wide, main.y1_m + deep)
    under = shapely.box(x, main.y1_m - UNDER_M, x + wide, main.y1_m + deep)
    return under if room.buffer(0.5).contains(open_part) else None


def _basin(rng: np.random.Generator) -> shapely.Polygon:
    """The outline of a pool about its lower left corner: a rectangle, a rounded one, or a kidney."""
    a, b = rng.uniform(3.2, 4.6), rng.uniform(6.5, 10.0)
    kind = int(rng.integers(3))
    if kind == 0:
        shape = shapely.box(0, 0, b, a)
    elif kind == 1:
        shape = shapely.box(1.2, 1.2, b - 1.2, a - 1.2).buffer(1.2, quad_segs=4)
    else:
        turn = np.linspace(0.0, 2 * np.pi, 22, endpoint=False)
        radius = 1.0 + 0.22 * np.cos(turn) - 0.13 * np.cos(2 * turn) - 0.2 * np.sin(turn)
        shape = shapely.Polygon(
            np.column_stack([b / 2 * radius * np.cos(turn), a / 2 * 1.15 * radius * np.sin(turn)])
        )
    if rng.uniform() < 0.35:
        shape = shapely.affinity.rotate(shape, 90.0, origin=(0, 0))
    x0, y0, _, _ = shape.bounds
    return shapely.affinity.translate(shape, -x0, -y0)


def _place(
    free: shapely.Geometry,
    shapes: list[shapely.Polygon],
    rows: tuple[float, float, float],
    gap_m: float,
    rng: np.random.Generator,
) -> shapely.Polygon | None:
    """The first shape that finds room behind the house.

    Parameters
    ----------
    free : shapely.Geometry
    shapes : list of shapely.Polygon
        Their lower left corner at the origin.
    rows : (float, float, float)
        y of the back of the house; how far behind it the shape begins, from and to.
    gap_m : float
        Around the shape.
    rng : numpy.random.Generator
    """
    if free.is_empty:
        return None
    x0, _, x1, y1 = free.bounds
    count = len(shapes)
    x = rng.uniform(x0, x1, count)
    y = np.minimum(rows[0] + rng.uniform(rows[1], rows[2], count), max(y1 - 2.0, rows[0]))
    grown = shapely.buffer(np.array(shapes, dtype=object), gap_m, quad_segs=2)
    points, item = shapely.get_coordinates(grown, return_index=True)
    moved = shapely.set_coordinates(grown, points + np.column_stack([x, y])[item])
    shapely.prepare(free)
    fits = shapely.contains(free, moved)
    if not fits.any():
        return None
    k = int(np.argmax(fits))
    return shapely.affinity.translate(shapes[k], float(x[k]), float(y[k]))


def _local(lot: Lot, shape: shapely.Polygon) -> shapely.Polygon:
    moved = shapely.affinity.translate(shape, -lot.corner[0], -lot.corner[1])
    return shapely.affinity.rotate(moved, -lot.heading_rad, origin=(0, 0), use_radians=True)


def _world(lot: Lot, shape: shapely.Polygon) -> shapely.Polygon:
    return shapely.Polygon(lot.world(shapely.get_coordinates(shape.exterior)[:-1]))
