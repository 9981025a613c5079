"""Staying on one side of what is in the way.

A drone that weighs every decision anew turns back along a wall as soon as the goal lies behind it, and so never comes
to the wall's end. As in Kamon, Rimon and Rivlin's TangentBug (1998), it therefore keeps the side it has begun with
until it is nearer to the goal than where the detour began and free to turn to it; a side that has led nowhere for long
is changed for the other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

_BEGINS_RAD = math.radians(60.0)
_ENDS_RAD = math.radians(45.0)
_NEARER_M = 2.0
_PATIENCE_S = 20.0
"""How long the first side may lead away from the goal; each later one twice as long as the one before."""
_WEIGHT = 1.5
"""What going to the other side costs, in radians off the goal."""


@dataclass(frozen=True)
class Detour:
    """A way round something.

    Attributes
    ----------
    side : float
        +1 keeps the goal to the right, -1 to the left.
    from_m : float
        Distance to the goal where it began.
    nearest_m, since_s : float
        Least distance to the goal since this side was begun with, and when it last fell.
    patience_s : float
        How long it may not fall before the side is changed.
    """

    side: float
    from_m: float
    nearest_m: float
    since_s: float
    patience_s: float = _PATIENCE_S

    def cost(
        self, direction: Float64[np.ndarray, "fan 3"], goal: Float64[np.ndarray, "3"]
    ) -> Float64[np.ndarray, "fan"]:
        """What directions to the other side of the goal cost more."""
        turn = turns(direction, goal)
        return _WEIGHT * np.where(turn * self.side < 0.0, np.minimum(np.abs(turn) / _BEGINS_RAD, 1.0), 0.0)


def next_detour(
    detour: Detour | None,
    chosen: Float64[np.ndarray, "3"],
    goal: Float64[np.ndarray, "3"],
    left_m: float,
    time_s: float,
) -> Detour | None:
    """The detour after a direction was chosen: begun, gone on with, changed to the other side, or ended.

    Parameters
    ----------
    detour : Detour or None
    chosen, goal : float64 (3,)
        Direction chosen and way to the goal.
    left_m : float
        Distance to the goal.
    time_s : float
    """
    turn = float(turns(chosen[None], goal)[0])
    if detour is None:
        return Detour(math.copysign(1.0, turn), left_m, left_m, time_s) if abs(turn) > _BEGINS_RAD else None
    if abs(turn) < _ENDS_RAD and left_m < detour.from_m - _NEARER_M:
        return None
    if left_m < detour.nearest_m - 1.0:
        return replace(detour, nearest_m=left_m, since_s=time_s)
    if time_s - detour.since_s > detour.patience_s:
        return Detour(-detour.side, detour.from_m, left_m, time_s, 2.0 * detour.patience_s)
    return detour


def turns(
    direction: Float64[np.ndarray, "fan 3"], goal: Float64[np.ndarray, "3"]
) -> Float64[np.ndarray, "fan"]:
    """Angle in the plan from the goal to each direction [rad], positive to the left."""
    cross = goal[0] * direction[:, 1] - goal[1] * direction[:, 0]
    return np.asarray(np.arctan2(cross, direction[:, :2] @ goal[:2]))
