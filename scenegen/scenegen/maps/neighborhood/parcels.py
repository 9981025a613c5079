"""What stands and lies on each lot: house, driveway, path, patio, pool, shed, bed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.buildings.detached.body import Body, HomeStyle
from scenegen.buildings.lots import Lot
from scenegen.maps.neighborhood.garden import Garden


@dataclass(frozen=True, eq=False)
class Parcel:
    """A lot with what is on it; all polygons in the world's plan.

    Attributes
    ----------
    lot : Lot
    bodies : tuple of Body
        Of the house, in the lot's frame; empty for a meadow.
    hut : Body or None
        The shed, in the lot's frame.
    style, hut_style : HomeStyle or None
    solid : shapely.Polygon or None
        Where the house stands, porch included.
    driveway, path : shapely.Polygon or None
        To the street; outside the carriageway.
    garden : Garden
    bays : float64 (bays, 3)
        Where cars may stand on the driveway: position and heading.
    dry : bool
        Its lawn is not watered.
    """

    lot: Lot
    dry: bool
    bodies: tuple[Body, ...] = ()
    hut: Body | None = None
    style: HomeStyle | None = None
    hut_style: HomeStyle | None = None
    solid: shapely.Polygon | None = None
    driveway: shapely.Polygon | None = None
    path: shapely.Polygon | None = None
    garden: Garden = field(default_factory=Garden)
    bays: Float64[np.ndarray, "bays 3"] = field(default_factory=lambda: np.zeros((0, 3)))

    def world(self, local: shapely.Geometry) -> shapely.Polygon:
        """A polygon of the lot's frame in the world's plan."""
        return shapely.Polygon(self.lot.world(shapely.get_coordinates(local.exterior)[:-1]))

    def paved(self) -> list[shapely.Polygon]:
        """Everything that is neither lawn nor house."""
        made = [self.driveway, self.path, *self.garden.paved]
        return [g for g in made if g is not None]
