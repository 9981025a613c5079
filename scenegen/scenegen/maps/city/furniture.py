"""Street furniture: lamp posts, traffic lights, benches."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.placement import along
from scenegen.geometry.template import Template, place
from scenegen.maps.city.park import ParkPlan
from scenegen.maps.city.streets import Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop

_KERB_M = 0.12
_FROM_KERB_M = 0.6


def lamp() -> Template:
    """A post of eight metres with an arm over the street (+x)."""
    model = Modeller()
    model.tube(np.array([0, 0, -0.1]), np.array([0, 0, 0.9]), 0.12, 0.11, 0, Semantic.POLE, sides=6, sites=3)
    model.tube(np.array([0, 0, 0.9]), np.array([0, 0, 7.6]), 0.08, 0.055, 0, Semantic.POLE, sides=6, sites=4)
    arm = np.array([0, 0, 7.55]), np.array([1.7, 0, 8.0])
    model.tube(*arm, 0.05, 0.035, 0, Semantic.POLE, sides=6, sites=4)
    model.box((1.3, -0.17, 7.95), (2.1, 0.17, 8.09), 0, Semantic.POLE)
    model.quads(
        np.array([[[1.3, -0.17, 7.95], [1.3, 0.17, 7.95], [2.1, 0.17, 7.95], [2.1, -0.17, 7.95]]]),
        1,
        Semantic.POLE,
    )
    return model.finish()


def traffic_light() -> Template:
    """Three lamps in a box at a post of 3.4 metres."""
    model = Modeller()
    model.tube(np.array([0, 0, -0.1]), np.array([0, 0, 3.4]), 0.07, 0.06, 0, Semantic.POLE, sides=6, sites=3)
    model.box((0.05, -0.16, 2.5), (0.3, 0.16, 3.45), 0, Semantic.TRAFFIC_LIGHT, LUMP_STANDOFF_M)
    return model.finish()


def sign() -> Template:
    """A plate at a thin post; its back sees past the post."""
    model = Modeller()
    post = np.array([0, 0, -0.1]), np.array([0, 0, 2.7])
    model.tube(*post, 0.035, 0.035, 0, Semantic.POLE, sides=6, sites=3)
    model.box((0.035, -0.35, 2.0), (0.06, 0.35, 2.7), 0, Semantic.SIGN, LUMP_STANDOFF_M)
    return model.finish()


def bench() -> Template:
    """Seat and back of wood on iron legs, looking along -y."""
    model = Modeller()
    model.box((-0.85, -0.25, 0.4), (0.85, 0.19, 0.46), 1, Semantic.STREET_FURNITURE)
    model.box((-0.85, 0.2, 0.45), (0.85, 0.26, 0.9), 1, Semantic.STREET_FURNITURE)
    for x in (-0.7, 0.65):
        model.box((x, -0.22, -0.05), (x + 0.06, 0.2, 0.4), 0, Semantic.STREET_FURNITURE, covered=True)
    return model.finish()


def build_furniture(
    plan: StreetPlan,
    parks: dict[int, ParkPlan],
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], np.ndarray]:
    """All street furniture and the places of the posts (for trees to keep clear of)."""
    metal, glass = shop.palette.pick("metal_galv_weathered", rng), shop.palette.pick("window_glass", rng)
    wood = shop.palette.pick("wood_siding", rng)
    lamps, lights, signs = _posts(plan, rng)
    benches = np.concatenate([np.zeros((0, 3)), *(p.benches for p in parks.values())])
    parts = []
    for template, rows, second in (
        (lamp(), lamps, glass),
        (traffic_light(), lights, glass),
        (sign(), signs, glass),
        (bench(), benches, wood),
    ):
        count = len(rows)
        position = np.column_stack([rows[:, :2], shop.relief(rows[:, :2]) + _KERB_M])
        skins = np.tile([[metal, second]], (count, 1))
        owner = shop.builder.new_objects(count) + np.arange(count)
        parts.append(place(template, position, rows[:, 2], np.ones((count, 3)), skins, owner))
    return parts, np.concatenate([lamps[:, :2], lights[:, :2], signs[:, :2]])


def _posts(plan: StreetPlan, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places and headings (x, y, rad) of lamps along links, of lights and signs at their ends."""
    lamps: list[list[float] | None] = []
    lights: list[list[float] | None] = []
    signs: list[list[float] | None] = []
    blocks = shapely.STRtree(np.asarray(plan.blocks, dtype=object))

    def post(line: np.ndarray, distance: float, right: float) -> list[float] | None:
        xy, heading = along(line, np.array([distance]), np.array([right]))
        if not len(blocks.query(shapely.Point(xy[0]), predicate="within")):
            return None
        return [*xy[0], float(heading[0]) + (0.5 * np.pi if right > 0 else -0.5 * np.pi)]

    for link in plan.links:
        street = plan.streets[link.street]
        edge = street.width_m / 2 + _FROM_KERB_M
        pitch = 26.0 if street.rank is Rank.ARTERIAL else 31.0
        marks = np.arange(link.start_m + 4.0, link.end_m - 2.0, pitch)
        sides = np.where((np.arange(len(marks)) + int(rng.integers(2))) % 2 == 0, 1.0, -1.0)
        lamps += [post(street.line, float(m), float(s) * edge) for m, s in zip(marks, sides, strict=True)]
        ends = ((link.end_m - 0.5, 1.0), (link.start_m + 0.5, -1.0))
        rows = [post(street.line, at, side * edge) for at, side in ends]
        for row in rows:
            if row is not None:
                row[2] += 0.5 * np.pi
        (lights if street.rank is Rank.ARTERIAL else signs).extend(rows)

    def table(rows: list[list[float] | None]) -> np.ndarray:
        return np.array([r for r in rows if r is not None], np.float64).reshape(-1, 3)

    return table(lamps), table(lights), table(signs)
