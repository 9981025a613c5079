"""Which bodies stand where: drawn before the vehicles are built, so that the ground can be meshed around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.placement import rectangles
from scenegen.parts.vehicles.shapes import CARS
from scenegen.parts.vehicles.vehicle import bodies, body_size_m, size_m


@dataclass(frozen=True, eq=False)
class Fleet:
    """Bodies and scales of vehicles of one kind.

    Attributes
    ----------
    kind : str
    body : int64 (vehicles,)
        Index into `scenegen.parts.vehicles.vehicle.bodies`.
    scale : float64 (vehicles,)
    """

    kind: str
    body: Int64[np.ndarray, "vehicles"]
    scale: Float64[np.ndarray, "vehicles"]

    @staticmethod
    def draw(kind: str, count: int, rng: np.random.Generator) -> Fleet:
        """Draw vehicles of a kind, bodies by their shares of the traffic."""
        size_m(kind)
        names = bodies(kind)
        shares = [CARS[n][1] for n in names] if kind == "car" else [1.0]
        return Fleet(kind, rng.choice(len(names), count, p=shares), rng.uniform(0.96, 1.03, count))

    def sizes_m(self) -> Float64[np.ndarray, "vehicles 3"]:
        """Length, width, height of each [m]."""
        table = np.array([body_size_m(n) for n in bodies(self.kind)])
        return np.asarray(table[self.body] * self.scale[:, None])

    def outlines(
        self, position: Float64[np.ndarray, "vehicles 2"], heading_rad: Float64[np.ndarray, "vehicles"]
    ) -> np.ndarray:
        """Plans of the vehicles at places, an array of shapely polygons."""
        size = self.sizes_m()
        return rectangles(position, size[:, 0], size[:, 1], heading_rad)
