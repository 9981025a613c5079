"""Floodlight masts, the power line along the road, and flags before the clubhouse."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along
from scenegen.geometry.template import place
from scenegen.maps.field.country import ROAD_HALF_M, Country
from scenegen.maps.field.grounds import Grounds, Pitch
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.fixtures.erect import erect
from scenegen.parts.fixtures.posts import floodlight_mast
from scenegen.parts.fixtures.utility import fastenings
from scenegen.parts.fixtures.wires import wires

_BESIDE_M, _SPAN_M = 4.2, 42.0


def mast_spots(grounds: Grounds, pitch: Pitch) -> np.ndarray:
    """Feet of the four masts of a pitch in the plan (4, 2)."""
    if pitch.main:
        long = max(s.length_m for s in grounds.stands) / 2 + 5.0
        x, y = long, grounds.half_m[1] + 3.2
    else:
        x, y = 0.3 * pitch.length_m, pitch.turf.half_y_m + 0.6
    return pitch.frame.world(np.array([[-x, -y], [x, -y], [x, y], [-x, y]]))


def build_masts(
    grounds: Grounds, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[list[Part], np.ndarray]:
    """Four masts at every lit pitch, and their feet in the plan."""
    parts, feet = [], [np.zeros((0, 2))]
    for pitch in grounds.pitches:
        if pitch.mast_m <= 0.0:
            continue
        xy = mast_spots(grounds, pitch)
        towards = np.array([pitch.frame.x_m, pitch.frame.y_m]) - xy
        rows, columns = (int(rng.integers(2, 5)), int(rng.integers(3, 6))) if pitch.main else (2, 2)
        metal, glass = shop.palette.pick("steel_galv_post", rng), shop.palette.pick("vehicle_glass", rng)
        owner = shop.builder.new_objects(4) + np.arange(4)
        skins = np.tile([[metal, glass]], (4, 1))
        template = floodlight_mast(pitch.mast_m, rows, columns)
        heading = np.arctan2(towards[:, 1], towards[:, 0])
        position = np.column_stack([xy, shop.relief(xy)])
        parts.append(place(template, position, heading, np.ones((4, 3)), skins, owner))
        feet.append(xy)
    return parts, np.concatenate(feet)


def build_power_line(
    country: Country, half_m: float, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[list[Part], np.ndarray]:
    """Wooden poles along the far side of the road with four conductors and a telephone cable; their feet."""
    xy, heading = _poles(country, half_m, rng)
    position = np.column_stack([xy, shop.relief(xy)])
    drum = rng.uniform(size=len(xy)) < 0.12
    parts = erect("utility_pole", position[~drum], heading[~drum], shop, rng)
    parts += erect("transformer_pole", position[drum], heading[drum], shop, rng)
    cable = shop.palette.pick("cable_weathered", rng)
    slack = rng.uniform(0.012, 0.022)
    insulators, telephone = fastenings(position, heading)
    hangs = [(insulators[:, k], 0.006) for k in range(insulators.shape[1])]
    for hang, radius in (*hangs, (telephone, 0.013)):
        span = np.linalg.norm(np.diff(hang, axis=0), axis=1)
        owner = shop.builder.new_objects() + np.zeros(len(span), np.int64)
        wire = int(Semantic.WIRE)
        parts.append(wires(hang[:-1], hang[1:], slack * span, radius, cable, wire, owner, chords=10))
    return parts, xy


def _poles(country: Country, half_m: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Feet and headings (of the line) along the road, a little beyond the detailed square."""
    line = shapely.LineString(country.road)
    near = line.intersection(shapely.box(-1.5 * half_m, -1.5 * half_m, 1.5 * half_m, 1.5 * half_m))
    near = max(shapely.get_parts(near), key=lambda p: float(p.length))
    mark = np.arange(rng.uniform(2.0, 20.0), near.length, _SPAN_M)
    points = shapely.get_coordinates(near)
    side = 1.0 if _right_of_road(country) else -1.0
    return along(points, mark, np.full(len(mark), side * (ROAD_HALF_M + _BESIDE_M)))


def _right_of_road(country: Country) -> bool:
    """Whether the farm lies to the right of the road."""
    middle = np.array([country.farm.yard.frame.x_m, country.farm.yard.frame.y_m])
    k = int(np.argmin(np.linalg.norm(country.road - middle, axis=1)))
    step, aside = country.road[k + 1] - country.road[k], middle - country.road[k]
    return bool(step[0] * aside[1] - step[1] * aside[0] < 0.0)


def build_flags(grounds: Grounds, shop: FieldWorkshop, rng: np.random.Generator) -> list[Part]:
    """Flags on poles at the forecourt's edge, blown the same way."""
    count = int(rng.integers(0, 5))
    front = grounds.clubhouse.frame
    x = np.arange(count) * 3.0 - 1.5 * (count - 1)
    xy = front.world(np.column_stack([x, np.full(count, -grounds.clubhouse.half_y_m - 2.2)]))
    position = np.column_stack([xy, shop.relief(xy)])
    return erect("flag_pole", position, np.full(count, rng.uniform(0.0, 2 * np.pi)), shop, rng)
