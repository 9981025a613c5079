"""Blocks become lots: the inner part of a block is divided across its longer side until lots have a building's size."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.ops import split

_OPEN = {"join_style": "mitre"}


def divide_lots(
    yard: shapely.Polygon, lot_area_m2: tuple[float, float], rng: np.random.Generator
) -> list[shapely.Polygon]:
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
        lot = todo.pop(0)
        if lot.area < 1.5 * rng.uniform(*lot_area_m2):
            done.append(lot)
            continue
        corners = shapely.get_coordinates(lot.minimum_rotated_rectangle)
        sides = np.diff(corners[:3], axis=0)
        lengths = np.linalg.norm(sides, axis=1)
        long = int(lengths[1] > lengths[0])
        middle = shapely.get_coordinates(lot.centroid)[0] + sides[long] * rng.uniform(-0.12, 0.12)
        cut = shapely.LineString([middle - sides[1 - long] * 2, middle + sides[1 - long] * 2])
        pieces = [p for p in split(lot, cut).geoms if p.area > 30.0]
        if len(pieces) < 2:
            done.append(lot)
        else:
            todo.extend(pieces)
    return done


def largest_rectangle(area: shapely.Polygon, heading_rad: float, aspect: float) -> tuple[np.ndarray, float, float] | None:
    """A large rectangle of given heading inside a polygon, by shrinking around a well inner point.

    Returns
    -------
    centre, length, width : float64 (2,), float, float
        [m]; None if the polygon is too slim.
    """
    if area.is_empty or area.area < 40.0:
        return None
    turned = shapely.affinity.rotate(area, -heading_rad, origin=(0, 0), use_radians=True)
    x0, y0, x1, y1 = turned.bounds
    best: tuple[float, float, float, float, float] | None = None
    shapely.prepare(turned)
    for fx in (0.5, 0.42, 0.58):
        for fy in (0.5, 0.42, 0.58):
            x, y = x0 + fx * (x1 - x0), y0 + fy * (y1 - y0)
            for stretch in (1.0, aspect, 1.0 / aspect):
                half = _grow(turned, x, y, (x1 - x0) / 2 * stretch, (y1 - y0) / 2)
                if half is not None and (best is None or half[0] * half[1] > best[0]):
                    best = (half[0] * half[1], x, y, half[0], half[1])
    if best is None or min(best[3:]) < 3.0:
        return None
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    centre = np.array([c * best[1] - s * best[2], s * best[1] + c * best[2]])
    return centre, 2 * best[3], 2 * best[4]


def _grow(area: shapely.Polygon, x: float, y: float, dx: float, dy: float) -> tuple[float, float] | None:
    """Largest of a ladder of scaled rectangles that fits."""
    scales = np.linspace(1.0, 0.3, 15)
    fits = shapely.contains(area, shapely.box(x - scales * dx, y - scales * dy, x + scales * dx, y + scales * dy))
    if not fits.any():
        return None
    scale = scales[int(np.argmax(fits))]
    return float(scale * dx), float(scale * dy)
