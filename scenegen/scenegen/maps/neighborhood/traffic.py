"""Cars on driveways, along those kerbs where nobody drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Bool, Float64

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come, rectangles
from scenegen.geometry.relief import slopes
from scenegen.maps.neighborhood.motion import Rounds
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, KERB_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.vehicles.park import park, size_m

_PARKED_M = CARRIAGEWAY_M / 2 - 1.05
_PITCH_M, _CLEAR_M = 6.2, 9.0
_FROM_LANE_M, _FROM_WALK_M = 1.5, 0.45
_FREE = 0.45
"""About the share of kerbs that is left for parking."""


@dataclass(frozen=True, eq=False)
class Spots:
    """Where vehicles stand.

    Attributes
    ----------
    place : float64 (vehicles, 3)
        Plan position and heading.
    lift_m : float64 (vehicles,)
        Height of the ground there above the relief.
    driven, van : bool (vehicles,)
        Whether it has just come home, with a warm engine; whether it is a van.
    plan : array of shapely.Polygon
        Ground each covers.
    """

    place: Float64[np.ndarray, "vehicles 3"]
    lift_m: Float64[np.ndarray, "vehicles"]
    driven: Bool[np.ndarray, "vehicles"]
    van: Bool[np.ndarray, "vehicles"]
    plan: np.ndarray


def find_spots(
    plan: StreetPlan,
    parcels: Sequence[Parcel],
    rounds: Rounds,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> Spots:
    """Draw places for all vehicles; they touch nothing and stand in nobody's way."""
    knobs = shop.knobs
    home = _on_driveways(parcels, rng.uniform(*knobs.driveway_cars), rng)
    kerb = _along_streets(plan, rng.uniform(*knobs.parked_cars_per_100_m) / 100 / _FREE, _PARKED_M, rng)
    place = np.concatenate([home, kerb])
    lift = np.repeat([KERB_M, 0.0], [len(home), len(kerb)])
    driven = rng.uniform(size=len(place)) < 0.12  # just come home
    van = rng.uniform(size=len(place)) < 0.07
    size = np.array([size_m("van") if v else size_m("car") for v in van]).reshape(-1, 3)
    shapes = rectangles(place[:, :2], size[:, 0], size[:, 1], place[:, 2])
    grown = rectangles(place[:, :2], size[:, 0] + 0.7, size[:, 1] + 0.35, place[:, 2])
    keep = clear_of(shapes, rounds.lane_lines(), _FROM_LANE_M)
    keep &= clear_of(shapes, rounds.walk_lines(), _FROM_WALK_M)
    keep[keep] = first_come(grown[keep])
    solid = np.array([p.solid for p in parcels if p.solid is not None], dtype=object)
    keep &= clear_of(shapes, solid, 0.25)
    road = lift == 0.0
    keep[road] &= shapely.contains(plan.carriageway, shapely.buffer(shapes[road], 0.05))
    drives = [p.driveway for p in parcels if p.driveway is not None]
    if drives:
        mouths = shapely.buffer(shapely.centroid(np.array(drives, dtype=object)), 0.1)
        keep[road] &= clear_of(shapes[road], np.array(drives, dtype=object), 1.0) & clear_of(
            shapes[road], mouths
        )
    return Spots(place[keep], lift[keep], driven[keep], van[keep], shapes[keep])


def build_traffic(spots: Spots, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Part]:
    """All vehicles as parts."""
    slope = slopes(shop.relief, spots.place[:, :2])
    position = np.column_stack([spots.place[:, :2], shop.relief(spots.place[:, :2]) + spots.lift_m])
    parts: list[Part] = []
    for kind, driven in (("car", False), ("car", True), ("van", False), ("van", True)):
        mine = np.flatnonzero((spots.van == (kind == "van")) & (spots.driven == driven))
        parts += park(kind, position[mine], spots.place[mine, 2], slope[mine], shop, rng, driven)
    return parts


def _on_driveways(parcels: Sequence[Parcel], mean: float, rng: np.random.Generator) -> np.ndarray:
    """The first bays of each driveway, as many as are at home."""
    rows = [np.zeros((0, 3))]
    for parcel in parcels:
        count = min(int(rng.poisson(mean)), len(parcel.bays))
        order = rng.permutation(len(parcel.bays))[:count]
        rows.append(parcel.bays[order] + rng.normal(0.0, [0.1, 0.1, 0.02], (count, 3)))
    return np.concatenate(rows)


def _along_streets(plan: StreetPlan, rate: float, right_m: float, rng: np.random.Generator) -> np.ndarray:
    """Both sides of every street; `rate` vehicles per metre and side."""
    rows = [np.zeros((0, 3))]
    for line in plan.lines:
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        for side in (1.0, -1.0):
            marks = np.arange(_CLEAR_M, length - _CLEAR_M, _PITCH_M)
            marks = marks[rng.uniform(size=len(marks)) < rate * _PITCH_M]
            marks = marks + rng.uniform(-0.4, 0.4, len(marks))
            xy, heading = along(line, marks, np.full(len(marks), side * right_m))
            heading = heading + rng.normal(0.0, 0.015, len(marks)) + (0.0 if side > 0 else np.pi)
            rows.append(np.column_stack([xy, heading]))
    return np.concatenate(rows)
