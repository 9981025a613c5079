"""Bus stops: a shelter at the edge of the sidewalk, a bus at the kerb before some of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.placement import along, rectangles
from scenegen.maps.city.streets import Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop

SHELTER_M = (4.2, 1.7)
_BEHIND_KERB_M = 0.85
"""Middle of a shelter: its back is to the street, people walk past its open side."""
_WALL_M = 0.75
"""Distance of its back wall from its middle."""
_BUS_FROM_KERB_M = 1.4
_LONG_M, _BUS_SHARE, _BUS_AHEAD_M = 42.0, 0.45, 2.0


@dataclass(frozen=True, eq=False)
class Stops:
    """Bus stops of a city.

    Attributes
    ----------
    shelters, buses : float64 (n, 3)
        Place and heading [m, m, rad]: of shelters along their back wall, which is on their left; of buses forwards.
    """

    shelters: Float64[np.ndarray, "shelters 3"]
    buses: Float64[np.ndarray, "buses 3"]

    def outlines(self) -> np.ndarray:
        """Plans of the shelters, an array of shapely polygons."""
        count = len(self.shelters)
        size = np.full(count, SHELTER_M[0]), np.full(count, SHELTER_M[1])
        return rectangles(self.shelters[:, :2], *size, self.shelters[:, 2])

    def places(self) -> Float64[np.ndarray, "places 2"]:
        """Points all over the shelters, for things to keep clear of."""
        grid = np.stack(np.meshgrid([-2.0, -1.0, 0.0, 1.0, 2.0], [-0.7, 0.0, 0.7]), axis=-1).reshape(-1, 2)
        c, s = np.cos(self.shelters[:, 2:]), np.sin(self.shelters[:, 2:])
        x = self.shelters[:, :1] + c * grid[:, 0] - s * grid[:, 1]
        y = self.shelters[:, 1:2] + s * grid[:, 0] + c * grid[:, 1]
        return np.column_stack([x.ravel(), y.ravel()])


def plan_stops(plan: StreetPlan, shop: CityWorkshop, rng: np.random.Generator) -> Stops:
    """Choose stops along collectors: where buses stand out of the way of those that drive.

    Parameters
    ----------
    plan : StreetPlan
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    share = rng.uniform(*shop.knobs.bus_stop_share)
    shelters, buses = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for link in plan.links:
        street = plan.streets[link.street]
        if street.rank is not Rank.COLLECTOR or link.end_m - link.start_m < _LONG_M:
            continue
        for side in (1.0, -1.0):
            wanted, taken, at = rng.uniform(size=3)
            if wanted >= share:
                continue
            middle = np.array([link.start_m + 14.0 + at * (link.end_m - link.start_m - 28.0)])
            half = street.width_m / 2
            turn = 0.0 if side > 0 else np.pi
            xy, heading = along(street.line, middle, np.array([side * (half + _BEHIND_KERB_M)]))
            # The open side of a shelter, -y, looks away from the street, to the right of whoever drives past.
            shelters.append(np.column_stack([xy, heading + turn]))
            xy, heading = along(
                street.line, middle + side * _BUS_AHEAD_M, np.array([side * (half - _BUS_FROM_KERB_M)])
            )
            stands = np.column_stack([xy, heading + turn])
            buses.append(stands[: int(taken < _BUS_SHARE)])
    places = np.concatenate(shelters)
    return Stops(places[_on_blocks(places, plan)], np.concatenate(buses))


def _on_blocks(shelters: np.ndarray, plan: StreetPlan) -> np.ndarray:
    """Which shelters stand wholly on a sidewalk."""
    size = np.full(len(shelters), SHELTER_M[0]), np.full(len(shelters), 2 * _WALL_M)
    plans = rectangles(shelters[:, :2], *size, shelters[:, 2])
    on_block = np.zeros(len(plans), bool)
    on_block[shapely.STRtree(np.asarray(plan.blocks, dtype=object)).query(plans, predicate="within")[0]] = (
        True
    )
    return on_block
