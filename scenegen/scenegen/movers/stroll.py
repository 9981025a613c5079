"""People who walk or run along ways."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.relief import Relief
from scenegen.movers.figures import person
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import Pace, ring_route
from scenegen.parts.workshop import Workshop

_DISTANCE_S = 2.5
"""Least time between two people on one way: they keep its order, so nobody walks through anybody."""


def stroll(
    ways: Sequence[Float64[np.ndarray, "_ 2"]],
    per_100_m: float,
    shop: Workshop,
    rng: np.random.Generator,
    *,
    speed_mps: tuple[float, float] = (0.9, 1.6),
    ground: Relief | None = None,
    lift_m: float = 0.0,
) -> tuple[Mover, ...]:
    """People on ways.

    Parameters
    ----------
    ways : sequence of float64 (points, 2)
        Closed lines in the plan [m], in the direction of walking; `rounds.there_and_back` makes one of an open way.
        Ways must not cross or come closer than 0.8 m to each other or to anything that stands.
    per_100_m : float
        People on 100 m of way, on average.
    shop : Workshop
    rng : numpy.random.Generator
    speed_mps : (float, float)
        Range of the speed, the same for all on one way; above 2 m/s they run.
    ground : callable, optional
        Height [m] at plan points where it is not `shop.relief`: a pier, a bridge, a platform.
    lift_m : float
        Height of the way above it [m]: a kerb.
    """
    movers = []
    for way, child in zip(ways, rng.spawn(len(ways)), strict=True):
        speed = float(child.uniform(*speed_mps))
        route = ring_route(way, ground or shop.relief, Pace(speed, 1.2, 0.8, 0.5, leans=False), lift_m)
        round_m = route.rows[-2, -1] - route.rows[1, -1]
        wanted = int(child.poisson(per_100_m * round_m / 100.0))
        count = min(wanted, int(route.round_s / _DISTANCE_S))
        slack = 0.5 * (1.0 - _DISTANCE_S * count / route.round_s) if count else 0.0
        starts = (np.arange(count) + child.uniform(-slack, slack, count)) / max(count, 1) + child.uniform()
        for start in starts % 1.0:
            body, gait = person(speed, shop, child)
            movers.append(Mover("person", body, route.starting(float(start)), gait))
    return tuple(movers)
