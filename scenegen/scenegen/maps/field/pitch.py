"""Turf of a pitch: stripes, worn spots and the lines of the Laws of the Game, as regions of the ground plan."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.maps.field.grounds import Pitch
from scenegen.maps.field.workshop import FieldWorkshop

LINE_M = 0.12
"""Width of lines (Law 1: at most 12 cm); goal posts are as thick."""

GOAL_WIDTH_M, GOAL_HEIGHT_M = 7.32, 2.44
"""Between the posts and below the bar (Law 1)."""

_PENALTY_M, _GOAL_AREA_M, _CIRCLE_M, _SPOT_M = 16.5, 5.5, 9.15, 11.0
_PIECE_M = 6.0


def pitch_regions(pitch: Pitch, shop: FieldWorkshop, rng: np.random.Generator) -> list[Region]:
    """Turf with margin, then stripes, worn spots and lines on top."""
    turf, stripe, paint = _surfaces(pitch, shop)
    owner, lines = shop.builder.new_objects(), shop.builder.new_objects()
    semantic = int(Semantic.SPORTS_SURFACE if pitch.artificial else Semantic.GRASS)
    regions = [Region(pitch.turf.outline(), turf, semantic, owner)]
    regions += [Region(s, stripe, semantic, owner) for s in _stripes(pitch, rng)]
    if not pitch.artificial:
        soil, worn = shop.palette.pick("soil_dry", rng), shop.palette.pick("grass_dry", rng)
        bare = shop.builder.new_objects()
        for spot, size in _worn_spots(pitch, rng):
            regions.append(Region(spot, worn, semantic, owner))
            if size > 0.55:
                core = shapely.affinity.scale(spot, 0.55, 0.55)
                regions.append(Region(core, soil, int(Semantic.SOIL), bare))
    mark = int(Semantic.SPORTS_SURFACE)
    quads = shapely.polygons(pitch.frame.world(line_quads(pitch.length_m, pitch.width_m)))
    return regions + [Region(q, paint, mark, lines, lumped=True) for q in quads]


def _surfaces(pitch: Pitch, shop: FieldWorkshop) -> tuple[int, int, int]:
    """Palette indices of the turf, of every second stripe, and of the lines.

    Mown stripes differ because the mower lays the blades towards or away from the sun; sewn-in lines of
    artificial turf are white fibre.
    """
    palette = shop.palette
    if pitch.artificial:
        plain = palette.only("artificial_turf")
        second = palette.special("artificial_turf", "second pile", solar_absorptance=0.86)
        return plain, second, palette.special("artificial_turf", "line", solar_absorptance=0.45)
    return (
        palette.special("grass_watered", "mown away", solar_absorptance=0.73),
        palette.special("grass_watered", "mown towards", solar_absorptance=0.80),
        palette.special("grass_watered", "line", solar_absorptance=0.50),
    )


def _stripes(pitch: Pitch, rng: np.random.Generator) -> list[shapely.Polygon]:
    """Every second of an even number of stripes across the pitch; artificial turf has broad panels or none."""
    half, wide = pitch.length_m / 2, pitch.width_m / 2
    if pitch.artificial and rng.uniform() < 0.5:
        return []
    count = 10 if pitch.artificial else int(rng.choice([14, 18, 20]))
    x = np.linspace(-half, half, count + 1)
    return [pitch.frame.box(x[k], -wide, x[k + 1], wide) for k in range(0, count, 2)]


def _worn_spots(pitch: Pitch, rng: np.random.Generator) -> list[tuple[shapely.Polygon, float]]:
    """Where grass wears off: goal mouths, the middle, along one assistant's line; with how worn they are."""
    spots, wear = [], rng.uniform(0.2, 0.9)
    for x, size in ((-1.0, 1.0), (1.0, 1.0), (0.0, 0.6)):
        centre = np.array([x * (pitch.length_m / 2 - 2.6), 0.0])
        if rng.uniform() < 0.25 + 0.6 * wear:
            ring = centre + np.array([1.9, 3.6]) * size * _lumpy_ring(rng)
            spots.append((shapely.Polygon(pitch.frame.world(ring)), wear * size))
    for _ in range(int(rng.integers(1, 5))):
        reach = np.array([0.42 * pitch.length_m, 0.4 * pitch.width_m])
        ring = rng.uniform(-reach, reach) + rng.uniform(1.0, 4.5, 2) * _lumpy_ring(rng)
        spots.append((shapely.Polygon(pitch.frame.world(ring)), 0.3))
    return spots


def _lumpy_ring(rng: np.random.Generator) -> np.ndarray:
    angle = np.linspace(0.0, 2 * np.pi, 18, endpoint=False)
    shape = (
        1.0 + 0.16 * np.cos(2 * angle + rng.uniform(0, 6.0)) + 0.1 * np.cos(3 * angle + rng.uniform(0, 6.0))
    )
    return np.asarray(shape[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


def line_quads(length_m: float, width_m: float) -> np.ndarray:
    """All lines of a pitch in short pieces, centred, goals on the x axis (quads, 4, 2) [m].

    The outer edges of touch lines and goal lines lie on the length and width; areas are measured from the
    inside of the posts and include their lines (Law 1).
    """
    a, b, w = length_m / 2, width_m / 2, LINE_M
    boxes = [(-a, -b, a, -b + w), (-a, b - w, a, b), (-w / 2, -b + w, w / 2, b - w)]
    for side in (-1.0, 1.0):
        boxes.append((min(side * a, side * (a - w)), -b + w, max(side * a, side * (a - w)), b - w))
        for depth in (_PENALTY_M, _GOAL_AREA_M):
            y = GOAL_WIDTH_M / 2 + depth
            near, far = side * (a - w), side * (a - depth)
            inner = far + side * w
            boxes.append((min(far, inner), -y, max(far, inner), y))
            for edge in (-y, y - w):
                boxes.append((min(near, inner), edge, max(near, inner), edge + w))
    pieces = [_cut(*box) for box in boxes]
    pieces.append(_arc(0.0, 0.0, np.pi, _CIRCLE_M))
    reach = np.arccos((_PENALTY_M - _SPOT_M) / _CIRCLE_M)
    for side, turn in ((-1.0, 0.0), (1.0, np.pi)):
        pieces.append(_arc(side * (a - _SPOT_M), turn, reach, _CIRCLE_M))
        spot = 0.11 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        pieces.append((spot + np.array([side * (a - _SPOT_M), 0.0]))[None])
    return np.concatenate(pieces)


def _cut(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    """A straight line in pieces."""
    along_x = x1 - x0 > y1 - y0
    count = max(round(max(x1 - x0, y1 - y0) / _PIECE_M), 1)
    t = np.linspace(x0 if along_x else y0, x1 if along_x else y1, count + 1)
    low, high = t[:-1], t[1:]
    fixed = [np.full(count, v) for v in ((y0, y1) if along_x else (x0, x1))]
    if along_x:
        corners = [(low, fixed[0]), (high, fixed[0]), (high, fixed[1]), (low, fixed[1])]
    else:
        corners = [(fixed[0], low), (fixed[1], low), (fixed[1], high), (fixed[0], high)]
    return np.stack([np.column_stack(c) for c in corners], axis=1)


def _arc(x: float, middle_rad: float, half_rad: float, radius_m: float) -> np.ndarray:
    """An arc around (x, 0) in pieces; the line lies inside the radius."""
    count = max(round(2 * half_rad * radius_m / 1.2), 4)
    angle = middle_rad + np.linspace(-half_rad, half_rad, count + 1)
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    inner, outer = unit * (radius_m - LINE_M), unit * radius_m
    quads = np.stack([inner[:-1], outer[:-1], outer[1:], inner[1:]], axis=1)
    return np.asarray(quads + np.array([x, 0.0]))
