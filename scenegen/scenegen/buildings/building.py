"""Buildings as plans: volumes with storeys and a style, before they become geometry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.buildings.footprints import draw_rings, polygon_of, rectangle_ring
from scenegen.buildings.lots import Lot
from scenegen.buildings.styles import Kind, Roof, Style


@dataclass(frozen=True, eq=False)
class Volume:
    """A prism with a roof: a building, or one tier of it.

    Attributes
    ----------
    rings : tuple of float64 (points, 2)
        Outer ring counter-clockwise, then courtyards clockwise; open. A pitched roof wants one ring of four
        points.
    floor_m : float
        Floor of its lowest storey [m].
    storeys : int
    foundation_m : float
        How far its walls continue below the floor.
    form : Roof
    covered : shapely.Polygon or None
        Part of its roof that another tier stands on.
    """

    rings: tuple[Float64[np.ndarray, "points 2"], ...]
    floor_m: float
    storeys: int
    foundation_m: float
    form: Roof
    covered: shapely.Polygon | None = None

    def eave_m(self, style: Style) -> float:
        """Height of the flat roof or of the eaves [m]."""
        return self.floor_m + style.first_storey_m + (self.storeys - 1) * style.storey_m


@dataclass(frozen=True, eq=False)
class Building:
    """One building: one instance.

    Attributes
    ----------
    kind : Kind
    object : int
        Instance id.
    style : Style
    volumes : tuple of Volume
    footprint : shapely.Polygon
    front : float64 (2, 2) or None
        Middle of its street front and the foot of its path on the sidewalk [m].
    """

    kind: Kind
    object: int
    style: Style
    volumes: tuple[Volume, ...]
    footprint: shapely.Polygon
    front: Float64[np.ndarray, "2 2"] | None = None


@dataclass(frozen=True)
class Wish:
    """What a lot's building should be like; all in metres.

    Attributes
    ----------
    length_m, depth_m, setback_m : (float, float)
        Ranges of size and of the distance from the sidewalk.
    side_m : float
        Distance kept from the neighbours' lots.
    shaped : bool
        Whether footprints other than rectangles may be drawn.
    """

    length_m: tuple[float, float]
    depth_m: tuple[float, float]
    setback_m: tuple[float, float]
    side_m: float
    shaped: bool


def fit_footprint(
    lot: Lot, wish: Wish, rng: np.random.Generator
) -> tuple[tuple[np.ndarray, ...], np.ndarray] | None:
    """Place a footprint behind the street front of a lot.

    Returns
    -------
    rings, front : tuple of float64 (points, 2), float64 (2, 2)
        Rings in the plan; middle of the front wall and of the sidewalk before it. None if the lot is too
        small.
    """
    length, depth = rng.uniform(*wish.length_m), rng.uniform(*wish.depth_m)
    setback, lean = rng.uniform(*wish.setback_m), rng.uniform(-0.2, 0.2)
    room = lot.local().buffer(-wish.side_m, join_style="mitre")
    if room.is_empty:
        return None
    x0, _, x1, y1 = room.bounds
    spare_x, spare_y = x1 - x0, y1
    shrink = np.array([1.0, 0.88, 0.76, 0.64, 0.52])
    a, b, shift, back = (
        g.ravel()
        for g in np.meshgrid(
            np.minimum(length, 0.98 * spare_x) * shrink,
            np.minimum(depth, 0.95 * spare_y) * shrink,
            np.array([lean, 0.0, -0.35, 0.35]),
            setback + np.array([0.0, 1.2, 3.0]),
            indexing="ij",
        )
    )
    middle = (x0 + x1) / 2 + shift * (spare_x - a)
    boxes = shapely.box(middle - a / 2, back, middle + a / 2, back + b)
    shapely.prepare(room)
    fits = shapely.contains(room, boxes) & (a > 7.0) & (b > 7.0)
    if not fits.any():
        return None
    k = int(np.argmax(np.where(fits, a * b - 3.0 * back * a, -1e9)))
    origin = np.array([middle[k] - a[k] / 2, back[k]])
    local = (
        draw_rings(float(a[k]), float(b[k]), rng)
        if wish.shaped
        else [rectangle_ring(0, 0, float(a[k]), float(b[k]))]
    )
    shape = shapely.orient_polygons(polygon_of([r + origin for r in local]))
    rings = tuple(lot.world(shapely.get_coordinates(r)[:-1]) for r in (shape.exterior, *shape.interiors))
    front = lot.world(np.array([[middle[k], back[k]], [middle[k], 0.0]]))
    return rings, front


def outline_of(rings: tuple[np.ndarray, ...]) -> shapely.Polygon:
    """Footprint of rings."""
    return shapely.Polygon(rings[0], rings[1:])


def rings_of(outline: shapely.Polygon) -> tuple[np.ndarray, ...]:
    """Open rings of a polygon with the solid on their left."""
    oriented = shapely.orient_polygons(outline)
    return tuple(shapely.get_coordinates(r)[:-1] for r in (oriented.exterior, *oriented.interiors))
