"""Street furniture: lamp posts, traffic lights, benches."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along
from scenegen.maps.city.park import ParkPlan
from scenegen.maps.city.streets import Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.fixtures.erect import erect

_KERB_M = 0.12
_FROM_KERB_M = 0.6
_SIGNS = ("sign", "round_sign", "triangle_sign")


def build_furniture(
    plan: StreetPlan,
    parks: dict[int, ParkPlan],
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], np.ndarray]:
    """All street furniture and the places of the posts (for trees to keep clear of)."""
    for_posts, for_skins = rng.spawn(2)
    lamps, lights, signs = _posts(plan, for_posts)
    benches = np.concatenate([np.zeros((0, 3)), *(p.benches for p in parks.values())])
    kind = for_posts.integers(len(_SIGNS), size=len(signs))
    groups = [("lamp", lamps), ("traffic_light", lights), ("bench", benches)]
    groups += [(name, signs[kind == k]) for k, name in enumerate(_SIGNS)]
    parts = []
    for name, rows in groups:
        position = np.column_stack([rows[:, :2], shop.relief(rows[:, :2]) + _KERB_M])
        parts += erect(name, position, rows[:, 2], shop, for_skins)
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
