"""A mover: a body in its rest pose and the route it follows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.movers.gait import Gait
from scenegen.movers.route import Route


@dataclass(frozen=True, eq=False)
class Mover:
    """Something that moves.

    Attributes
    ----------
    kind : str
        "car", "bus", "person", "boat" ...; for listings.
    body : Part
        Triangles, labels and thermal sites in the rest pose and the mover's own frame: x forward, y left, z up, the
        origin on the ground under the middle. Surfaces are those of the world's palette, the instance id is the
        mover's own.
    route : Route
    gait : Gait or None
        How limbs move; None for what is rigid.
    """

    kind: str
    body: Part
    route: Route
    gait: Gait | None = None

    @property
    def object(self) -> int:
        """Instance id."""
        return int(self.body.object[0])

    @property
    def box_m(self) -> Float64[np.ndarray, "2 3"]:
        """Lower and upper corner of the body in its own frame, in every phase of its gait [m]."""
        points = self.body.vertices if self.gait is None else self.gait.cycle.reshape(-1, 3)
        return np.stack([points.min(axis=0), points.max(axis=0)]).astype(np.float64)

    @property
    def size_m(self) -> tuple[float, float, float]:
        """Length, width and height of the rest pose [m]."""
        length, width, height = np.ptp(self.body.vertices, axis=0).tolist()
        return length, width, height
