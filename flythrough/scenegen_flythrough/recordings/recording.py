"""A recorded flight as data, whatever file it came from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.foundation.errors import InputError

_FEWEST = 8
_LONGEST_GAP_S = 2.0
_FARTHEST_M = 1e5


@dataclass(frozen=True, eq=False)
class Recording:
    """Positions over time, and orientations if the file has them.

    Attributes
    ----------
    time_s : float64 (rows,)
        Rising.
    place : float64 (rows, 3)
        East, north, up [m].
    quaternion : float64 (rows, 4) or None
        x, y, z, w; turns body (nose, left, up) or camera axes into the world's.
    """

    time_s: Float64[np.ndarray, "rows"]
    place: Float64[np.ndarray, "rows 3"]
    quaternion: Float64[np.ndarray, "rows 4"] | None = None


def checked(
    name: str,
    time_s: Float64[np.ndarray, "rows"],
    place: Float64[np.ndarray, "rows 3"],
    quaternion: Float64[np.ndarray, "rows 4"] | None,
) -> Recording:
    """A recording, if it can be one.

    Raises
    ------
    InputError
        In one line: too few rows, something not finite, time that does not rise, a gap, a quaternion of no length,
        a place beyond all worlds, nothing that moves.
    """
    if len(time_s) < _FEWEST:
        raise InputError(f"{name}: {len(time_s)} poses are too few for a flight; it takes {_FEWEST}")
    rows = np.column_stack([time_s, place] if quaternion is None else [time_s, place, quaternion])
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise InputError(f"{name}: pose {bad[0] + 1} holds something that is no finite number; remove it")
    steps = np.diff(time_s)
    if (steps <= 0.0).any():
        raise InputError(
            f"{name}: time does not rise after pose {int(np.argmax(steps <= 0.0)) + 1}; sort them"
        )
    if steps.max() > _LONGEST_GAP_S:
        raise InputError(
            f"{name}: nothing for {steps.max():.3g} s after pose {int(np.argmax(steps)) + 1}; times are in seconds "
            f"and gaps at most {_LONGEST_GAP_S:g} s"
        )
    if np.abs(place).max() > _FARTHEST_M:
        raise InputError(
            f"{name}: places lie {np.abs(place).max():.3g} m from the origin; use metres in the world"
        )
    if np.linalg.norm(np.diff(place, axis=0), axis=1).sum() < 0.5:
        raise InputError(f"{name}: nothing moves in this recording")
    if quaternion is not None:
        length = np.linalg.norm(quaternion, axis=1)
        if (np.abs(length - 1.0) > 0.05).any():
            row = int(np.argmax(np.abs(length - 1.0))) + 1
            raise InputError(f"{name}: the quaternion of pose {row} has length {length[row - 1]:.3g}, not 1")
        quaternion = quaternion / length[:, None]
    return Recording(time_s - time_s[0], place, quaternion)
