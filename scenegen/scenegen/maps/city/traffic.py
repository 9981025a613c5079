"""Cars: parked along kerbs and in car parks, driving in the lanes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64, Int64

from scenegen.buildings.lots import Lot
from scenegen.geometry.cars import BODIES, LENGTH_M, WIDTH_M, car, rear_m
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come, rectangles
from scenegen.geometry.relief import slopes
from scenegen.geometry.template import place
from scenegen.maps.city.districts import Layout
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.streets import Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop

_PAINTS = ("car_paint_black", "car_paint_white", "car_paint_silver", "car_paint_silver")
_KERB_M = 0.12
_PITCH_M = 5.7

# Lateral places to the right of the centre line [m]: parked, driving.
_PARKED = {Rank.ARTERIAL: (), Rank.COLLECTOR: (4.5,), Rank.SIDE: (3.5,)}
_DRIVING = {Rank.ARTERIAL: (1.75, 5.3), Rank.COLLECTOR: (1.75,), Rank.SIDE: (1.3,)}


@dataclass(frozen=True, eq=False)
class Traffic:
    """Where cars stand and of what build they are.

    Attributes
    ----------
    spots : float64 (cars, 3)
        Place and heading [m, m, rad].
    lift_m : float64 (cars,)
        Height of the ground there above the relief.
    body : int64 (cars,)
        Index into `scenegen.geometry.cars.BODIES`.
    size : float64 (cars,)
        Scale of the template.
    """

    spots: Float64[np.ndarray, "cars 3"]
    lift_m: Float64[np.ndarray, "cars"]
    body: Int64[np.ndarray, "cars"]
    size: Float64[np.ndarray, "cars"]

    def outlines(self) -> np.ndarray:
        """Plan of every car, an array of shapely polygons: the ground inside lies in the dark."""
        rear = np.array([rear_m(b) for b in BODIES])[self.body]
        front = LENGTH_M / 2
        heading = self.spots[:, 2]
        ahead = np.column_stack([np.cos(heading), np.sin(heading)])
        middle = self.spots[:, :2] + ahead * (self.size * (front + rear) / 2)[:, None]
        return rectangles(middle, self.size * (front - rear), self.size * WIDTH_M, heading)


def plan_traffic(plan: StreetPlan, layout: Layout, knobs: CityKnobs, rng: np.random.Generator) -> Traffic:
    """Choose where cars stand: the ground is meshed around them."""
    spots, lift = _spots(plan, layout, knobs, rng)
    body = rng.choice(len(BODIES), len(spots), p=[0.36, 0.2, 0.32, 0.12])
    return Traffic(spots, lift, body, rng.uniform(0.95, 1.05, len(spots)))


def build_traffic(traffic: Traffic, shop: CityWorkshop, rng: np.random.Generator) -> list[Part]:
    """Cars as parts, one per body style."""
    spots, count = traffic.spots, len(traffic.spots)
    first = shop.builder.new_objects(count)
    paint = np.array([shop.palette.pick(_PAINTS[int(k)], rng) for k in rng.integers(0, 4, count)])
    glass, rubber = shop.palette.pick("window_glass", rng), shop.palette.only("tyre_rubber")
    skins = np.column_stack([paint, np.full(count, glass), np.full(count, rubber)])
    slope = slopes(shop.relief, spots[:, :2])
    position = np.column_stack([spots[:, :2], shop.relief(spots[:, :2]) + traffic.lift_m])
    parts = []
    for k, name in enumerate(BODIES):
        mine = np.flatnonzero(traffic.body == k)
        scale = traffic.size[mine, None] * np.ones(3)
        parts.append(
            place(car(name), position[mine], spots[mine, 2], scale, skins[mine], first + mine, slope[mine])
        )
    return parts


def _spots(
    plan: StreetPlan, layout: Layout, knobs: CityKnobs, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Places (x, y, heading) that do not overlap, and the height of the ground there above the relief."""
    street = _in_streets(plan, knobs, rng)
    lots = [lot for block in layout.blocks for lot in block.car_parks]
    park = np.concatenate([np.zeros((0, 3)), *(_in_car_park(lot, rng) for lot in lots)])
    spots = np.concatenate([street, park])
    lift = np.repeat([0.0, _KERB_M], [len(street), len(park)])
    shapes = rectangles(
        spots[:, :2], np.full(len(spots), LENGTH_M + 0.5), np.full(len(spots), WIDTH_M + 0.3), spots[:, 2]
    )
    keep = first_come(shapes)
    footprints = np.array([b.footprint for b in layout.buildings], dtype=object)
    keep &= clear_of(shapes, footprints, 0.3)
    on_road = lift == 0.0
    keep[on_road] &= clear_of(shapes[on_road], np.asarray(plan.blocks, dtype=object), 0.02)
    return spots[keep], lift[keep]


def _in_streets(plan: StreetPlan, knobs: CityKnobs, rng: np.random.Generator) -> np.ndarray:
    """Both kerbs and both directions of every link."""
    parked, moving = rng.uniform(*knobs.parked_cars_per_100_m), rng.uniform(*knobs.moving_cars_per_100_m)
    rows = [np.zeros((0, 3))]
    for link in plan.links:
        street = plan.streets[link.street]
        lanes = [(parked, r) for r in _PARKED[street.rank]] + [(moving, r) for r in _DRIVING[street.rank]]
        for rate, right in lanes:
            for side in (1.0, -1.0):
                marks = np.arange(link.start_m + 8.0, link.end_m - 8.0, _PITCH_M)
                marks = marks[rng.uniform(size=len(marks)) < rate * _PITCH_M / 100]
                marks = marks + rng.uniform(-0.3, 0.3, len(marks))
                xy, heading = along(street.line, marks, np.full(len(marks), side * right))
                heading = heading + rng.normal(0.0, 0.015, len(marks)) + (0.0 if side > 0 else np.pi)
                rows.append(np.column_stack([xy, heading]))
    return np.concatenate(rows)


def _in_car_park(lot: Lot, rng: np.random.Generator) -> np.ndarray:
    """Rows of bays across the lot, partly taken."""
    room = lot.local().buffer(-1.2, join_style="mitre")
    if room.is_empty:
        return np.zeros((0, 3))
    x0, y0, x1, y1 = room.bounds
    rows = np.arange(y0 + 2.7, y1, 8.2)
    x, y = (g.ravel() for g in np.meshgrid(np.arange(x0 + 1.4, x1, 2.7), rows))
    taken = rng.uniform(size=len(x)) < rng.uniform(0.25, 0.8)
    x, y = x[taken], y[taken]
    heading = np.where(rng.uniform(size=len(x)) < 0.5, 0.5, 1.5) * np.pi
    shapes = rectangles(np.column_stack([x, y]), np.full(len(x), 4.8), np.full(len(x), 2.1), heading)
    fits = shapely.contains(room, shapes) if len(x) else np.zeros(0, bool)
    plan = lot.world(np.column_stack([x, y])[fits])
    return np.column_stack([plan, heading[fits] + lot.heading_rad + rng.normal(0.0, 0.02, fits.sum())])
