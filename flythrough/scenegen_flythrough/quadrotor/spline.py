"""Uniform quintic B-splines: smooth in four derivatives, with bounds that are theorems and not samples.

Every derivative of a B-spline is a B-spline whose coefficients are differences of the given ones, and a B-spline never
leaves the convex hull of its coefficients (de Boor, A Practical Guide to Splines, 1978, chapters IX to XI). So the
largest difference bounds speed, acceleration and jerk at *every* instant.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, factorial

import numpy as np
from jaxtyping import Float64

DEGREE = 5
LEAD = 2
"""Coefficients before the one that sits on the first knot."""


def _basis() -> Float64[np.ndarray, "6 6"]:
    """Row k: weights of the six coefficients in the term u^k of a segment (Qin 2000, doi 10.1007/s003710050206)."""
    k = DEGREE
    matrix = np.zeros((k + 1, k + 1))
    for power in range(k + 1):
        for j in range(k + 1):
            terms = ((-1) ** (s - j) * comb(k + 1, s - j) * (k - s) ** (k - power) for s in range(j, k + 1))
            matrix[power, j] = comb(k, power) * sum(terms) / factorial(k)
    return matrix


_BASIS = _basis()


@dataclass(frozen=True, eq=False)
class UniformSpline:
    """A curve over `start` <= t <= `end`.

    Attributes
    ----------
    start : float
        First knot: where the valid range begins.
    step : float
        Between knots.
    control : float64 (coefficients, dims)
        Coefficient `k` belongs to the knot ``start + (k - LEAD) * step``; at least six.
    """

    start: float
    step: float
    control: Float64[np.ndarray, "coefficients dims"]

    @property
    def end(self) -> float:
        """Where the valid range ends."""
        return self.start + (len(self.control) - DEGREE) * self.step

    def at(self, t: Float64[np.ndarray, "times"], order: int = 0) -> Float64[np.ndarray, "times dims"]:
        """Value, or derivative of an order up to five, at parameters inside the valid range."""
        place = (t - self.start) / self.step
        segment = np.clip(np.floor(place).astype(np.int64), 0, len(self.control) - DEGREE - 1)
        u = place - segment
        powers = np.zeros((len(t), DEGREE + 1))
        for k in range(order, DEGREE + 1):
            powers[:, k] = factorial(k) / factorial(k - order) * u ** (k - order)
        weights = powers @ _BASIS
        value = np.zeros((len(t), self.control.shape[1]))
        for j in range(DEGREE + 1):
            value += weights[:, j, None] * self.control[segment + j]
        return value / self.step**order

    def differences(self, order: int) -> Float64[np.ndarray, "coefficients_of_derivative dims"]:
        """Coefficients of a derivative; entry `k` belongs to the parameter ``start + (k - LEAD + order/2) * step``."""
        return np.asarray(np.diff(self.control, order, axis=0) / self.step**order)

    def bound(self, order: int) -> float:
        """What the norm of a derivative never exceeds."""
        return float(np.linalg.norm(self.differences(order), axis=1).max())
