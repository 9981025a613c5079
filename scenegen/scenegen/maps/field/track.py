"""A standard 400 m running track: two straights, two half circles, eight lanes between white lines."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.maps.field.frame import Frame
from scenegen.maps.field.workshop import FieldWorkshop

STRAIGHT_M, RADIUS_M, LANE_M, LANES = 84.39, 36.5, 1.22, 8
"""World Athletics, Track and Field Facilities Manual, section 2.2: the 400 m standard track."""

OUTER_HALF_X_M = STRAIGHT_M / 2 + RADIUS_M + LANES * LANE_M
OUTER_HALF_Y_M = RADIUS_M + LANES * LANE_M

_CHORDS, _PIECES = 36, 14
_LINE_M = 0.05
_SAFETY_M = 1.0


def fits_inside(length_m: float, width_m: float) -> bool:
    """Whether a pitch and a safety margin fit into the infield."""
    beyond = max(length_m / 2 - STRAIGHT_M / 2, 0.0)
    return bool(np.hypot(beyond + _SAFETY_M, width_m / 2 + _SAFETY_M) <= RADIUS_M)


def oval(radius_m: float) -> np.ndarray:
    """Ring around the track at a distance from the axis of its straights, counter-clockwise, open (points, 2)."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, _CHORDS + 1)
    east = np.column_stack([np.cos(angle), np.sin(angle)]) * radius_m + np.array([STRAIGHT_M / 2, 0.0])
    x = np.linspace(0.5, -0.5, _PIECES + 1)[1:-1] * STRAIGHT_M
    half = np.concatenate([east, np.column_stack([x, np.full(len(x), radius_m)])])
    return np.concatenate([half, -half])


def track_regions(frame: Frame, shop: FieldWorkshop, rng: np.random.Generator) -> list[Region]:
    """Rubber ring, the lines between lanes and the finish, on top of everything else."""
    rubber = shop.palette.special(
        "artificial_turf", "running track", solar_absorptance=rng.uniform(0.66, 0.8)
    )
    paint = shop.palette.special("artificial_turf", "line", solar_absorptance=0.45)
    owner, lines = shop.builder.new_objects(), shop.builder.new_objects()
    sport = int(Semantic.SPORTS_SURFACE)
    inner, outer = oval(RADIUS_M), oval(RADIUS_M + LANES * LANE_M)
    ring = shapely.Polygon(frame.world(outer), [frame.world(inner)])
    regions = [Region(ring, rubber, sport, owner)]
    for lane in (0, 4, LANES):
        a, b = oval(RADIUS_M + lane * LANE_M), oval(RADIUS_M + lane * LANE_M + _LINE_M)
        quads = np.stack([a, b, np.roll(b, -1, axis=0), np.roll(a, -1, axis=0)], axis=1)
        regions += [Region(q, paint, sport, lines, lumped=True) for q in shapely.polygons(frame.world(quads))]
    finish = frame.box(STRAIGHT_M / 2 - 0.025, -OUTER_HALF_Y_M, STRAIGHT_M / 2 + 0.025, -RADIUS_M)
    return [*regions, Region(finish, paint, sport, lines, lumped=True)]
