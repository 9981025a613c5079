"""Point clouds for triangulations: a jittered hexagonal lattice, graded towards the distance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from jaxtyping import Float64


def hexagonal(
    x0: float,
    y0: float,
    x1: float,
    y1: float,
    spacing_m: float,
    rng: np.random.Generator,
    jitter: float = 0.18,
) -> Float64[np.ndarray, "points 2"]:
    """Jittered hexagonal lattice over a rectangle.

    Parameters
    ----------
    x0, y0, x1, y1 : float
        [m].
    spacing_m : float
        Distance between neighbours [m].
    rng : numpy.random.Generator
    jitter : float
        Largest shift of a point, over the spacing.
    """
    rise = spacing_m * np.sqrt(3) / 2
    x, y = np.meshgrid(np.arange(x0, x1, spacing_m), np.arange(y0, y1, rise))
    x = x + 0.5 * spacing_m * (np.arange(len(x)) % 2)[:, None]
    points = np.column_stack([x.ravel(), y.ravel()])
    return points + rng.uniform(-jitter, jitter, points.shape) * spacing_m


def graded_points(
    core: shapely.Polygon, far_m: float, spacing_m: float, rng: np.random.Generator, leap: float = 2.0
) -> Float64[np.ndarray, "points 2"]:
    """Fine lattice on a polygon, then bands around it, each twice as coarse and as wide as the last.

    Parameters
    ----------
    core : shapely.Polygon
        Where the lattice is fine.
    far_m : float
        Half the side of the square that is covered [m].
    spacing_m : float
        Of the fine lattice [m].
    rng : numpy.random.Generator
    leap : float
        How much coarser than the lattice the first band is.
    """
    shapely.prepare(core)
    x0, y0, x1, y1 = core.bounds
    points = hexagonal(x0, y0, x1, y1, spacing_m, rng)
    bands = [points[shapely.contains_xy(core, points)]]
    inner, spacing = 0.0, spacing_m * leap / 2.0
    while inner < 2 * far_m:
        spacing = min(2.0 * spacing, far_m / 10)
        outer = inner + 4 * spacing
        low_x, low_y = max(x0 - outer, 1.0 - far_m), max(y0 - outer, 1.0 - far_m)
        high_x, high_y = min(x1 + outer, far_m - 1.0), min(y1 + outer, far_m - 1.0)
        ring = hexagonal(low_x, low_y, high_x, high_y, spacing, rng)
        ring = ring[np.abs(ring).max(axis=1) < far_m - 0.3 * spacing]
        place = shapely.points(ring)
        outside = ~shapely.dwithin(core, place, inner + 0.3 * spacing)
        bands.append(ring[outside & shapely.dwithin(core, place, outer)])
        inner = outer
    return np.concatenate(bands)


def finer_near(
    core: shapely.Polygon,
    near: np.ndarray,
    spacing_m: tuple[float, float],
    reach_m: float,
    far_m: float,
    rng: np.random.Generator,
    leap: float = 2.0,
) -> Float64[np.ndarray, "points 2"]:
    """`graded_points` around a polygon, with a finer lattice near the things inside it.

    Parameters
    ----------
    core : shapely.Polygon
    near : array of shapely geometries
        What casts shadows: walls, cars, fences.
    spacing_m : (float, float)
        Of the lattice near them, and elsewhere [m].
    reach_m : float
        How far "near" is [m].
    far_m, leap : float
        See `graded_points`.
    rng : numpy.random.Generator
    """
    tree = shapely.STRtree(near)

    def close(points: np.ndarray, distance_m: float) -> np.ndarray:
        mask = np.zeros(len(points), bool)
        mask[tree.query(shapely.points(points), predicate="dwithin", distance=distance_m)[0]] = True
        return mask

    x0, y0, x1, y1 = core.bounds
    fine = hexagonal(x0, y0, x1, y1, spacing_m[0], rng)
    fine = fine[shapely.contains_xy(core, fine)]
    coarse = graded_points(core.buffer(3.0), far_m, spacing_m[1], rng, leap)
    return np.concatenate([fine[close(fine, reach_m)], coarse[~close(coarse, reach_m + spacing_m[0] / 2)]])


def contact_points(
    outlines: Sequence[shapely.Polygon], spacing_m: float, distance_m: float
) -> Float64[np.ndarray, "points 2"]:
    """A row of points around outlines: the ground near a contact line needs a finer mesh.

    Parameters
    ----------
    outlines : sequence of shapely.Polygon
    spacing_m : float
        Distance between points of the row [m].
    distance_m : float
        Of the row from the outline [m].
    """
    rows = shapely.boundary(
        shapely.buffer(np.asarray(outlines, dtype=object), distance_m, join_style="mitre")
    )
    points = []
    for row in shapely.get_parts(shapely.get_parts(rows)):
        count = max(int(np.ceil(row.length / spacing_m)), 3)
        points.append(
            shapely.get_coordinates(
                shapely.line_interpolate_point(row, np.arange(count) * row.length / count)
            )
        )
    return np.concatenate([np.zeros((0, 2)), *points])
