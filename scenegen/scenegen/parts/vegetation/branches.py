"""Branches of one order: polylines with radii, and how the next order sprouts from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

GOLDEN_RAD = np.pi * (3.0 - np.sqrt(5.0))
"""Angle between successive buds of most trees (phyllotaxis)."""


@dataclass(frozen=True, eq=False)
class Branches:
    """Branches of one order.

    Attributes
    ----------
    points : float64 (branches, nodes, 3)
    radius : float64 (branches, nodes)
    """

    points: Float64[np.ndarray, "branches nodes 3"]
    radius: Float64[np.ndarray, "branches nodes"]

    def at(
        self, branch: np.ndarray, t: np.ndarray
    ) -> tuple[
        Float64[np.ndarray, "places 3"], Float64[np.ndarray, "places 3"], Float64[np.ndarray, "places"]
    ]:
        """Point, unit direction and radius at shares t of the length of branches."""
        nodes = self.points.shape[1]
        place = np.clip(t, 0.0, 1.0) * (nodes - 1)
        k = np.minimum(place.astype(np.int64), nodes - 2)
        f = (place - k)[:, None]
        a, b = self.points[branch, k], self.points[branch, k + 1]
        radius = (1 - f[:, 0]) * self.radius[branch, k] + f[:, 0] * self.radius[branch, k + 1]
        return a + f * (b - a), unit(b - a), radius

    def length(self) -> Float64[np.ndarray, "branches"]:
        """Length of each branch."""
        return np.asarray(np.linalg.norm(np.diff(self.points, axis=1), axis=2).sum(axis=1))


def unit(vectors: Float64[np.ndarray, "*any 3"]) -> Float64[np.ndarray, "*any 3"]:
    """Vectors of length one."""
    length = np.sqrt((vectors**2).sum(axis=-1, keepdims=True))
    return np.asarray(vectors / np.maximum(length, 1e-12))


def across(direction: Float64[np.ndarray, "*any 3"]) -> Float64[np.ndarray, "*any 3"]:
    """A unit vector at right angles to each direction, the same for the same direction."""
    steep = np.abs(direction[..., 2:]) > 0.9
    helper = np.where(steep, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    return unit(np.cross(helper, direction))


def aside(
    direction: Float64[np.ndarray, "buds 3"],
    angle_rad: Float64[np.ndarray, "buds"],
    turn_rad: Float64[np.ndarray, "buds"],
) -> Float64[np.ndarray, "buds 3"]:
    """Directions bent away by an angle, towards a turn about the parent's axis."""
    u = across(direction)
    v = np.cross(direction, u)
    side = np.cos(turn_rad)[:, None] * u + np.sin(turn_rad)[:, None] * v
    return unit(np.cos(angle_rad)[:, None] * direction + np.sin(angle_rad)[:, None] * side)


def sprout(
    start: Float64[np.ndarray, "branches 3"],
    direction: Float64[np.ndarray, "branches 3"],
    length: Float64[np.ndarray, "branches"],
    radius: tuple[np.ndarray, np.ndarray],
    nodes: int,
    bend: float,
    crooked: float,
    rng: np.random.Generator,
) -> Branches:
    """Grow branches node by node.

    Parameters
    ----------
    start, direction, length
        Where each begins, where it heads, how long it becomes.
    radius : (array, array)
        At its two ends.
    nodes : int
        Points of its polyline, two or more.
    bend : float
        Upward (or, negative, downward) pull over the whole length.
    crooked : float
        Standard deviation of the random turn at each node [rad].
    rng : numpy.random.Generator
    """
    noise = rng.normal(0.0, crooked, (nodes - 1, len(start), 3))
    step = (length / (nodes - 1))[:, None]
    heading, points = unit(direction), [start]
    for k in range(nodes - 1):
        points.append(points[-1] + step * heading)
        heading = unit(heading + noise[k] + np.array([0.0, 0.0, bend / (nodes - 1)]))
    t = np.linspace(0.0, 1.0, nodes)
    return Branches(np.stack(points, axis=1), radius[0][:, None] * (1 - t) + radius[1][:, None] * t)
