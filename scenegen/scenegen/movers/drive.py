"""Vehicles that drive round lanes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.relief import Relief
from scenegen.movers.bodies import vehicles
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import Pace, ring_route
from scenegen.parts.workshop import Workshop

HEADWAY_S = 5.0
"""Least time between two vehicles of a lane."""
MIX: Mapping[str, float] = {"car": 0.84, "van": 0.1, "bus": 0.03, "truck": 0.03}
"""Shares of the kinds of vehicle in ordinary traffic."""


def drive(
    lanes: Sequence[Float64[np.ndarray, "_ 2"]],
    per_100_m: float,
    shop: Workshop,
    rng: np.random.Generator,
    *,
    speed_mps: tuple[float, float] = (8.0, 13.0),
    mix: Mapping[str, float] = MIX,
    ground: Relief | None = None,
    lift_m: float = 0.0,
) -> tuple[Mover, ...]:
    """Traffic on lanes.

    All vehicles of a lane keep the same speed at the same place, so they never meet; lanes must not cross. Loops
    around blocks (clockwise, where one drives on the right) and `rounds.there_and_back` lines do not.

    Parameters
    ----------
    lanes : sequence of float64 (points, 2)
        Closed lines in the plan [m], in the direction of travel; see `rounds.there_and_back` for open roads.
    per_100_m : float
        Vehicles on 100 m of lane, on average.
    shop : Workshop
        Instance ids and surfaces.
    rng : numpy.random.Generator
    speed_mps : (float, float)
        Range of the speed of a lane; bends are taken slower.
    mix : mapping of str to float
        Kinds of vehicle and their shares.
    ground : callable, optional
        Height of the road [m] at plan points where it is not `shop.relief`: a bridge.
    lift_m : float
        Height of the road above it [m].
    """
    kinds, shares = list(mix), np.array(list(mix.values()), np.float64)
    movers = []
    for lane, child in zip(lanes, rng.spawn(len(lanes)), strict=True):
        pace = Pace(float(child.uniform(*speed_mps)), 2.0, 1.5, 1.6, leans=True)
        route = ring_route(lane, ground or shop.relief, pace, lift_m)
        round_m = route.rows[-2, -1] - route.rows[1, -1]
        wanted = int(child.poisson(per_100_m * round_m / 100.0))
        count = min(wanted, int(route.round_s / HEADWAY_S))
        slack = 0.5 * (1.0 - HEADWAY_S * count / route.round_s) if count else 0.0
        starts = (np.arange(count) + child.uniform(-slack, slack, count)) / max(count, 1) + child.uniform()
        drawn = [str(kind) for kind in child.choice(kinds, count, p=shares / shares.sum())]
        for start, kind, body in zip(starts % 1.0, drawn, vehicles(drawn, shop, child), strict=True):
            movers.append(Mover(kind, body, route.starting(float(start))))
    return tuple(movers)
