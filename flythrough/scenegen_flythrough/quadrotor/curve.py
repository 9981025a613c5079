"""The shape of a path, apart from when it is flown: a spline along drawn points, measured by its own length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.interpolate import CubicHermiteSpline

from scenegen_flythrough.quadrotor.spline import LEAD, UniformSpline

_PER_POINT = 12  # samples between two drawn points


@dataclass(frozen=True, eq=False)
class Curve:
    """A quintic B-spline whose coefficients are the drawn points, with samples along its length.

    The points are approached, not met: corners come out round, and the curve bends less than the polygon does.

    Attributes
    ----------
    spline : UniformSpline
        Over the index of the drawn points.
    u : float64 (samples,)
        Index of the drawn points, fractions between them.
    s : float64 (samples,)
        Way from the beginning [m].
    stretch : float64 (samples,)
        ds/du [m].
    """

    spline: UniformSpline
    u: Float64[np.ndarray, "samples"]
    s: Float64[np.ndarray, "samples"]
    stretch: Float64[np.ndarray, "samples"]

    @staticmethod
    def of(points: Float64[np.ndarray, "points 3"]) -> Curve:
        """Along at least three points; both ends run on straight."""
        first, last = points[0] - points[1], points[-1] - points[-2]
        before = points[0] + np.arange(LEAD, 0, -1)[:, None] * first
        after = points[-1] + np.arange(1, LEAD + 2)[:, None] * last
        spline = UniformSpline(0.0, 1.0, np.concatenate([before, points, after]))
        u = np.linspace(0.0, len(points) - 1.0, (len(points) - 1) * _PER_POINT + 1)
        stretch = np.maximum(np.linalg.norm(spline.at(u, 1), axis=1), 1e-9)
        middle = np.linalg.norm(spline.at(0.5 * (u[1:] + u[:-1]), 1), axis=1)
        steps = (stretch[:-1] + 4.0 * middle + stretch[1:]) * (u[1] - u[0]) / 6.0  # Simpson
        return Curve(spline, u, np.concatenate([[0.0], np.cumsum(steps)]), stretch)

    @property
    def length_m(self) -> float:
        """Of the whole curve."""
        return float(self.s[-1])

    @property
    def place(self) -> Float64[np.ndarray, "samples 3"]:
        """Points of the curve at the samples [m]."""
        return self.spline.at(self.u)

    def index_at(self, s: Float64[np.ndarray, "places"]) -> Float64[np.ndarray, "places"]:
        """Index of the drawn points after a way `s` along the curve."""
        return np.asarray(CubicHermiteSpline(self.s, self.u, 1.0 / self.stretch)(s))

    def tangent(self) -> Float64[np.ndarray, "samples 3"]:
        """Unit vectors along the curve at the samples."""
        return np.asarray(self.spline.at(self.u, 1) / self.stretch[:, None])

    def curvature(self) -> Float64[np.ndarray, "samples 3"]:
        """Second derivative by length: towards the centre of the bend [1/m]."""
        along, second = self.tangent(), self.spline.at(self.u, 2)
        across = second - (second * along).sum(axis=1, keepdims=True) * along
        return np.asarray(across / self.stretch[:, None] ** 2)
