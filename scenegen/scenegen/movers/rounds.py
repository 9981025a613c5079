"""From a line in the plan to a route: rounded corners, a speed that suits them, the ground under the wheels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64
from scipy.ndimage import gaussian_filter1d

from scenegen.geometry.relief import Relief, slopes
from scenegen.movers.route import Route

_SPACING_M = 0.4
_STEP_S = 0.2


@dataclass(frozen=True)
class Pace:
    """How something moves along its line.

    Attributes
    ----------
    cruise_mps : float
        Speed where the line is straight.
    corner_mps2 : float
        Largest sideways acceleration in bends.
    pick_up_mps2 : float
        Acceleration and braking.
    rounding_m : float
        Length over which corners are rounded.
    leans : bool
        Pitches and rolls with the ground, as wheels make a vehicle do; people stay upright.
    """

    cruise_mps: float
    corner_mps2: float
    pick_up_mps2: float
    rounding_m: float
    leans: bool


def ring_route(
    ring: Float64[np.ndarray, "points 2"], ground: Relief, pace: Pace, lift_m: float = 0.0
) -> Route:
    """Round after round along a closed line, in the order of its points.

    Parameters
    ----------
    ring : float64 (points, 2)
        Plan [m]; the last point joins the first (which may be repeated).
    ground : callable
        Height [m] at plan points.
    pace : Pace
    lift_m : float
        Height of the way above `ground` [m]: a kerb, a bridge.
    """
    xy = _rounded(_even(ring), pace.rounding_m)
    along, heading, bend = _course(xy)
    speed = _speeds(along, bend, pace)
    ahead = np.roll(speed, -1)
    mark_s = np.concatenate([[0.0], np.cumsum(2.0 * along / (speed + ahead))])
    mark_m = np.concatenate([[0.0], np.cumsum(along)])
    steps = max(int(np.ceil(mark_s[-1] / _STEP_S)), 8)
    time = mark_s[-1] * np.arange(steps) / steps
    turn = 2.0 * np.pi * np.round((heading[-1] - heading[0] + _last_turn(heading)) / (2.0 * np.pi))
    closed = np.column_stack(
        [np.concatenate([xy, xy[:1]]), np.concatenate([heading, [heading[0] + turn]]), mark_m]
    )
    x, y, course, travelled = (np.interp(time, mark_s, column) for column in closed.T)
    place = np.column_stack([x, y])
    forward = np.column_stack([np.cos(course), np.sin(course)])
    grade = slopes(ground, place) if pace.leans else np.zeros_like(place)
    pitch = np.arctan((grade * forward).sum(axis=1))
    roll = np.arctan(grade[:, 1] * forward[:, 0] - grade[:, 0] * forward[:, 1])
    samples = np.column_stack([place, ground(place) + lift_m, course, pitch, roll, travelled])
    return Route.of(samples, float(mark_m[-1]), float(turn), float(mark_s[-1] / steps))


def there_and_back(line: Float64[np.ndarray, "points 2"], right_m: float) -> Float64[np.ndarray, "ring 2"]:
    """Ring to the right of a line, around its end, back on the other side and around its start."""
    around = shapely.LineString(line).buffer(right_m, quad_segs=6)
    return np.asarray(shapely.get_coordinates(shapely.geometry.polygon.orient(around).exterior))


def standing(
    place: Float64[np.ndarray, "3"], heading_rad: float, round_s: float = 60.0, steps: int = 240
) -> Route:
    """A route that stays where it is, for what only sways."""
    samples = np.zeros((steps, 7))
    samples[:, :3], samples[:, 3] = place, heading_rad
    return Route.of(samples, 0.0, 0.0, round_s / steps)


def _even(ring: np.ndarray) -> np.ndarray:
    """Points at even distances along a closed line."""
    closed = np.concatenate([ring, ring[:1]])
    mark = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    count = max(int(np.ceil(mark[-1] / _SPACING_M)), 16)
    place = np.arange(count) * (mark[-1] / count)
    return np.column_stack([np.interp(place, mark, closed[:, k]) for k in range(2)])


def _rounded(xy: np.ndarray, length_m: float) -> np.ndarray:
    return np.asarray(gaussian_filter1d(xy, length_m / _SPACING_M, axis=0, mode="wrap"))


def _course(xy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance to the next point, heading (unwrapped) and curvature of each."""
    step = np.roll(xy, -1, axis=0) - xy
    along = np.linalg.norm(step, axis=1)
    tangent = step + np.roll(step, 1, axis=0)
    heading = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    course = np.arctan2(step[:, 1], step[:, 0])
    bend = np.abs(np.angle(np.exp(1j * (course - np.roll(course, 1))))) / np.maximum(along, 1e-6)
    return along, heading, bend


def _last_turn(heading: np.ndarray) -> float:
    """Heading gained from the last point to the first of the next round."""
    return float(np.angle(np.exp(1j * (heading[0] - heading[-1]))))


def _speeds(along: np.ndarray, bend: np.ndarray, pace: Pace) -> np.ndarray:
    """Speed at each point: slow enough for its bend, and for every bend that lies within braking or picking up."""
    limit = np.minimum(pace.cruise_mps, np.sqrt(pace.corner_mps2 / np.maximum(bend, 1e-9))) ** 2
    gain = 2.0 * pace.pick_up_mps2 * np.concatenate([[0.0], np.cumsum(np.tile(along, 2))[:-1]])
    twice = np.tile(limit, 2)
    after = np.minimum.accumulate(twice - gain) + gain
    before = (np.minimum.accumulate((twice + gain)[::-1]))[::-1] - gain
    square = np.minimum(after[len(along) :], before[: len(along)])
    return np.sqrt(np.maximum(square, 0.25 * min(pace.cruise_mps, 1.0) ** 2))
