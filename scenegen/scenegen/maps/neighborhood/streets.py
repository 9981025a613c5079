"""Streets in the plan: centre lines, carriageway, verges and sidewalks, and the ground they leave for gardens."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.placement import roads_out
from scenegen.maps.neighborhood.network import TURNING_RADIUS_M, Network, draw_network
from scenegen.maps.neighborhood.warp import Warp

KERB_M = 0.12
"""Height of verges, sidewalks and gardens above the carriageway [m]."""

CARRIAGEWAY_M = 7.2
"""Kerb to kerb [m]."""

FAR_M = 2400.0
"""Half the side of the square that is land at all [m]."""

DEEPEST = 1.12
"""Depth of the deepest lots over the usual one."""

_CHORD_M, _MARGIN_M = 7.0, 7.0
_KERB_RADIUS_M = 5.0
_GRID_M = 0.001


@dataclass(frozen=True, eq=False)
class StreetPlan:
    """All streets of a neighborhood.

    Attributes
    ----------
    lines : tuple of float64 (points, 2)
        Centre lines between junctions, dead ends and exits [m].
    dead_end : tuple of (bool, bool)
        Whether each line starts, ends in a turning circle.
    carriageway : shapely.Polygon
        With rounded kerbs; holes are the blocks.
    verge_m, walk_m : float
        Width of the grass strip along the kerb, and of the sidewalk behind it.
    front : shapely.Polygon
        Everything public: carriageway, verges, sidewalks. Gardens begin at its outline.
    outline : shapely.Polygon
        Of the detailed part: gardens and commons included.
    exits : float64 (exits, 2, 2)
        Where streets leave, and in which direction.
    """

    lines: tuple[Float64[np.ndarray, "_ 2"], ...]
    dead_end: tuple[tuple[bool, bool], ...]
    carriageway: shapely.Polygon
    verge_m: float
    walk_m: float
    front: shapely.Polygon
    outline: shapely.Polygon
    exits: Float64[np.ndarray, "exits 2 2"]

    @property
    def public_m(self) -> float:
        """From the kerb to the gardens."""
        return self.verge_m + self.walk_m


def draw_streets(
    extent_m: float, lot_depth_m: float, curvature: float, cul_de_sac_share: float, rng: np.random.Generator
) -> StreetPlan:
    """Draw all streets around the origin.

    Parameters
    ----------
    extent_m : float
        Side of the square the network fills.
    lot_depth_m : float
    curvature, cul_de_sac_share : float
        See `Warp.draw` and `draw_network`.
    rng : numpy.random.Generator
    """
    verge = float(rng.choice([0.0, 1.6, 2.2])) * float(rng.uniform(0.9, 1.1))
    walk = float(rng.uniform(1.4, 1.9))
    pitch = 2 * lot_depth_m + CARRIAGEWAY_M + 2 * (verge + walk)
    network = draw_network(extent_m, pitch, cul_de_sac_share, rng)
    warp, turn = Warp.draw(curvature, extent_m, rng), rng.uniform(0.0, 2 * np.pi)
    lines = tuple(_wind(line, warp, turn) for line in network.lines)
    inner = _carriageway(lines, network)
    reach = DEEPEST * lot_depth_m + verge + walk + _MARGIN_M
    outline = shapely.Polygon(inner.buffer(reach + 14.0, quad_segs=4).exterior)
    outline = outline.buffer(-14.0, quad_segs=4).simplify(0.5)
    exits = np.array([[e[0], e[0] + e[1]] for e in network.exits]).reshape(-1, 2)
    bent = _turned(warp(exits), turn).reshape(-1, 2, 2)
    bent[:, 1] -= bent[:, 0]
    ways = shapely.buffer(road_lines(bent), CARRIAGEWAY_M / 2, cap_style="flat")
    out = [_largest(shapely.intersection(way, outline)) for way in ways]
    carriageway = _largest(shapely.union_all([inner, *out], grid_size=_GRID_M))
    front = shapely.set_precision(_filled(carriageway, verge + walk), _GRID_M)
    return StreetPlan(lines, network.dead_end, carriageway, verge, walk, front, outline, bent)


def road_lines(exits: Float64[np.ndarray, "exits 2 2"]) -> np.ndarray:
    """Centre lines of the roads on which streets go on outwards, up to the far edge, as shapely lines."""
    return roads_out(exits, FAR_M, sway_m=45.0, bend_m=380.0, tuck_m=1.0, points=60)


def _wind(line: np.ndarray, warp: Warp, turn_rad: float) -> np.ndarray:
    chords = shapely.get_coordinates(shapely.segmentize(shapely.LineString(line), _CHORD_M))
    return _turned(warp(chords), turn_rad)


def _turned(xy: np.ndarray, angle_rad: float) -> np.ndarray:
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.asarray(xy @ np.array([[c, s], [-s, c]]))


def _carriageway(lines: tuple[np.ndarray, ...], network: Network) -> shapely.Polygon:
    """Strips and turning circles with rounded kerbs."""
    strips = [shapely.LineString(line).buffer(CARRIAGEWAY_M / 2, quad_segs=4) for line in lines]
    for line, (start, end) in zip(lines, network.dead_end, strict=True):
        heads = [line[0]] * start + [line[-1]] * end
        strips += [shapely.Point(p).buffer(TURNING_RADIUS_M, quad_segs=6) for p in heads]
    joined = shapely.union_all(strips, grid_size=0.001)
    rounded = joined.buffer(_KERB_RADIUS_M, quad_segs=4).buffer(-_KERB_RADIUS_M, quad_segs=4)
    return _largest(rounded.simplify(0.08))


def _filled(carriageway: shapely.Polygon, distance_m: float) -> shapely.Polygon:
    """The carriageway widened; islands too small for a garden are paved over."""
    wide = _largest(carriageway.buffer(distance_m, quad_segs=4).simplify(0.05))
    return shapely.Polygon(wide.exterior, [r for r in wide.interiors if shapely.Polygon(r).area > 500.0])


def _largest(geometry: shapely.Geometry) -> shapely.Polygon:
    return max(shapely.get_parts(geometry), key=lambda g: float(shapely.area(g)))
