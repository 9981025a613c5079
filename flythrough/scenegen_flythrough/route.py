"""What a style hands over: a path as it should be flown, before anybody has timed or proven it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True, eq=False)
class Route:
    """A drawn path.

    Attributes
    ----------
    points : float64 (points, 3)
        Coefficients of the path, about evenly spaced [m]; at least three. Corners are rounded within a few of them.
    speed_mps : float
        Cruise speed wanted; bends are taken more slowly.
    pitch_deg : float
        Camera against airframe; negative looks down.
    cap_mps : float64 (points,) or None
        Speed wanted at most near each point.
    nose_rad : float64 (points,) or None
        Heading of the nose near each point, without jumps; None: it follows the course.
    at_end : bool
        The clip is the end of the path and not its beginning.
    """

    points: Float64[np.ndarray, "points 3"]
    speed_mps: float
    pitch_deg: float
    cap_mps: Float64[np.ndarray, "points"] | None = None
    nose_rad: Float64[np.ndarray, "points"] | None = None
    at_end: bool = False
