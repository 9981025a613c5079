"""The land around: fields, meadows and woods between bent boundaries, a country road, a farm, a pond."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import shapely
from jaxtyping import Float64
from shapely.ops import split

from scenegen.maps.field.frame import Frame, Plot
from scenegen.maps.field.grounds import Grounds
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.field.pylons import CORRIDOR_M, draw_line

FAR_M = 2400.0
"""Half the side of the land [m]."""

ROAD_HALF_M = 3.0
"""Half the width of the country road [m]."""

STATION_M = 3.0
"""Distance between points of the country road in the detailed square [m]."""

_DRIVE_HALF_M = 2.6
_CHORD_M = 24.0
_FAR_CHORD_M = 70.0


class Cover(StrEnum):
    """What grows on a parcel."""

    MEADOW = "meadow"
    HAY = "hay"
    CROP = "crop"
    STUBBLE = "stubble"
    PLOUGHED = "ploughed"
    WOOD = "wood"


@dataclass(frozen=True, eq=False)
class Parcel:
    """A piece of land under one cover.

    Attributes
    ----------
    outline : shapely.Polygon
    cover : Cover
    heading_rad : float
        Of its longer side: rows and swaths run along it.
    distance_m : float
        Of its middle from the origin.
    """

    outline: shapely.Polygon
    cover: Cover
    heading_rad: float
    distance_m: float


@dataclass(frozen=True, eq=False)
class Farm:
    """A farmstead: barn and house on a yard."""

    yard: Plot
    barn: Plot
    house: Plot
    track: Float64[np.ndarray, "2 2"]


@dataclass(frozen=True, eq=False)
class Country:
    """Everything outside the fence.

    Attributes
    ----------
    parcels : tuple of Parcel
    boundaries : tuple of float64 (points, 2)
        Lines between parcels.
    road : float64 (points, 2)
        Centre line of the country road.
    drive : shapely.Polygon
        From the road to the car park.
    farm : Farm
    pond : Plot or None
        Its platform; the water lies inside.
    pylons : float64 (towers, 2) or None
        Feet of the towers of a high-voltage line.
    """

    parcels: tuple[Parcel, ...]
    boundaries: tuple[Float64[np.ndarray, "_ 2"], ...]
    road: Float64[np.ndarray, "stations 2"]
    drive: shapely.Polygon
    farm: Farm
    pond: Plot | None
    pylons: Float64[np.ndarray, "towers 2"] | None

    @property
    def corridor(self) -> shapely.Geometry:
        """The strip below the high-voltage line, empty without one."""
        if self.pylons is None:
            return shapely.Polygon()
        return shapely.LineString(self.pylons).buffer(CORRIDOR_M)

    @property
    def carriageway(self) -> shapely.Polygon:
        """Plan of the country road."""
        return ribbon(self.road, -ROAD_HALF_M, ROAD_HALF_M)


def lay_out_country(grounds: Grounds, half_m: float, knobs: FieldKnobs, rng: np.random.Generator) -> Country:
    """Draw the land around the grounds.

    Parameters
    ----------
    grounds : Grounds
    half_m : float
        Half the side of the detailed square.
    knobs : FieldKnobs
    rng : numpy.random.Generator
    """
    road = _road(grounds, half_m, rng)
    drive = shapely.LineString(grounds.access).buffer(_DRIVE_HALF_M, cap_style="flat")
    farm = _farm(grounds, half_m, rng)
    taken = [grounds.outline.buffer(18.0), shapely.LineString(road).buffer(20.0), farm.yard.outline(18.0)]
    free = shapely.union_all(taken)
    pond = _pond(free, half_m, rng) if rng.uniform() < rng.uniform(*knobs.pond_share) else None
    masts = shapely.union_all([grounds.outline.buffer(6.0), farm.yard.outline(4.0)])
    crossed = rng.uniform() < rng.uniform(*knobs.pylon_share)
    pylons = draw_line(_with_pond(masts, pond), half_m, FAR_M, rng) if crossed else None
    parcels, boundaries = _parcels(grounds.frame.heading_rad, knobs, rng)
    return Country(parcels, boundaries, road, drive, farm, pond, pylons)


def _with_pond(taken: shapely.Geometry, pond: Plot | None) -> shapely.Geometry:
    return taken if pond is None else taken.union(pond.outline())


def ribbon(line: Float64[np.ndarray, "points 2"], left_m: float, right_m: float) -> shapely.Polygon:
    """What lies between two offsets to the right of a line; corners opposite each other, one per point."""
    return shapely.Polygon(np.concatenate([offset_line(line, left_m), offset_line(line, right_m)[::-1]]))


def offset_line(line: Float64[np.ndarray, "points 2"], right_m: float) -> Float64[np.ndarray, "points 2"]:
    """A gently bent line moved to its right, point by point."""
    step = np.gradient(line, axis=0)
    step = step / np.linalg.norm(step, axis=1)[:, None]
    return np.asarray(line + right_m * np.column_stack([step[:, 1], -step[:, 0]]))


def _road(grounds: Grounds, half_m: float, rng: np.random.Generator) -> np.ndarray:
    """A road past the grounds that bends away from them on both sides, out to the far edge.

    Its points lie `STATION_M` apart in the detailed square, so that paint and edges share their stations.
    """
    near = STATION_M * np.arange(np.ceil(1.2 * half_m / STATION_M) + 1)
    far = np.arange(near[-1] + 40.0, 2.0 * FAR_M, 40.0)
    x = np.concatenate([-far[::-1], -near[:0:-1], near, far])
    reach = np.where(x < 0, rng.uniform(300.0, 520.0), rng.uniform(300.0, 520.0))
    away = np.where(x < 0, rng.uniform(20.0, 90.0), rng.uniform(20.0, 90.0))
    y = grounds.road_y_m - away * (1.0 - np.cos(x / reach))
    line = grounds.frame.world(np.column_stack([x, y]))
    inside = np.abs(line).max(axis=1) < FAR_M - 20.0
    return np.asarray(line[inside])


def _farm(grounds: Grounds, half_m: float, rng: np.random.Generator) -> Farm:
    """Beyond the road, off to one side; its track meets the road at a right angle."""
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    x, y = side * rng.uniform(0.25, 0.6) * half_m, grounds.road_y_m - rng.uniform(42.0, 60.0)
    yard = Plot(grounds.frame.at(x, y), 27.0, 18.0)
    long, deep = rng.uniform(22.0, 32.0), rng.uniform(11.0, 15.0)
    barn = Plot(grounds.frame.at(x - 8.0, y - 17.0 + deep / 2, np.pi), long / 2, deep / 2)
    house = Plot(grounds.frame.at(x + 18.5, y + 8.0, np.pi / 2), rng.uniform(5.0, 6.5), rng.uniform(4.3, 5.2))
    track = grounds.frame.world(np.array([[x - 4.0, y + 5.0], [x - 4.0, grounds.road_y_m - 1.0]]))
    return Farm(yard, barn, house, track)


def _pond(taken: shapely.Geometry, half_m: float, rng: np.random.Generator) -> Plot | None:
    """The first of some drawn places that is free."""
    for _ in range(40):
        x, y = rng.uniform(-0.9 * half_m, 0.9 * half_m, 2)
        plot = Plot(
            Frame(float(x), float(y), rng.uniform(0.0, np.pi)),
            rng.uniform(14.0, 26.0),
            rng.uniform(10.0, 17.0),
        )
        if not taken.intersects(plot.outline()):
            return plot
    return None


def _parcels(
    heading_rad: float, knobs: FieldKnobs, rng: np.random.Generator
) -> tuple[tuple[Parcel, ...], tuple[np.ndarray, ...]]:
    """Divide the land by straight cuts, bend them, and give each piece a cover."""
    lines = _divide(heading_rad, rng)
    wave = 2 * np.pi / rng.uniform(350.0, 900.0, (2, 2))
    phase = rng.uniform(0.0, 2 * np.pi, 2)

    def bend(xy: np.ndarray) -> np.ndarray:
        shift = (
            np.sin(xy @ wave + phase)
            * np.minimum(np.abs(np.abs(xy).max(axis=1) - FAR_M), 260.0)[:, None]
            * 0.07
        )
        return np.asarray(xy + shift[:, ::-1])

    cuts = shapely.linestrings(np.stack(lines))
    far = shapely.distance(cuts, shapely.Point(0.0, 0.0)) > 340.0
    cuts = shapely.segmentize(cuts, np.where(far, _FAR_CHORD_M, _CHORD_M))
    bent = [bend(shapely.get_coordinates(cut)) for cut in cuts]
    edge = shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M).exterior
    net = shapely.unary_union([edge, *(shapely.LineString(b) for b in bent)], grid_size=0.001)
    pieces = shapely.get_parts(shapely.polygonize(shapely.get_parts(net)))
    pieces = pieces[shapely.area(pieces) > 300.0]
    return tuple(_parcel(p, c, rng) for p, c in zip(pieces, _covers(pieces, knobs, rng), strict=True)), tuple(
        bent
    )


def _divide(heading_rad: float, rng: np.random.Generator) -> list[np.ndarray]:
    """Straight cuts across the land; parcels grow with distance. Ends reach a little past the lines they meet."""
    cells, cuts = [shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M)], []
    first = True
    while cells:
        cell = cells.pop(0)
        middle = shapely.get_coordinates(cell.centroid)[0]
        reach = float(shapely.distance(cell, shapely.Point(0.0, 0.0)))
        if cell.area < np.exp(rng.normal(0.0, 0.3)) * (14_000.0 + 0.9 * reach**1.55):
            continue
        corners = shapely.get_coordinates(cell.minimum_rotated_rectangle)
        sides = np.diff(corners[:3], axis=0)
        lengths = np.linalg.norm(sides, axis=1)
        long = int(lengths[1] > lengths[0])
        angle = heading_rad if first else float(np.arctan2(*sides[1 - long][::-1])) + rng.normal(0.0, 0.12)
        first = False
        at = middle + sides[long] * rng.uniform(-0.16, 0.16)
        step = 4.0 * FAR_M * np.array([np.cos(angle), np.sin(angle)])
        line = shapely.LineString([at - step, at + step])
        inside = shapely.get_coordinates(line.intersection(cell))
        pieces = [p for p in split(cell, line).geoms if p.area > 1.0]
        if len(pieces) != 2 or len(inside) != 2:
            continue
        past = 6.0 * (inside[1] - inside[0]) / np.linalg.norm(inside[1] - inside[0])
        cuts.append(np.array([inside[0] - past, inside[1] + past]))
        cells.extend(pieces)
    return cuts


def _covers(pieces: np.ndarray, knobs: FieldKnobs, rng: np.random.Generator) -> list[Cover]:
    """Woods rather in the distance and in clusters, crops and meadows anywhere."""
    wood, crop = rng.uniform(*knobs.wood_share), rng.uniform(*knobs.crop_share)
    middle = shapely.get_coordinates(shapely.centroid(pieces))
    reach = np.linalg.norm(middle, axis=1)
    heading = rng.uniform(0.0, 2 * np.pi)
    side = middle @ np.array([np.cos(heading), np.sin(heading)]) / FAR_M
    liking = side + rng.normal(0.0, 0.45, len(pieces)) - np.where(reach < 140.0, 9.0, 0.0)
    order = np.argsort(-liking)
    area = np.cumsum(shapely.area(pieces)[order])
    woods = np.zeros(len(pieces), bool)
    woods[order[area < wood * area[-1]]] = True
    drawn, kind = rng.uniform(size=len(pieces)), rng.choice(3, len(pieces), p=[0.5, 0.3, 0.2])
    fields = [(Cover.CROP, Cover.STUBBLE, Cover.PLOUGHED)[int(k)] for k in kind]
    meadows = [Cover.HAY if d > 1.0 - 0.35 * (1.0 - crop) else Cover.MEADOW for d in drawn]
    return [
        Cover.WOOD if w else f if d < crop else m
        for w, d, f, m in zip(woods, drawn, fields, meadows, strict=True)
    ]


def _parcel(outline: shapely.Polygon, cover: Cover, rng: np.random.Generator) -> Parcel:
    corners = shapely.get_coordinates(outline.minimum_rotated_rectangle)
    sides = np.diff(corners[:3], axis=0)
    long = sides[int(np.argmax(np.linalg.norm(sides, axis=1)))]
    middle = shapely.get_coordinates(outline.centroid)[0]
    return Parcel(outline, cover, float(np.arctan2(long[1], long[0])), float(np.linalg.norm(middle)))
