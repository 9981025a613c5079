"""Movers on the way: whether a flight keeps clear of everything that drives, walks and sails while it passes."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

from scenegen.movers.clock import Clock
from scenegen.movers.company import Company
from scenegen.movers.mover import Mover

_BETWEEN = 4
"""Instants looked at per step of a path."""


def keeps_clear(
    movers: tuple[Mover, ...],
    clock: Clock,
    path: Float64[np.ndarray, "poses 3"],
    time_s: Float64[np.ndarray, "poses"],
    clearance_m: float,
) -> bool:
    """Whether a path never comes closer to the box around any mover than the clearance.

    Proven between instants too: seen from a mover the camera goes from a point at distance a of its box to one at
    distance b, on a way of length l, so it never comes closer than ``(a + b - l) / 2``.

    Parameters
    ----------
    movers : tuple of Mover
    clock : Clock
        World time of the clip.
    path : float64 (poses, 3)
        Straight from pose to pose [m].
    time_s : float64 (poses,)
        Clip time of each pose.
    clearance_m : float
    """
    near = _near(movers, path, clearance_m)
    if not near:
        return True
    company = Company.of(near)
    count = _BETWEEN * (len(path) - 1) + 1
    fine = np.linspace(time_s[0], time_s[-1], count)
    place = np.stack([np.interp(fine, time_s, column) for column in path.T], axis=1)
    pose = company.poses_over(clock.at(fine))
    local = np.einsum("tni,tnij->tnj", place[:, None] - pose[..., :3, 3], pose[..., :3, :3])
    low, high = company.box[:, 0], company.box[:, 1]
    distance = np.linalg.norm(np.maximum(np.maximum(low - local, local - high), 0.0), axis=-1)
    way = np.linalg.norm(np.diff(local, axis=0), axis=-1)
    closest = 0.5 * (distance[1:] + distance[:-1] - way)
    return bool((closest >= clearance_m).all())


def _near(movers: tuple[Mover, ...], path: Float64[np.ndarray, "poses 3"], clearance_m: float) -> list[Mover]:
    """Movers whose whole round comes near the box around the path."""
    low, high = path.min(axis=0) - clearance_m, path.max(axis=0) + clearance_m
    near = []
    for mover in movers:
        places, reach = mover.route.rows[:, :3], float(np.abs(mover.box_m).max() * np.sqrt(3.0))
        if (places.min(axis=0) <= high + reach).all() and (places.max(axis=0) >= low - reach).all():
            near.append(mover)
    return near
