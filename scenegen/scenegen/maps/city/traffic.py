"""Cars: parked along kerbs and driving in the lanes."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.cars import BODIES, LENGTH_M, WIDTH_M, car
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come, rectangles
from scenegen.geometry.relief import WaveRelief
from scenegen.geometry.template import place
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.streets import StreetPlan
from scenegen.materials.palette import PaletteBuilder

_PAINTS = ("car_paint_black", "car_paint_white", "car_paint_silver", "car_paint_silver")
_JUNCTION_M = 7.0


def build_traffic(
    plan: StreetPlan,
    knobs: CityKnobs,
    relief: WaveRelief,
    palette: PaletteBuilder,
    builder: GeometryBuilder,
    rng: np.random.Generator,
) -> tuple[list[Part], np.ndarray]:
    """Cars as parts (one per body style) and their rectangles in the plan."""
    centre, heading = _spots(plan, knobs, rng)
    shapes = rectangles(centre, np.full(len(centre), LENGTH_M + 0.8), np.full(len(centre), WIDTH_M + 0.2), heading)
    keep = clear_of(shapes, np.asarray(plan.blocks, dtype=object), 0.1) & first_come(shapes)
    centre, heading, shapes = centre[keep], heading[keep], shapes[keep]
    first = builder.new_objects(len(centre))
    body = rng.choice(len(BODIES), len(centre), p=[0.36, 0.2, 0.32, 0.12])
    paint = np.array([palette.pick(_PAINTS[int(k)], rng) for k in rng.integers(0, 4, len(centre))])
    skins = np.column_stack(
        [paint, np.full(len(paint), palette.pick("window_glass", rng)), np.full(len(paint), palette.only("tyre_rubber"))]
    )
    slope = slopes(relief, centre)
    position = np.column_stack([centre, relief(centre)])
    parts = []
    for k, name in enumerate(BODIES):
        mine = np.flatnonzero(body == k)
        scale = rng.uniform(0.96, 1.05, (len(mine), 1)) * np.ones(3)
        parts.append(
            place(car(name), position[mine], heading[mine], scale, skins[mine], first + mine, slope[mine])
        )
    return parts, shapes


def slopes(relief: WaveRelief, xy: np.ndarray) -> np.ndarray:
    """Rise of the ground per metre east and north."""
    step = 0.5
    east, north = np.array([step, 0.0]), np.array([0.0, step])
    return np.column_stack([relief(xy + d) - relief(xy - d) for d in (east, north)]) / (2 * step)


def _spots(plan: StreetPlan, knobs: CityKnobs, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Candidate places: both kerbs and both lanes of every street, away from junctions."""
    parked, moving = rng.uniform(*knobs.parked_cars_per_100_m), rng.uniform(*knobs.moving_cars_per_100_m)
    lines = np.array([shapely.LineString(s.line) for s in plan.streets], dtype=object)
    places, headings = [], []
    for k, street in enumerate(plan.streets):
        other = np.delete(lines, k)
        reach = np.delete(np.array([s.width_m / 2 for s in plan.streets]), k)
        for rate, offset in ((parked, street.width_m / 2 - 1.25), (moving, street.width_m / 2 - 3.4)):
            for side in (1.0, -1.0):
                spots = np.arange(6.0, lines[k].length - 6.0, 5.6)
                spots = spots[rng.uniform(size=len(spots)) < rate * 0.056] + 0.0
                spots = spots + rng.uniform(-0.2, 0.2, len(spots))
                xy, heading = along(street.line, spots, np.full(len(spots), side * offset))
                distance = shapely.distance(shapely.points(xy)[:, None], other[None, :])
                free = (distance > reach[None, :] + _JUNCTION_M).all(axis=1)
                places.append(xy[free])
                headings.append(heading[free] + (0.0 if side > 0 else np.pi))
    return np.concatenate(places), np.concatenate(headings)
