"""Vehicles parked along kerbs and in car parks; those that drive are movers, see `motion`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64, Int64

from scenegen.buildings.lots import Lot
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come, rectangles
from scenegen.geometry.relief import slopes
from scenegen.maps.city.districts import Layout
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.stops import Stops
from scenegen.maps.city.streets import KERB_M, Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.vehicles.fleet import Fleet
from scenegen.parts.vehicles.park import park
from scenegen.parts.vehicles.vehicle import KINDS, size_m

_PITCH_M = 5.7
_ROOM_M = (0.6, 0.25)
"""Kept free before and behind, and on both sides together."""

_PARKED = {Rank.ARTERIAL: None, Rank.COLLECTOR: 4.6, Rank.SIDE: 3.6}
"""Lateral place of parked vehicles, right of the centre line [m]; those that drive need the lane beside them."""

# Shares of car, van, bus, truck (in the order of `KINDS`).
_SHARES = {
    "lot": (0.95, 0.05, 0.0, 0.0),
    "kerb": (0.88, 0.12, 0.0, 0.0),
    "collector": (0.85, 0.11, 0.0, 0.04),
}
_WIDTHS_M = np.array([size_m(name)[1] for name in KINDS])
_SLIM_M = 0.3
"""Vehicles wider than cars by more than this stand further from the kerb."""


@dataclass(frozen=True, eq=False)
class Traffic:
    """Where vehicles stand and of what body they are.

    Attributes
    ----------
    spots : float64 (vehicles, 3)
        Place and heading [m, m, rad].
    lift_m : float64 (vehicles,)
        Height of the ground there above the relief.
    kind : int64 (vehicles,)
        Index into `scenegen.parts.vehicles.vehicle.KINDS`.
    fleets : tuple of Fleet
        The bodies of each kind, in the order of the spots.
    """

    spots: Float64[np.ndarray, "vehicles 3"]
    lift_m: Float64[np.ndarray, "vehicles"]
    kind: Int64[np.ndarray, "vehicles"]
    fleets: tuple[Fleet, ...]

    def outlines(self) -> np.ndarray:
        """Plan of every vehicle, an array of shapely polygons: the ground inside lies in the dark."""
        plans = np.empty(len(self.spots), object)
        for k, fleet in enumerate(self.fleets):
            mine = self.kind == k
            plans[mine] = fleet.outlines(self.spots[mine, :2], self.spots[mine, 2])
        return plans


def plan_traffic(
    plan: StreetPlan, layout: Layout, stops: Stops, knobs: CityKnobs, rng: np.random.Generator
) -> Traffic:
    """Choose where vehicles stand: the ground is meshed around them."""
    spots, lift, kind = _spots(plan, layout, stops, knobs, rng)
    fleets = [Fleet.draw(name, int((kind == k).sum()), rng) for k, name in enumerate(KINDS)]
    return Traffic(spots, lift, kind, tuple(fleets))


def build_traffic(traffic: Traffic, shop: CityWorkshop, rng: np.random.Generator) -> list[Part]:
    """Vehicles as parts."""
    spots = traffic.spots
    slope = slopes(shop.relief, spots[:, :2])
    position = np.column_stack([spots[:, :2], shop.relief(spots[:, :2]) + traffic.lift_m])
    parts = []
    for k, fleet in enumerate(traffic.fleets):
        mine = traffic.kind == k
        at_stop = fleet.kind == "bus"  # with its engine running
        turned = position[mine], spots[mine, 2], slope[mine]
        parts += park(fleet.kind, *turned, shop, rng, driven=at_stop, fleet=fleet)
    return parts


def _spots(
    plan: StreetPlan, layout: Layout, stops: Stops, knobs: CityKnobs, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places (x, y, heading) that do not overlap, the height of the ground above the relief, and kinds."""
    street, kind = _in_streets(plan, knobs, rng)
    street = np.concatenate([stops.buses, street])
    kind = np.concatenate([np.full(len(stops.buses), KINDS.index("bus")), kind])
    lots = [lot for block in layout.blocks for lot in block.car_parks]
    bays = np.concatenate([np.zeros((0, 3)), *(_in_car_park(lot, rng) for lot in lots)])
    spots = np.concatenate([street, bays])
    kind = np.concatenate([kind, rng.choice(len(KINDS), len(bays), p=_SHARES["lot"])])
    lift = np.repeat([0.0, KERB_M], [len(street), len(bays)])
    size = np.array([size_m(name)[:2] for name in KINDS])[kind] + np.array(_ROOM_M)
    shapes = rectangles(spots[:, :2], size[:, 0], size[:, 1], spots[:, 2])
    keep = first_come(shapes)
    footprints = np.array([b.footprint for b in layout.buildings], dtype=object)
    keep &= clear_of(shapes, footprints, 0.3)
    on_road = lift == 0.0
    keep[on_road] &= clear_of(shapes[on_road], np.asarray(plan.blocks, dtype=object), 0.02)
    return spots[keep], lift[keep], kind[keep]


def _in_streets(
    plan: StreetPlan, knobs: CityKnobs, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Places (x, y, heading) and kinds along both kerbs of every link."""
    rate = rng.uniform(*knobs.parked_cars_per_100_m)
    rows, kinds = [np.zeros((0, 3))], [np.zeros(0, np.int64)]
    for link in plan.links:
        street = plan.streets[link.street]
        right = _PARKED[street.rank]
        if right is None:
            continue
        for side in (1.0, -1.0):
            marks = np.arange(link.start_m + 8.0, link.end_m - 8.0, _PITCH_M)
            marks = marks[rng.uniform(size=len(marks)) < rate * _PITCH_M / 100]
            marks = marks + rng.uniform(-0.3, 0.3, len(marks))
            shares = _SHARES["collector" if street.rank is Rank.COLLECTOR else "kerb"]
            what = rng.choice(len(KINDS), len(marks), p=shares)
            wide = _WIDTHS_M[what] - _WIDTHS_M[0]
            aside = right - np.where(wide > _SLIM_M, wide / 2, 0.0)
            xy, heading = along(street.line, marks, side * aside)
            heading = heading + rng.normal(0.0, 0.015, len(marks)) + (0.0 if side > 0 else np.pi)
            rows.append(np.column_stack([xy, heading]))
            kinds.append(what)
    return np.concatenate(rows), np.concatenate(kinds)


def _in_car_park(lot: Lot, rng: np.random.Generator) -> np.ndarray:
    """Rows of bays across the lot, partly taken."""
    room = lot.local().buffer(-1.2, join_style="mitre")
    if room.is_empty:
        return np.zeros((0, 3))
    x0, y0, x1, y1 = room.bounds
    rows = np.arange(y0 + 2.7, y1, 8.2)
    x, y = (g.ravel() for g in np.meshgrid(np.arange(x0 + 1.4, x1, 2.7), rows))
    taken = rng.uniform(size=len(x)) < rng.uniform(0.12, 0.5)
    x, y = x[taken], y[taken]
    heading = np.where(rng.uniform(size=len(x)) < 0.5, 0.5, 1.5) * np.pi
    shapes = rectangles(np.column_stack([x, y]), np.full(len(x), 4.8), np.full(len(x), 2.1), heading)
    fits = shapely.contains(room, shapes) if len(x) else np.zeros(0, bool)
    plan = lot.world(np.column_stack([x, y])[fits])
    return np.column_stack([plan, heading[fits] + lot.heading_rad + rng.normal(0.0, 0.02, fits.sum())])
