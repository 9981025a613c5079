"""Routes: one round of poses at even steps of time, repeated for ever; any number of them looked up together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

X, Y, Z, HEADING, PITCH, ROLL, TRAVELLED = range(7)
"""Columns of a route: place [m], angles [rad], way travelled [m]."""
_BEFORE, _AFTER = 1, 2
"""Rows of the round repeated at its ends, so that no interpolation has to wrap around."""


@dataclass(frozen=True, eq=False)
class Route:
    """Where a mover is at any time.

    Attributes
    ----------
    rows : float64 (rows, 7)
        See `X` to `TRAVELLED`. Row 1 is the start of the round, the last two repeat its beginning, a round further:
        heading and way travelled go on growing.
    step_s : float
        Time from row to row [s].
    start_s : float
        How far into the round the mover is at time 0 [s].
    """

    rows: Float64[np.ndarray, "rows 7"]
    step_s: float
    start_s: float = 0.0

    @staticmethod
    def of(
        samples: Float64[np.ndarray, "samples 7"], round_m: float, turn_rad: float, step_s: float
    ) -> Route:
        """Close a round.

        Parameters
        ----------
        samples : float64 (samples, 7)
            At 0, step_s, 2 step_s ...; the round ends one step after the last.
        round_m : float
            Way travelled in a round [m].
        turn_rad : float
            Heading gained in a round: a multiple of two pi.
        step_s : float
        """
        on = np.zeros(7)
        on[[HEADING, TRAVELLED]] = turn_rad, round_m
        ends = samples[-_BEFORE:] - on, samples, samples[np.arange(_AFTER) % len(samples)] + on
        return Route(np.concatenate(ends), step_s)

    @property
    def round_s(self) -> float:
        """Duration of a round [s]."""
        return (len(self.rows) - _BEFORE - _AFTER) * self.step_s

    def starting(self, share: float) -> Route:
        """The same route, begun at a share of the round."""
        return replace(self, start_s=share * self.round_s)

    def pose(self, time_s: float) -> Float64[np.ndarray, "4 4"]:
        """`world_from_mover` at one time."""
        return np.asarray(matrices(Timetable.of([self]).at(time_s))[0])


@dataclass(frozen=True, eq=False)
class Timetable:
    """Many routes in one table, for lookups without a loop.

    Attributes
    ----------
    rows : float64 (rows, 7)
        Those of all routes, one after the other.
    first, count : int64 (routes,)
        First row of each route, and steps of its round.
    step_s, start_s, round_m : float64 (routes,)
    """

    rows: Float64[np.ndarray, "rows 7"]
    first: Int64[np.ndarray, "routes"]
    count: Int64[np.ndarray, "routes"]
    step_s: Float64[np.ndarray, "routes"]
    start_s: Float64[np.ndarray, "routes"]
    round_m: Float64[np.ndarray, "routes"]

    @staticmethod
    def of(routes: Sequence[Route]) -> Timetable:
        """Put routes together."""
        lengths = [len(r.rows) for r in routes]
        return Timetable(
            rows=np.concatenate([np.zeros((0, 7)), *(r.rows for r in routes)]),
            first=np.cumsum([0, *lengths])[:-1].astype(np.int64),
            count=np.array([n - _BEFORE - _AFTER for n in lengths], np.int64),
            step_s=np.array([r.step_s for r in routes], np.float64),
            start_s=np.array([r.start_s for r in routes], np.float64),
            round_m=np.array(
                [r.rows[-_AFTER, TRAVELLED] - r.rows[_BEFORE, TRAVELLED] for r in routes], np.float64
            ),
        )

    def at(self, time_s: float) -> Float64[np.ndarray, "routes 7"]:
        """State of every route at one time."""
        return np.asarray(self.over(np.array([time_s]))[0])

    def over(self, times_s: Float64[np.ndarray, "times"]) -> Float64[np.ndarray, "times routes 7"]:
        """States at several times, cubic between rows (Catmull and Rom 1974): smooth in the velocity."""
        steps = (times_s[:, None] + self.start_s) / self.step_s
        rounds = np.floor(steps / self.count)
        inside = steps - rounds * self.count
        k = np.minimum(inside.astype(np.int64), self.count - 1)
        f = (inside - k)[..., None]
        a, b, c, d = (self.rows[self.first + k + n] for n in range(4))
        bend = f * (2.0 * a - 5.0 * b + 4.0 * c - d + f * (3.0 * (b - c) + d - a))
        state = b + 0.5 * f * (c - a + bend)
        state[..., TRAVELLED] += rounds * self.round_m
        return np.asarray(state)


def matrices(state: Float64[np.ndarray, "*many 7"]) -> Float64[np.ndarray, "*many 4 4"]:
    """`world_from_mover` of states: roll about the mover's own x (left side up), pitch (nose up), then heading."""
    angles = np.moveaxis(state[..., HEADING : ROLL + 1], -1, 0)
    (ch, cp, cr), (sh, sp, sr) = np.cos(angles), np.sin(angles)
    pose = np.zeros((*state.shape[:-1], 4, 4))
    pose[..., 0, :3] = np.stack([ch * cp, -sh * cr - ch * sp * sr, sh * sr - ch * sp * cr], axis=-1)
    pose[..., 1, :3] = np.stack([sh * cp, ch * cr - sh * sp * sr, -ch * sr - sh * sp * cr], axis=-1)
    pose[..., 2, :3] = np.stack([sp, cp * sr, cp * cr], axis=-1)
    pose[..., :3, 3] = state[..., : Z + 1]
    pose[..., 3, 3] = 1.0
    return pose
