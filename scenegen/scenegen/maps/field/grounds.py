"""The sports grounds as a plan: pitches, track, stands, clubhouse, car park, and the platforms they lie on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.maps.field.frame import Frame, Plot
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.field.track import OUTER_HALF_X_M, OUTER_HALF_Y_M, fits_inside

TREAD_M = 0.85
"""Depth of one row of a stand [m]."""

AISLE_M = 1.6
"""Walkway before the first row of a stand [m]."""

_MARGIN_M, _APART_M = 6.0, 9.0
"""Free ground around the main pitch, and between two platforms."""
_MODULE_M = 16.6
"""Depth of two rows of 5 m bays and the aisle between them."""


@dataclass(frozen=True, eq=False)
class Pitch:
    """A football pitch, centred on its frame, goals on its x axis.

    Attributes
    ----------
    frame : Frame
    length_m, width_m : float
        Between the outer edges of the lines.
    artificial : bool
        Artificial turf instead of grass.
    main : bool
    margin_m : float
        Turf beyond the lines.
    mast_m : float
        Height of its floodlight masts; 0 without.
    """

    frame: Frame
    length_m: float
    width_m: float
    artificial: bool
    main: bool
    margin_m: float
    mast_m: float

    @property
    def turf(self) -> Plot:
        """Pitch and margin."""
        return Plot(self.frame, self.length_m / 2 + self.margin_m, self.width_m / 2 + self.margin_m)


@dataclass(frozen=True, eq=False)
class Stand:
    """A stand: its frame lies in the middle of its front edge, x along the rows, y away from the pitch."""

    frame: Frame
    length_m: float
    rows: int
    roofed: bool

    @property
    def depth_m(self) -> float:
        """From the front edge to the back wall [m]."""
        return AISLE_M + self.rows * TREAD_M

    def outline(self, margin_m: float = 0.0) -> shapely.Polygon:
        """Plan of the stand, grown by a margin [m]."""
        a = self.length_m / 2 + margin_m
        return self.frame.box(-a, -margin_m, a, self.depth_m + margin_m)


@dataclass(frozen=True, eq=False)
class Grounds:
    """Everything inside the fence.

    Attributes
    ----------
    frame : Frame
        Of the main pitch.
    pitches : tuple of Pitch
        The main one first.
    track : bool
        A running track around the main pitch.
    stands : tuple of Stand
        The main one first.
    clubhouse, store : Plot
        The clubhouse, front towards -y of its frame; a flat-roofed store with garages.
    car_park : Plot
        Bays in modules along its y axis.
    forecourt : shapely.Polygon
        Paved, between the main stand, clubhouse and car park.
    access : float64 (2, 2)
        Centre line of the drive from the car park to the road.
    paths : tuple of float64 (points, 2)
        Centre lines of footpaths.
    platforms : tuple of Plot
        What is level.
    outline : shapely.Polygon
        The fence line.
    road_y_m : float
        Distance of the country road from the main pitch's axis, in the frame (negative).
    """

    frame: Frame
    pitches: tuple[Pitch, ...]
    track: bool
    stands: tuple[Stand, ...]
    clubhouse: Plot
    store: Plot
    car_park: Plot
    forecourt: shapely.Polygon
    access: Float64[np.ndarray, "2 2"]
    paths: tuple[Float64[np.ndarray, "_ 2"], ...]
    platforms: tuple[Plot, ...]
    outline: shapely.Polygon
    road_y_m: float

    @property
    def half_m(self) -> tuple[float, float]:
        """Half the size of the main field with its margin or track [m]."""
        if self.track:
            return OUTER_HALF_X_M + 2.0, OUTER_HALF_Y_M + 2.0
        turf = self.pitches[0].turf
        return turf.half_x_m, turf.half_y_m


def lay_out_grounds(knobs: FieldKnobs, rng: np.random.Generator) -> Grounds:
    """Draw the grounds; the middle of what they cover lies at the world's origin.

    They are drawn twice with the same choices: once around the main pitch to learn their size, once moved.
    """
    size, heading = rng.spawn(1)[0], rng.uniform(0.0, 2 * np.pi)
    state = size.bit_generator.state
    trial = _lay_out(Frame(0.0, 0.0, heading), knobs, size)
    size.bit_generator.state = state
    middle = shapely.get_coordinates(trial.outline.envelope.centroid)[0]
    return _lay_out(Frame(-float(middle[0]), -float(middle[1]), heading), knobs, size)


def _lay_out(frame: Frame, knobs: FieldKnobs, rng: np.random.Generator) -> Grounds:
    count = round(rng.uniform(*knobs.pitches))
    artificial, lit = rng.uniform(*knobs.artificial_share), rng.uniform(*knobs.floodlight_share)
    track = bool(rng.uniform() < rng.uniform(*knobs.track_share))
    main = _draw_pitch(frame, True, track, artificial, lit, knobs, rng)
    half_x, half_y = (OUTER_HALF_X_M + 2.0, OUTER_HALF_Y_M + 2.0) if track else (
        main.turf.half_x_m, main.turf.half_y_m,
    )  # fmt: skip
    stands = _draw_stands(frame, half_x, half_y, knobs, rng)
    back = -(half_y + 1.5 + stands[0].depth_m + 0.6)
    top = half_y + 3.0 + (stands[1].depth_m + 2.0 if len(stands) > 1 else 0.0)
    front = back - rng.uniform(8.0, 12.0)
    wide, deep = 2.7 * int(rng.integers(20, 31)), _MODULE_M * int(rng.integers(1, 3))
    length, depth = rng.uniform(22.0, 34.0), rng.uniform(10.0, 13.0)
    total, side = wide + 10.0 + length + 12.0, 1.0 if rng.uniform() < 0.5 else -1.0
    reach = max(half_x, total / 2) + 3.0
    car_park = Plot(frame.at(side * (total - wide) / 2, front - deep / 2), wide / 2, deep / 2)
    club_x = -side * (total / 2 - 12.0 - length / 2)
    clubhouse = Plot(frame.at(club_x, front - 1.0 - depth / 2, np.pi), length / 2, depth / 2)
    store = Plot(frame.at(-side * (total / 2 - 5.0), front - 4.0, np.pi), 4.0, 3.0)
    low = front - max(deep, depth + 2.0) - 3.0
    platforms = [Plot(frame.at(0.0, (top + low) / 2), reach, (top - low) / 2)]
    extra = _draw_extra(frame, count, reach, top, (artificial, lit), knobs, rng)
    platforms += [Plot(p.frame, p.turf.half_x_m + 1.5, p.turf.half_y_m + 1.5) for p in extra]
    outline = shapely.union_all([p.outline(_APART_M / 2 + 0.5) for p in platforms])
    road_y = low - _APART_M / 2 - rng.uniform(9.0, 20.0)
    gate_x = side * (total - wide) / 2 + side * rng.uniform(-0.3, 0.3) * wide
    return Grounds(
        frame=frame,
        pitches=(main, *extra),
        track=track,
        stands=stands,
        clubhouse=clubhouse,
        store=store,
        car_park=car_park,
        forecourt=frame.box(-total / 2, front, total / 2, back),
        access=frame.world(np.array([[gate_x, front - deep], [gate_x, road_y]])),
        paths=_paths(frame, extra, reach, (front + back) / 2, total, side),
        platforms=tuple(platforms),
        outline=outline if outline.geom_type == "Polygon" else outline.convex_hull,
        road_y_m=road_y,
    )


def _draw_pitch(
    frame: Frame,
    main: bool,
    track: bool,
    artificial: float,
    lit: float,
    knobs: FieldKnobs,
    rng: np.random.Generator,
) -> Pitch:
    """Size, turf and floodlights of one pitch; inside a track it shrinks until it fits."""
    length, width = round(rng.uniform(100.0, 110.0), 1), round(rng.uniform(64.0, 75.0), 1)
    while track and not fits_inside(length, width):
        length, width = max(length - 0.5, 100.0), max(width - 0.5, 64.0)
    mast = rng.uniform(*knobs.mast_height_m) * (1.0 if main else 0.7)
    has_light = rng.uniform() < (max(lit, 0.8) if main else lit)
    margin = 1.0 if track else _MARGIN_M if main else 3.5
    turf = bool(rng.uniform() < artificial)
    return Pitch(frame, length, width, turf, main, margin, mast if has_light else 0.0)


def _draw_stands(
    frame: Frame, half_x: float, half_y: float, knobs: FieldKnobs, rng: np.random.Generator
) -> tuple[Stand, ...]:
    rows = round(rng.uniform(*knobs.stand_rows))
    length = rng.uniform(0.5, 1.0) * min(90.0, 2 * half_x - 20.0)
    main = Stand(frame.at(0.0, -(half_y + 1.5), np.pi), length, rows, roofed=True)
    if rng.uniform() < 0.4:
        return (main,)
    other = Stand(frame.at(0.0, half_y + 1.5), length * rng.uniform(0.5, 1.0), max(rows // 2, 3), False)
    return main, replace(other, roofed=bool(rng.uniform() < 0.25))


def _draw_extra(
    frame: Frame,
    count: int,
    reach: float,
    top: float,
    shares: tuple[float, float],
    knobs: FieldKnobs,
    rng: np.random.Generator,
) -> tuple[Pitch, ...]:
    """Training pitches: one beyond the far side, one beyond an end, turned by a right angle."""
    found = []
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    for k in range(count - 1):
        pitch = _draw_pitch(frame, False, False, *shares, knobs, rng)
        across = pitch.turf.half_y_m + 1.5
        if k == 0:
            place = frame.at(rng.uniform(-20.0, 20.0), top + _APART_M + across)
        else:
            place = frame.at(side * (reach + _APART_M + across), rng.uniform(-25.0, 5.0), np.pi / 2)
        found.append(replace(pitch, frame=place))
    return tuple(found)


def _paths(
    frame: Frame, extra: tuple[Pitch, ...], reach: float, y: float, total: float, side: float
) -> tuple[np.ndarray, ...]:
    """From the forecourt along the main field's end to each training pitch."""
    lines = []
    for pitch in extra:
        goal = frame.local(np.array([[pitch.frame.x_m, pitch.frame.y_m]]))[0]
        beside = np.sign(goal[0] + 1e-6) if abs(goal[0]) > reach else -side
        x = beside * (reach - 2.0)
        stop = goal[1] - pitch.turf.half_y_m if abs(goal[0]) < reach else max(goal[1], y + 5.0)
        corner = [[x, y], [x, stop - 2.0]] if abs(goal[0]) < reach else [[x, y], [x, stop]]
        bend = [[0.5 * x, stop - 2.0]] if abs(goal[0]) < reach else [[x + beside * 12.0, stop]]
        lines.append(frame.world(np.array([[beside * (total / 2 - 2.0), y], *corner, *bend])))
    return tuple(lines)
