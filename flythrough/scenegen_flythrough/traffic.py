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
    reaches: Float64[np.ndarray, "movers 2 3"] | None = None,
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
    reaches : float64 (movers, 2, 3), optional
        `reaches_of` the movers, where it is known already.
    """
    reaches = reaches_of(movers) if reaches is None else reaches
    low, high = path.min(axis=0) - clearance_m, path.max(axis=0) + clearance_m
    meets = ((reaches[:, 0] <= high) & (reaches[:, 1] >= low)).all(axis=1)
    near = [movers[k] for k in np.flatnonzero(meets)]
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


def reaches_of(movers: tuple[Mover, ...]) -> Float64[np.ndarray, "movers 2 3"]:
    """Boxes that movers never leave on their whole rounds: lower and upper corners [m]."""
    boxes = np.zeros((len(movers), 2, 3))
    for box, mover in zip(boxes, movers, strict=True):
        places, size = mover.route.rows[:, :3], float(np.abs(mover.box_m).max() * np.sqrt(3.0))
        box[0], box[1] = places.min(axis=0) - size, places.max(axis=0) + size
    return boxes
