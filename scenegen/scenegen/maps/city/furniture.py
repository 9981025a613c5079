"""Street furniture: lamp posts, traffic lights over and beside the street, signs, benches, bins, bus shelters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come
from scenegen.maps.city.park import ParkPlan
from scenegen.maps.city.stops import Stops
from scenegen.maps.city.streets import KERB_M, Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.fixtures.erect import erect

_FROM_KERB_M = 0.6
_SIGNS = ("sign", "round_sign", "triangle_sign")
_AT_KERB = ("lamp", "traffic_light", "gantry_light", *_SIGNS, "litter_bin")
_GANTRY_SHARE, _BESIDE_M = 0.6, 0.3
_BIN_M, _BIN_GAP_M = 0.35, 0.2


@dataclass(frozen=True, eq=False)
class Furniture:
    """Places and headings of street furniture (x, y, rad) by kind of fixture."""

    rows: dict[str, Float64[np.ndarray, "_ 3"]]

    def posts(self) -> Float64[np.ndarray, "posts 2"]:
        """Where something stands at the kerbs."""
        return np.concatenate([r[:, :2] for name, r in self.rows.items() if name in _AT_KERB])


def plan_furniture(
    plan: StreetPlan,
    parks: dict[int, ParkPlan],
    stops: Stops,
    covered: int | None,
    rng: np.random.Generator,
) -> Furniture:
    """Choose where everything stands.

    Parameters
    ----------
    plan : StreetPlan
    parks : mapping
        Parks by block index.
    stops : Stops
    covered : int or None
        A street under a viaduct: no arms of lights reach over it.
    rng : numpy.random.Generator
    """
    lamps, lights, gantries, signs = _posts(plan, covered, rng)
    benches = np.concatenate([np.zeros((0, 3)), *(p.benches for p in parks.values())])
    kind = rng.integers(len(_SIGNS), size=len(signs))
    rows = {"lamp": lamps, "traffic_light": lights, "gantry_light": gantries, "bench": benches}
    rows |= {name: signs[kind == k] for k, name in enumerate(_SIGNS)}
    standing = np.concatenate([r[:, :2] for r in rows.values()])
    rows["litter_bin"] = _bins(lamps, benches, stops.shelters, standing, rng)
    shelters = stops.outlines()
    rows = {name: r[clear_of(shapely.points(r[:, :2]), shelters, _BESIDE_M)] for name, r in rows.items()}
    return Furniture(rows | {"bus_shelter": stops.shelters})


def build_furniture(furniture: Furniture, shop: CityWorkshop, rng: np.random.Generator) -> list[Part]:
    """All street furniture as parts."""
    parts = []
    for name, rows in furniture.rows.items():
        position = np.column_stack([rows[:, :2], shop.relief(rows[:, :2]) + KERB_M])
        parts += erect(name, position, rows[:, 2], shop, rng)
    return parts


def _bins(
    lamps: np.ndarray,
    benches: np.ndarray,
    shelters: np.ndarray,
    standing: np.ndarray,
    rng: np.random.Generator,
) -> Float64[np.ndarray, "bins 3"]:
    """Bins beside some lamps and benches and at every bus stop, clear of what stands already."""
    sides = ((lamps, -0.5 * np.pi, 0.75, 0.16), (benches, 0.0, 1.35, 0.5), (shelters, 0.0, 2.6, 1.0))
    found = [np.zeros((0, 3))]
    for rows, turn, reach_m, share in sides:
        some = rows[rng.uniform(size=len(rows)) < share]
        angle = some[:, 2] + turn
        xy = some[:, :2] + reach_m * np.column_stack([np.cos(angle), np.sin(angle)])
        found.append(np.column_stack([xy, some[:, 2]]))
    bins = np.concatenate(found)
    plans = shapely.buffer(shapely.points(bins[:, :2]), _BIN_M, quad_segs=2)
    bins = bins[clear_of(plans, shapely.points(standing), _BIN_GAP_M) & first_come(plans)]
    return np.asarray(bins)


def _posts(plan: StreetPlan, covered: int | None, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Places and headings (x, y, rad) of lamps along links; of lights, gantries and signs at their ends."""
    lamps: list[list[float] | None] = []
    lights: list[list[float] | None] = []
    gantries: list[list[float] | None] = []
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
        over = street.rank is Rank.ARTERIAL and link.street != covered and rng.uniform() < _GANTRY_SHARE
        (gantries if over else lights if street.rank is Rank.ARTERIAL else signs).extend(rows)

    def table(rows: list[list[float] | None]) -> np.ndarray:
        return np.array([r for r in rows if r is not None], np.float64).reshape(-1, 3)

    return table(lamps), table(lights), table(gantries), table(signs)
