"""Parks: lawns, winding paths, a pond, benches; where trees may stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.maps.city.streets import KERB_M
from scenegen.maps.city.workshop import CityWorkshop

_PATH_HALF_M = 1.3
_BANK_M = 0.35
_BENCH_M = 2.3
"""Distance of trunks from the middle of a bench: beyond its ends and the bin beside it."""


@dataclass(frozen=True, eq=False)
class ParkPlan:
    """Lines and areas of one park.

    Attributes
    ----------
    lawn : shapely.Polygon
    paths : tuple of shapely.Polygon
    pond : shapely.Polygon or None
    beds : tuple of shapely.Polygon
        Planted soil.
    benches : float64 (benches, 3)
        Position and heading [m, m, rad].
    """

    lawn: shapely.Polygon
    paths: tuple[shapely.Polygon, ...]
    pond: shapely.Polygon | None
    beds: tuple[shapely.Polygon, ...]
    benches: np.ndarray

    def free(self) -> shapely.Geometry:
        """Lawn away from paths, pond, beds and benches: where trees may stand."""
        taken = [p.buffer(0.9) for p in self.paths] + [b.buffer(0.4) for b in self.beds]
        if self.pond is not None:
            taken.append(self.pond.buffer(1.5))
        taken += [shapely.Point(x, y).buffer(_BENCH_M) for x, y, _ in self.benches]
        return self.lawn.buffer(-1.5).difference(shapely.union_all(taken))


def plan_park(yard: shapely.Polygon, rng: np.random.Generator) -> ParkPlan:
    """Draw a park on a block: two paths from side to side that meet, a round walk, perhaps a pond."""
    centre = shapely.get_coordinates(yard.centroid)[0]
    reach = np.sqrt(yard.area) * 0.5
    hub = centre + rng.uniform(-0.15, 0.15, 2) * reach
    lines = [_winding(hub, angle, yard, reach, rng) for angle in _spokes(rng)]
    walk = yard.buffer(-0.22 * reach).simplify(1.0)
    outline = shapely.union_all(
        [shapely.LineString(line).buffer(_PATH_HALF_M, quad_segs=3) for line in lines]
    )
    if walk.geom_type == "Polygon" and walk.area > 400.0:
        outline = outline.union(walk.exterior.buffer(_PATH_HALF_M, quad_segs=3))
    paved = (
        outline.union(shapely.Point(hub).buffer(rng.uniform(3.0, 6.0)))
        .intersection(yard.buffer(0.3))
        .simplify(0.15)
    )
    paths = tuple(p for p in getattr(paved, "geoms", [paved]) if p.area > 3.0)
    pond = _pond(yard, paved, rng) if rng.uniform() < 0.75 else None
    beds = tuple(_beds(yard, paved, pond, hub, reach, rng))
    return ParkPlan(yard, paths, pond, beds, _benches(lines, yard, rng))


def _spokes(rng: np.random.Generator) -> np.ndarray:
    count = int(rng.integers(4, 6))
    return 2 * np.pi * (np.arange(count) + rng.uniform(-0.2, 0.2, count)) / count + rng.uniform(0, np.pi)


def _winding(
    hub: np.ndarray, angle: float, yard: shapely.Polygon, reach: float, rng: np.random.Generator
) -> np.ndarray:
    """A gently curved line from the hub across the edge of the park."""
    t = np.linspace(0.0, 2.6 * reach, 24)
    sway = rng.uniform(0.05, 0.12) * reach * np.sin(t / reach * rng.uniform(1.2, 2.2))
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    return np.asarray(hub + t[:, None] * along + sway[:, None] * across)


def _blob(centre: np.ndarray, radius: float, rng: np.random.Generator) -> shapely.Polygon:
    """A smooth irregular round outline."""
    angle = np.linspace(0.0, 2 * np.pi, 28, endpoint=False)
    shape = 1.0 + sum(
        rng.uniform(0.03, 0.16) / k * np.cos(k * angle + rng.uniform(0, 2 * np.pi)) for k in (2, 3, 4)
    )
    ring = centre + radius * np.asarray(shape)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return shapely.Polygon(ring)


def _pond(yard: shapely.Polygon, paved: shapely.Geometry, rng: np.random.Generator) -> shapely.Polygon | None:
    """The largest of a few draws that keeps clear of paths and edge."""
    room = yard.buffer(-4.0).difference(paved.buffer(1.2))
    pieces = sorted(getattr(room, "geoms", [room]), key=lambda p: -p.area)
    if not pieces or pieces[0].area < 250.0:
        return None
    centre = shapely.get_coordinates(shapely.maximum_inscribed_circle(pieces[0], tolerance=1.0))
    radius = float(np.linalg.norm(centre[1] - centre[0]))
    return _blob(centre[0], 0.8 * radius, rng).intersection(pieces[0]).buffer(-0.5).buffer(0.5).simplify(0.1)


def _beds(
    yard: shapely.Polygon,
    paved: shapely.Geometry,
    pond: shapely.Polygon | None,
    hub: np.ndarray,
    reach: float,
    rng: np.random.Generator,
) -> list[shapely.Polygon]:
    """Planted beds near the hub."""
    taken = paved.buffer(0.6) if pond is None else paved.buffer(0.6).union(pond.buffer(1.0))
    found: list[shapely.Polygon] = []
    for _ in range(8):
        bed = _blob(hub + rng.uniform(-0.6, 0.6, 2) * reach, rng.uniform(2.0, 5.0), rng).simplify(0.1)
        if yard.buffer(-2.0).contains(bed) and not taken.intersects(bed):
            found.append(bed)
            taken = taken.union(bed.buffer(1.0))
    return found


def _benches(lines: list[np.ndarray], yard: shapely.Polygon, rng: np.random.Generator) -> np.ndarray:
    """Benches beside the paths, looking at them."""
    rows = []
    for line in lines:
        for k in range(4, len(line) - 1, 4):
            step = (line[k + 1] - line[k]) / np.linalg.norm(line[k + 1] - line[k])
            side = 1.0 if rng.uniform() < 0.5 else -1.0
            spot = line[k] + side * (_PATH_HALF_M + 0.5) * np.array([-step[1], step[0]])
            if yard.buffer(-2.0).contains(shapely.Point(spot)):
                rows.append([*spot, float(np.arctan2(step[1], step[0])) + (np.pi if side < 0 else 0.0)])
    return np.array(rows).reshape(-1, 3)


def park_regions(
    park: ParkPlan,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> list[Region]:
    """Ground of a park on top of its lawn."""
    walk, planted, water = shop.builder.new_objects(), shop.builder.new_objects(), shop.builder.new_objects()
    gravel = shop.palette.pick("concrete_pavement" if rng.uniform() < 0.5 else "soil_dry", rng)
    semantic = int(Semantic.SIDEWALK)
    regions = [Region(p, gravel, semantic, walk, KERB_M) for p in park.paths]
    soil = shop.palette.pick("soil_wet", rng)
    regions += [Region(b, soil, int(Semantic.SOIL), planted, KERB_M) for b in park.beds]
    if park.pond is not None and not park.pond.is_empty and park.pond.geom_type == "Polygon":
        level = float(shop.relief(shapely.get_coordinates(park.pond.exterior)).min()) + KERB_M - _BANK_M
        skin = shop.palette.special("water_fresh_or_sea", "pond")  # the heat balance knows the season
        regions.append(Region(park.pond, skin, int(Semantic.WATER), water, level, absolute=True))
    return regions
