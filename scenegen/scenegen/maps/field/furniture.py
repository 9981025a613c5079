"""Lamps at the car park, benches and bins, advertising boards along the touch lines, a scoreboard, a road sign."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.boxes import boxes
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.template import Template, place
from scenegen.maps.field.country import ROAD_HALF_M
from scenegen.maps.field.grounds import Grounds
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.fixtures.erect import erect

_BOARD_M, _BOARD_HIGH_M, _BOARD_THICK_M = 5.0, 0.9, 0.06
_LAMP_PITCH_M, _FROM_DRIVE_M = 24.0, 5.0


def build_furniture(
    grounds: Grounds, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[list[Part], np.ndarray]:
    """All furniture, and its feet in the plan (feet, 2)."""
    parts: list[Part] = []
    feet = [np.zeros((0, 2))]
    for kind, rows in (
        ("lamp", _lamps(grounds)),
        ("bench", _benches(grounds, rng)),
        ("litter_bin", _bins(grounds, rng)),
        ("sign", _road_sign(grounds)),
    ):
        position = np.column_stack([rows[:, :2], shop.relief(rows[:, :2])])
        parts += erect(kind, position, rows[:, 2], shop, rng)
        feet.append(rows[:, :2])
    if rng.uniform() < 0.7:
        spot = grounds.frame.at(grounds.half_m[0] + 1.7, rng.uniform(12.0, 20.0), np.pi)
        parts.append(_scoreboard(np.array([spot.x_m, spot.y_m]), spot.heading_rad, shop))
        feet.append(np.array([[spot.x_m, spot.y_m]]))
    if not grounds.track:
        parts += _boards(grounds, shop, rng)
    return parts, np.concatenate(feet)


def _lamps(grounds: Grounds) -> np.ndarray:
    """Around the car park, arms inwards, away from the drive."""
    ring = grounds.car_park.outline(1.1).exterior
    count = round(ring.length / _LAMP_PITCH_M)
    mark = (np.arange(count) + 0.5) * ring.length / count
    xy = shapely.get_coordinates(shapely.line_interpolate_point(ring, mark))
    xy = xy[shapely.distance(shapely.points(xy), shapely.LineString(grounds.access)) > _FROM_DRIVE_M]
    middle = np.array([grounds.car_park.frame.x_m, grounds.car_park.frame.y_m])
    inward = middle - xy
    return np.column_stack([xy, np.arctan2(inward[:, 1], inward[:, 0])])


def _benches(grounds: Grounds, rng: np.random.Generator) -> np.ndarray:
    """Along the front of the clubhouse, with their backs to it."""
    club = grounds.clubhouse
    x = np.linspace(-0.7, 0.7, int(rng.integers(2, 5))) * club.half_x_m
    xy = club.frame.world(np.column_stack([x, np.full(len(x), -club.half_y_m - 0.55)]))
    return np.column_stack([xy, np.full(len(x), club.frame.heading_rad)])


def _bins(grounds: Grounds, rng: np.random.Generator) -> np.ndarray:
    """At the ends of the main stand."""
    stand = grounds.stands[0]
    x = np.array([-1.0, 1.0]) * (stand.length_m / 2 + 2.2)
    xy = stand.frame.world(np.column_stack([x, rng.uniform(1.0, 3.0, 2)]))
    return np.column_stack([xy, np.zeros(2)])


def _road_sign(grounds: Grounds) -> np.ndarray:
    """Where the drive meets the road, facing the traffic."""
    gate = grounds.frame.local(grounds.access[1:])[0]
    xy = grounds.frame.world(np.array([[gate[0] + 5.0, grounds.road_y_m + ROAD_HALF_M + 1.4]]))
    return np.column_stack([xy, [grounds.frame.heading_rad]])


def _boards(grounds: Grounds, shop: FieldWorkshop, rng: np.random.Generator) -> list[Part]:
    """Boards before the rails of both touch lines, gaps where none was sold and at the gates."""
    half_x, half_y = grounds.half_m
    x = np.arange(-half_x + 9.0, half_x - 9.0, _BOARD_M + 0.08)
    x = x[np.abs(x) > _BOARD_M / 2 + 1.6]
    side, along = (g.ravel() for g in np.meshgrid([-1.0, 1.0], x, indexing="ij"))
    sold = rng.uniform(size=len(side)) < rng.uniform(0.2, 0.9)
    xy = grounds.frame.world(np.column_stack([along, side * (half_y - 0.62)])[sold])
    count = len(xy)
    if not count:
        return []
    paints = np.array(
        [
            *shop.palette.variants("steel_painted"),
            shop.palette.special("steel_painted", "white", solar_absorptance=0.32),
        ]
    )
    size = np.tile([_BOARD_M, _BOARD_THICK_M, _BOARD_HIGH_M + 0.05], (count, 1))
    return [
        boxes(
            np.column_stack([xy, shop.relief(xy) - 0.05]),
            size,
            np.full(count, grounds.frame.heading_rad),
            paints[rng.integers(len(paints), size=count)],
            np.full(count, int(Semantic.BARRIER)),
            shop.builder.new_objects(count) + np.arange(count),
            spacing_m=6.0,
        )
    ]


def _scoreboard(xy: np.ndarray, heading_rad: float, shop: FieldWorkshop) -> Part:
    position = np.array([[*xy, float(shop.relief(xy[None])[0])]])
    skins = np.array([[shop.palette.only("steel_galv_post"), shop.palette.only("plastic_dark")]])
    owner = np.array([shop.builder.new_objects()])
    return place(scoreboard(), position, np.array([heading_rad]), np.ones((1, 3)), skins, owner)


def scoreboard() -> Template:
    """A board of 4.6 by 2.2 m on two posts, facing +x. Slots: 0 posts, 1 board."""
    model = Modeller()
    for y in (-1.5, 1.5):
        foot, top = np.array([-0.12, y, -0.3]), np.array([-0.12, y, 2.4])
        model.tube(foot, top, 0.08, 0.08, 0, Semantic.SIGN, sides=6, sites=2)
    model.box((-0.2, -2.3, 2.4), (0.05, 2.3, 4.6), 1, Semantic.SIGN)
    under = np.array([[[-0.2, -2.3, 2.4], [-0.2, 2.3, 2.4], [0.05, 2.3, 2.4], [0.05, -2.3, 2.4]]])
    model.quads(under, 1, Semantic.SIGN)
    return model.finish()
