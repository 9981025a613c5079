"""Blocks become lots, each seen from its street; or, cut along party walls, perimeter buildings."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from jaxtyping import Float64
from shapely.ops import polygonize, split


@dataclass(frozen=True, eq=False)
class Lot:
    """A piece of a block.

    Attributes
    ----------
    area : shapely.Polygon
    corner : float64 (2,)
        Left end of its frontage, seen from the lot towards the street [m].
    heading_rad : float
        Direction of the frontage; the lot lies to its left.
    frontage_m : float
        Length of the frontage; 0 for a lot behind others, without a street.
    """

    area: shapely.Polygon
    corner: Float64[np.ndarray, "2"]
    heading_rad: float
    frontage_m: float

    def local(self) -> shapely.Polygon:
        """The lot in its own frame: frontage along +x from the origin, depth along +y."""
        moved = shapely.affinity.translate(self.area, -self.corner[0], -self.corner[1])
        return shapely.affinity.rotate(moved, -self.heading_rad, origin=(0, 0), use_radians=True)

    def world(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points 2"]:
        """Points of the lot's frame in the plan."""
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return np.asarray(xy @ np.array([[c, s], [-s, c]]) + self.corner)


def divide_lots(
    yard: shapely.Polygon, lot_area_m2: tuple[float, float], rng: np.random.Generator
) -> list[Lot]:
    """Divide the inner part of a block.

    Parameters
    ----------
    yard : shapely.Polygon
        Block without its sidewalk.
    lot_area_m2 : (float, float)
        Range from which the area that ends division is drawn, per lot.
    rng : numpy.random.Generator
    """
    todo, done = [yard], []
    while todo:
        area = todo.pop(0)
        if area.area < 1.5 * rng.uniform(*lot_area_m2):
            done.append(area)
            continue
        corners = shapely.get_coordinates(area.minimum_rotated_rectangle)
        sides = np.diff(corners[:3], axis=0)
        lengths = np.linalg.norm(sides, axis=1)
        long = int(lengths[1] > lengths[0])
        middle = shapely.get_coordinates(area.centroid)[0] + sides[long] * rng.uniform(-0.12, 0.12)
        cut = shapely.LineString([middle - sides[1 - long] * 2, middle + sides[1 - long] * 2])
        pieces = [p for p in split(area, cut).geoms if p.area > 30.0]
        if len(pieces) < 2:
            done.append(area)
        else:
            todo.extend(pieces)
    return [_seen_from_street(area, yard) for area in done]


def row_lots(yard: shapely.Polygon, width_m: tuple[float, float], rng: np.random.Generator) -> list[Lot]:
    """Divide a block into two rows of narrow lots, back to back, each with its front to a long side.

    Parameters
    ----------
    yard : shapely.Polygon
        Block without its sidewalk.
    width_m : (float, float)
        Range from which the width of the lots is drawn, per row.
    rng : numpy.random.Generator
    """
    corners = shapely.get_coordinates(yard.minimum_rotated_rectangle)
    sides = np.diff(corners[:3], axis=0)
    lengths = np.linalg.norm(sides, axis=1)
    long, short = sides[int(np.argmax(lengths))], sides[int(np.argmin(lengths))]
    middle = shapely.get_coordinates(yard.centroid)[0]
    rows = list(split(yard, shapely.LineString([middle - long, middle + long])).geoms)
    lots = []
    for row in rows:
        origin = shapely.get_coordinates(row.minimum_rotated_rectangle.centroid)[0]
        count = max(int(lengths.max() / rng.uniform(*width_m)), 1)
        marks = (np.arange(1, count) + rng.uniform(-0.15, 0.15, count - 1)) / count - 0.5
        pieces = [row]
        for mark in marks:
            at = origin + mark * long
            cut = shapely.LineString([at - short, at + short])
            pieces = [p for piece in pieces for p in split(piece, cut).geoms]
        lots += [_seen_from_street(p, yard) for p in pieces if p.area > 60.0]
    return lots


def _seen_from_street(area: shapely.Polygon, yard: shapely.Polygon) -> Lot:
    """Find the straight run of a lot's outline that lies on the block's edge."""
    ring = shapely.get_coordinates(shapely.orient_polygons(area).exterior)
    start, step = ring[:-1], np.diff(ring, axis=0)
    middle = shapely.points(start + step / 2)
    length = np.linalg.norm(step, axis=1)
    on_edge = shapely.distance(middle, yard.exterior) < 0.05
    if not on_edge.any():
        k = int(np.argmax(length))
        return Lot(area, start[k], float(np.arctan2(step[k, 1], step[k, 0])), 0.0)
    heading = np.arctan2(step[:, 1], step[:, 0])
    run = np.array([(length * on_edge * (np.cos(heading - h) > 0.97)).sum() for h in heading]) * on_edge
    k = int(np.argmax(run))
    along = np.array([np.cos(heading[k]), np.sin(heading[k])])
    mine = on_edge & (np.cos(heading - heading[k]) > 0.97)
    left = start[mine][int(np.argmin(start[mine] @ along))]
    return Lot(area, left, float(heading[k]), float(run[k]))


def perimeter_sectors(
    yard: shapely.Polygon, depth_m: float, frontage_m: tuple[float, float], rng: np.random.Generator
) -> list[shapely.Polygon]:
    """Cut the rim of a block into buildings that share party walls; corner buildings keep their corner.

    Parameters
    ----------
    yard : shapely.Polygon
        Street fronts.
    depth_m : float
        Depth of the rim.
    frontage_m : (float, float)
        Range of the distance between party walls.
    rng : numpy.random.Generator
    """
    court = yard.buffer(-depth_m, join_style="mitre").simplify(0.3)
    if court.geom_type != "Polygon" or court.area < 150.0:
        return []
    rim = shapely.Polygon(yard.exterior, [court.exterior])
    front = shapely.get_coordinates(court.exterior)
    cuts = []
    for a, b in pairwise(front):
        side, length = (b - a), float(np.linalg.norm(b - a))
        count = int(length // rng.uniform(*frontage_m))
        if length < 9.0:
            continue
        marks = (np.arange(count + 1) + rng.uniform(-0.12, 0.12, count + 1)) / max(count, 1)
        marks = np.clip(marks, 3.0 / length, 1 - 3.0 / length) if count else np.array([0.5])
        outward = np.array([side[1], -side[0]]) / length * _sign(front)
        cuts += [
            shapely.LineString([p - 0.5 * outward, p + 1.6 * depth_m * outward])
            for p in a + marks[:, None] * side
        ]
    noded = shapely.unary_union([rim.exterior, rim.interiors[0], *cuts], grid_size=0.001)
    pieces = [p for p in polygonize(noded) if rim.contains(p.representative_point())]
    return [shapely.Polygon(p.exterior) for p in pieces]


def _sign(ring: np.ndarray) -> float:
    """+1 where the right side of the ring's direction is its outside."""
    return 1.0 if shapely.LinearRing(ring).is_ccw else -1.0
