"""Boats: under way on rings, or at anchor; both answer to the waves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.relief import Relief
from scenegen.movers.bodies import boats
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import Pace, ring_route, standing
from scenegen.movers.sway import Sway, swaying
from scenegen.parts.workshop import Workshop

HEADWAY_S = 25.0
"""Least time between two boats on one ring."""
FLEET: Mapping[str, float] = {"motor": 0.45, "sailing": 0.35, "fishing": 0.2}
"""Kinds of boat under way and their shares."""


def sail(
    rings: Sequence[Float64[np.ndarray, "_ 2"]],
    per_km: float,
    shop: Workshop,
    rng: np.random.Generator,
    *,
    water: Relief,
    wave_height_m: float = 0.4,
    wave_period_s: float = 4.0,
    speed_mps: tuple[float, float] = (2.0, 7.0),
    mix: Mapping[str, float] = FLEET,
) -> tuple[Mover, ...]:
    """Boats under way.

    Parameters
    ----------
    rings : sequence of float64 (points, 2)
        Closed lines on the water [m], clear of land, piers and of each other.
    per_km : float
        Boats on a kilometre of ring, on average.
    shop : Workshop
    rng : numpy.random.Generator
    water : callable
        Height of the water [m] at plan points (waves included, if the mesh has them).
    wave_height_m, wave_period_s : float
        Significant height and period of the waves.
    speed_mps : (float, float)
        Range of the speed of a ring.
    mix : mapping of str to float
        Kinds of boat and their shares.
    """
    kinds, shares = list(mix), np.array(list(mix.values()), np.float64)
    movers = []
    for ring, child in zip(rings, rng.spawn(len(rings)), strict=True):
        pace = Pace(float(child.uniform(*speed_mps)), 0.5, 0.3, 6.0, leans=False)
        route = ring_route(ring, water, pace)
        round_m = route.rows[-2, -1] - route.rows[1, -1]
        count = min(int(child.poisson(per_km * round_m / 1000.0)), int(route.round_s / HEADWAY_S))
        slack = 0.5 * (1.0 - HEADWAY_S * count / route.round_s) if count else 0.0
        starts = (np.arange(count) + child.uniform(-slack, slack, count)) / max(count, 1) + child.uniform()
        drawn = [str(kind) for kind in child.choice(kinds, count, p=shares / shares.sum())]
        for start, body in zip(starts % 1.0, boats(drawn, True, shop, child), strict=True):
            mover = Mover("boat", body, route.starting(float(start)))
            movers.append(_afloat(mover, wave_height_m, wave_period_s, child))
    return tuple(movers)


def anchor(
    place: Float64[np.ndarray, "boats 2"],
    heading_rad: Float64[np.ndarray, "boats"],
    kinds: Sequence[str],
    shop: Workshop,
    rng: np.random.Generator,
    *,
    water: Relief,
    wave_height_m: float = 0.4,
    wave_period_s: float = 4.0,
) -> tuple[Mover, ...]:
    """Boats that lie at anchor or at a pier and bob; those that need not move are `parts.boats.moor`'s.

    Parameters
    ----------
    place : float64 (boats, 2)
        [m].
    heading_rad : float64 (boats,)
    kinds : sequence of str
        One kind of `parts.boats` for each.
    shop : Workshop
    rng : numpy.random.Generator
    water : callable
        Height of the water [m] at plan points.
    wave_height_m, wave_period_s : float
        Significant height and period of the waves.
    """
    movers = []
    position = np.column_stack([place, water(place)])
    bodies = boats(list(kinds), False, shop, rng)
    for where, heading, body, child in zip(
        position, heading_rad, bodies, rng.spawn(len(position)), strict=True
    ):
        mover = Mover("boat", body, standing(where, float(heading)))
        movers.append(_afloat(mover, wave_height_m, wave_period_s, child))
    return tuple(movers)


def _afloat(mover: Mover, wave_height_m: float, wave_period_s: float, rng: np.random.Generator) -> Mover:
    length, width, _ = mover.size_m
    sway = Sway.of(length, width, wave_height_m, wave_period_s)
    return Mover(mover.kind, mover.body, swaying(mover.route, sway, rng))
