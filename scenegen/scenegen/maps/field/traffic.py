"""Vehicles that stand: cars and a coach in the car park, a truck and a car at the farm."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.part import Part
from scenegen.geometry.placement import rectangles
from scenegen.geometry.relief import slopes
from scenegen.maps.field.country import Country
from scenegen.maps.field.grounds import Grounds
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.vehicles.park import park, size_m

_BAY_M, _MODULE_M = 2.7, 16.6
_JUST_ARRIVED = 0.12


def build_traffic(
    grounds: Grounds, country: Country, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[list[Part], np.ndarray]:
    """All vehicles, and their plans as an array of polygons."""
    bays = _in_bays(grounds, shop, rng)
    fresh = rng.uniform(size=len(bays)) < _JUST_ARRIVED
    van = rng.uniform(size=len(bays)) < 0.08
    yard, coach = _at_farm(country, rng), _coach(grounds, rng)
    parts: list[Part] = []
    plans = [np.zeros(0, dtype=object)]
    for name, rows, driven in (
        ("car", bays[~van & ~fresh], False),
        ("car", bays[~van & fresh], True),
        ("van", bays[van], False),
        ("bus", coach, False),
        ("truck", yard[:1], False),
        ("car", yard[1:], False),
    ):
        if len(rows):
            position = np.column_stack([rows[:, :2], shop.relief(rows[:, :2])])
            length, width, _ = size_m(name)
            size = np.ones(len(rows))
            plans.append(rectangles(rows[:, :2], length * size, width * size, rows[:, 2]))
            parts += park(name, position, rows[:, 2], slopes(shop.relief, rows[:, :2]), shop, rng, driven)
    return parts, np.concatenate(plans)


def _in_bays(grounds: Grounds, shop: FieldWorkshop, rng: np.random.Generator) -> np.ndarray:
    """Taken bays, nose in or out; the last bays of the front row stay free for a coach."""
    plot = grounds.car_park
    x = np.arange(-plot.half_x_m + _BAY_M / 2, plot.half_x_m, _BAY_M)
    low = np.arange(-plot.half_y_m, plot.half_y_m - 1.0, _MODULE_M)
    y = np.concatenate([low + 2.5, low + 14.1])
    grid_x, grid_y = (g.ravel() for g in np.meshgrid(x, y))
    taken = rng.uniform(size=len(grid_x)) < rng.uniform(*shop.knobs.car_park_use)
    taken &= ~((grid_y > plot.half_y_m - 5.0) & (np.abs(grid_x) < 8.0))
    xy = np.column_stack([grid_x, grid_y])[taken]
    xy = xy + rng.uniform(-0.12, 0.12, xy.shape)
    turn = np.where(rng.uniform(size=len(xy)) < 0.5, 0.5, 1.5) * np.pi + rng.normal(0.0, 0.02, len(xy))
    return np.column_stack([plot.frame.world(xy), turn + plot.frame.heading_rad])


def _coach(grounds: Grounds, rng: np.random.Generator) -> np.ndarray:
    """A team's coach across the bays kept free, or none."""
    if rng.uniform() < 0.4:
        return np.zeros((0, 3))
    plot = grounds.car_park
    at = plot.frame.world(np.array([[0.0, plot.half_y_m - 2.2]]))[0]
    return np.array([[at[0], at[1], plot.frame.heading_rad + (0.0 if rng.uniform() < 0.5 else np.pi)]])


def _at_farm(country: Country, rng: np.random.Generator) -> np.ndarray:
    """A truck before the barn and a car by the house."""
    yard = country.farm.yard.frame
    xy = yard.world(np.array([[-12.0, 4.0], [9.0, -6.0]]))
    heading = yard.heading_rad + rng.uniform(-0.3, 0.3, 2)
    return np.column_stack([xy, heading])
