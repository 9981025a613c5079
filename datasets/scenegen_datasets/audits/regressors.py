"""Small regressors for the depth-leak audit: fitted on some worlds, asked about others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

Features = Float64[np.ndarray, "samples features"]
Values = Float64[np.ndarray, "samples"]
Edges = Float64[np.ndarray, "_"]

Regressor = Callable[[Features], Values]
"""Answers for features it has not been fitted on."""

_FEWEST = 8.0


@dataclass(frozen=True, eq=False)
class Curve:
    """Mean of the answer as a function of one feature: any curve, linear between the means of its bins.

    Attributes
    ----------
    column : int
        Of the feature.
    x, y : float64 (bins,)
        Means of feature and answer in bins of equal population.
    """

    column: int
    x: Float64[np.ndarray, "bins"]
    y: Float64[np.ndarray, "bins"]

    @classmethod
    def fit(cls, features: Features, answers: Values, column: int, bins: int = 128) -> Curve:
        """Average both over bins of equal population."""
        order = np.argsort(features[:, column], kind="stable")
        parts = np.array_split(order, min(bins, len(order)))
        x = np.array([features[part, column].mean() for part in parts])
        y = np.array([answers[part].mean() for part in parts])
        places, inverse = np.unique(x, return_inverse=True)
        return cls(column, places, np.bincount(inverse, y) / np.bincount(inverse))

    def __call__(self, features: Features) -> Values:
        """Predict."""
        return np.asarray(np.interp(features[:, self.column], self.x, self.y))


@dataclass(frozen=True, eq=False)
class Plane:
    """Least squares, linear in some features.

    Attributes
    ----------
    columns : tuple of int
    centre, weight : float64 (columns,)
    level : float
    """

    columns: tuple[int, ...]
    centre: Float64[np.ndarray, "columns"]
    weight: Float64[np.ndarray, "columns"]
    level: float

    @classmethod
    def fit(cls, features: Features, answers: Values, columns: tuple[int, ...]) -> Plane:
        """Solve the normal equations by SVD; a feature that does not vary gets no weight."""
        chosen = features[:, columns]
        centre, level = chosen.mean(axis=0), float(answers.mean())
        scale = np.maximum(chosen.std(axis=0), 1e-12)
        weight = np.linalg.lstsq((chosen - centre) / scale, answers - level, rcond=1e-9)[0]
        return cls(columns, centre, weight / scale, level)

    def __call__(self, features: Features) -> Values:
        """Predict."""
        return np.asarray((features[:, self.columns] - self.centre) @ self.weight + self.level)


@dataclass(frozen=True, eq=False)
class Sum:
    """One curve on what another has left over, cell by cell: any function of two features.

    Attributes
    ----------
    base : Curve
        Of the first feature; also what cells with few samples fall back to.
    edges : tuple of float64 arrays
        Inner edges of the bins of both features.
    columns : (int, int)
    more : float64 (bins, bins)
        What a cell adds.
    """

    base: Curve
    edges: tuple[Edges, Edges]
    columns: tuple[int, int]
    more: Float64[np.ndarray, "first second"]

    @classmethod
    def fit(cls, features: Features, answers: Values, columns: tuple[int, int], bins: int = 24) -> Sum:
        """Fit the curve, then average its residuals over cells, drawn towards zero where samples are few."""
        base = Curve.fit(features, answers, columns[0])
        first, second = (quantile_edges(features[:, column], bins) for column in columns)
        cell = _cell(features, columns, (first, second), bins)
        left = answers - base(features)
        total = np.bincount(cell, left, bins * bins)
        count = np.bincount(cell, minlength=bins * bins)
        return cls(base, (first, second), columns, (total / (count + _FEWEST)).reshape(bins, bins))

    def __call__(self, features: Features) -> Values:
        """Predict."""
        cell = _cell(features, self.columns, self.edges, len(self.more))
        return np.asarray(self.base(features) + self.more.ravel()[cell])


def quantile_edges(values: Values, bins: int) -> Edges:
    """Inner edges of bins of equal population."""
    return np.asarray(np.quantile(values, np.arange(1, bins) / bins))


def _cell(
    features: Features, columns: tuple[int, int], edges: tuple[Edges, Edges], bins: int
) -> Int64[np.ndarray, "samples"]:
    first, second = (
        np.searchsorted(edge, features[:, column], side="right")
        for edge, column in zip(edges, columns, strict=True)
    )
    return np.asarray(first * bins + second, np.int64)
