"""How finely a scene is cut where: finely around what stands there, coarsely in the open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int64
from scipy.ndimage import distance_transform_edt

_CELL_M = 16.0
_MOST_CELLS_A_SIDE = 320
_GROUND_M2 = 10_000.0
"""Smooth surfaces beyond this area are grounds and waters: what has vertices on others is detail."""


@dataclass(frozen=True, eq=False)
class Detail:
    """Plan of the distance to the nearest thing that is more than open ground, by cells.

    Attributes
    ----------
    origin_m : float64 (2,)
    cell_m : float
    distance_m : float32 (rows, columns)
    """

    origin_m: Float64[np.ndarray, "2"]
    cell_m: float
    distance_m: Float32[np.ndarray, "rows columns"]

    @staticmethod
    def of(
        vertices: Float64[np.ndarray, "vertices 3"],
        faces: Int64[np.ndarray, "faces 3"],
        area: Float64[np.ndarray, "faces"],
        facet: Int64[np.ndarray, "faces"],
    ) -> Detail:
        """Find what stands in a scene: everything that is no part of a very large smooth surface.

        Parameters
        ----------
        vertices, faces : arrays
            [m].
        area : float64 (faces,)
            [m^2].
        facet : int64 (faces,)
            Smooth surface of each face.
        """
        low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
        cell = max(_CELL_M, float((high - low).max()) / _MOST_CELLS_A_SIDE)
        columns, rows = (np.floor((high - low) / cell).astype(int) + 1).tolist()
        thing = np.bincount(facet, area)[facet] < _GROUND_M2
        place = vertices[np.unique(faces[thing])] if thing.any() else vertices
        column, row = np.floor((place[:, :2] - low) / cell).astype(np.int64).T
        empty = np.ones((rows, columns), bool)
        empty[row, column] = False
        distance = distance_transform_edt(empty) * cell
        return Detail(low, cell, distance.astype(np.float32))

    def longest_m(
        self, places: Float64[np.ndarray, "places 3"], spacing_m: float, doubled_after_m: float
    ) -> Float64[np.ndarray, "places"]:
        """Longest edge allowed at places [m]: `spacing_m` where there is detail, longer with the distance from it."""
        rows, columns = self.distance_m.shape
        column, row = np.floor((places[:, :2] - self.origin_m) / self.cell_m).astype(np.int64).T
        distance = self.distance_m[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]
        return np.asarray(spacing_m * (1.0 + distance / doubled_after_m), np.float64)
