"""Players on a pitch: each roams a patch of it at changing speed."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.relief import Relief
from scenegen.movers.figures import person
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import Pace, ring_route
from scenegen.parts.workshop import Workshop

_APART_M = 1.0
"""Left free between the patches of two players."""


def play(
    pitch: Float64[np.ndarray, "4 2"],
    players: int,
    shop: Workshop,
    rng: np.random.Generator,
    *,
    speed_mps: tuple[float, float] = (1.5, 5.5),
    ground: Relief | None = None,
    lift_m: float = 0.0,
) -> tuple[Mover, ...]:
    """Players on a rectangle, each in a cell of its own so that nobody runs through anybody.

    Parameters
    ----------
    pitch : float64 (4, 2)
        Corners of the rectangle in order [m].
    players : int
    shop : Workshop
    rng : numpy.random.Generator
    speed_mps : (float, float)
        Range of the speed, drawn per player.
    ground : callable, optional
        Height [m] at plan points where it is not `shop.relief`.
    lift_m : float
        Height of the turf above it [m].
    """
    sides = np.linalg.norm(pitch[1] - pitch[0]), np.linalg.norm(pitch[3] - pitch[0])
    rows = max(round(float(np.sqrt(players * sides[1] / sides[0]))), 1)
    columns = -(-players // rows)
    cells = rng.permutation(rows * columns)[:players]
    movers = []
    for cell, child in zip(cells, rng.spawn(players), strict=True):
        low = np.array([cell % columns / columns, cell // columns / rows])
        size = np.array([1.0 / columns, 1.0 / rows])
        margin = 0.5 * _APART_M / np.array(sides)
        share = low + margin + (size - 2.0 * margin) * _roam(child)
        line = pitch[0] + share[:, :1] * (pitch[1] - pitch[0]) + share[:, 1:] * (pitch[3] - pitch[0])
        speed = float(child.uniform(*speed_mps))
        route = ring_route(line, ground or shop.relief, Pace(speed, 3.0, 2.0, 0.6, leans=False), lift_m)
        body, gait = person(speed, shop, child)
        movers.append(Mover("player", body, route.starting(float(child.uniform())), gait))
    return tuple(movers)


def _roam(rng: np.random.Generator) -> Float64[np.ndarray, "points 2"]:
    """A closed curve inside the unit square: a few harmonics, scaled to touch most of it."""
    angle = 2.0 * np.pi * np.arange(96) / 96
    curve = np.zeros((96, 2))
    for turns in (1, 2, 3):
        for axis in range(2):
            curve[:, axis] += np.sin(turns * angle + rng.uniform(0.0, 2.0 * np.pi)) / turns
    low, high = curve.min(axis=0), curve.max(axis=0)
    return np.asarray((curve - low) / (high - low) * rng.uniform(0.6, 1.0) * 0.98 + 0.01)
