"""Where one may fly in a world: a coarse map of what stands at which height, and the exact mesh to prove paths with.

The coarse map only proposes. It may miss a twig and may call a free gap occupied: no path is accepted on its word.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64, UInt8, UInt64

from scenegen.world import World
from scenegen_flythrough.boxtree import parts
from scenegen_flythrough.clearance import MeshProximity
from scenegen_flythrough.surface_samples import inner_points
from scenegen_flythrough.traffic import reaches_of

_LAYER_M = 2.0  # 64 layers of 2 m: heights of 0 to 128 m above ground in one 64-bit word
_GROUND_M = 0.5  # what reaches no higher above the ground is ground
_MAX_CELLS = 1_500_000
_SAMPLE_CELLS = 2.0  # step of the samples: walls may show gaps of a cell, too narrow to be taken for a way
ROOM_CELLS = 10
"""Distances to the nearest obstacle are counted up to this many cells."""


class Airspace:
    """What `fly` needs to know about a world; built once per world, immutable.

    Attributes
    ----------
    world : World
    proximity : MeshProximity
        The exact mesh.
    cell_m : float
        Cell of the coarse map [m].
    reaches : float64 (movers, 2, 3)
        Boxes that the world's movers never leave.
    """

    def __init__(self, world: World, proximity: MeshProximity | None = None) -> None:
        self.world = world
        self.proximity = MeshProximity(world.mesh) if proximity is None else proximity
        self.low = np.asarray(world.flight_box_m[0], np.float64)
        self.high = np.asarray(world.flight_box_m[1], np.float64)
        size = np.maximum(self.high[:2] - self.low[:2], 1.0)
        self.cell_m = max(1.0, float(np.sqrt(size[0] * size[1] / _MAX_CELLS)))
        columns, rows = np.ceil(size / self.cell_m).astype(int)
        self._layers = self._occupied_layers(int(rows), int(columns))
        self._wide = _widened(self._layers)
        self.reaches = reaches_of(world.movers)
        self.ceiling_m = float(world.mesh.vertices[:, 2].max(initial=0.0))

    def room(self, height_m: float, margin_m: float) -> UInt8[np.ndarray, "rows columns"]:
        """Cells between each cell and the nearest obstacle within `margin_m` of a height above ground.

        0 where the cell itself is occupied, `ROOM_CELLS` at most. Octagonal distance: at most 8 % off.
        """
        lowest = int(max(height_m - margin_m, 0.0) / _LAYER_M)
        highest = min(int((height_m + margin_m) / _LAYER_M), 63)
        band = sum(1 << layer for layer in range(lowest, highest + 1))
        blocked = (self._layers & np.uint64(band)) != 0
        room = (~blocked).astype(np.uint8)
        for step in range(1, ROOM_CELLS):
            blocked = _grown(blocked, square=step % 2 == 0)
            room += ~blocked
        return np.asarray(room)

    def tops(self, xy: Float64[np.ndarray, "*points 2"]) -> Float64[np.ndarray, "*points"]:
        """Height above ground [m] below which the coarse map has something within a cell or so; 0 outside it."""
        column, row = self._cell(xy)
        inside = self._on_map(column, row)
        layers = self._wide[np.where(inside, row, 0), np.where(inside, column, 0)]
        # The exponent of a power of two: rounding up to the next one is a layer too high, never too low.
        highest = np.where(layers > 0, np.frexp(layers.astype(np.float64))[1], 0)
        return np.where(inside, _LAYER_M * highest, 0.0)

    def blocked(self, points: Float64[np.ndarray, "*points 3"]) -> Bool[np.ndarray, "*points"]:
        """Where the coarse map has something within a cell or two, or ends."""
        column, row = self._cell(points[..., :2])
        inside = self._on_map(column, row)
        ground = self.world.ground.at(points[..., :2].reshape(-1, 2)).reshape(points.shape[:-1])
        above = points[..., 2] - ground
        layer = np.clip((above / _LAYER_M).astype(np.int64), 0, 63).astype(np.uint64)
        taken = self._wide[np.where(inside, row, 0), np.where(inside, column, 0)] >> layer & np.uint64(1)
        return np.asarray(~inside | (above < _GROUND_M) | (taken > 0))

    def look_up(
        self, room: UInt8[np.ndarray, "rows columns"], xy: Float64[np.ndarray, "*points 2"]
    ) -> Int64[np.ndarray, "*points"]:
        """Room at points; 0 outside the flight box."""
        column, row = self._cell(xy)
        inside = self._on_map(column, row)
        value = room[np.where(inside, row, 0), np.where(inside, column, 0)].astype(np.int64)
        return np.where(inside, value, 0)

    def centre(self, flat: Int64[np.ndarray, "cells"]) -> Float64[np.ndarray, "cells 2"]:
        """East and north of the middle of cells, given by flat index into the map."""
        row, column = np.divmod(flat, self._layers.shape[1])
        return np.asarray(self.low[:2] + (np.stack([column, row], axis=1) + 0.5) * self.cell_m)

    def open_to_sky(
        self, points: Float64[np.ndarray, "points 3"], clearance_m: float
    ) -> Bool[np.ndarray, "points"]:
        """Where a sphere can rise from the point until it is above everything without touching anything.

        Such a point is outside every closed shape whatever the orientation of its faces, and so is everything that
        a free path connects to it.
        """
        above = points.copy()
        above[:, 2] = np.maximum(points[:, 2], self.ceiling_m + clearance_m + 1.0)
        return ~self.proximity.sweep(points, above, clearance_m).touches

    def _on_map(
        self, column: Int64[np.ndarray, "*points"], row: Int64[np.ndarray, "*points"]
    ) -> Bool[np.ndarray, "*points"]:
        rows, columns = self._layers.shape
        return np.asarray((column >= 0) & (column < columns) & (row >= 0) & (row < rows))

    def _cell(
        self, xy: Float64[np.ndarray, "*points 2"]
    ) -> tuple[Int64[np.ndarray, "*points"], Int64[np.ndarray, "*points"]]:
        grid = np.floor((xy - self.low[:2]) / self.cell_m).astype(np.int64)
        return grid[..., 0], grid[..., 1]

    def _occupied_layers(self, rows: int, columns: int) -> UInt64[np.ndarray, "rows columns"]:
        """One bit per layer of 2 m above ground, set where the mesh has a point."""
        mesh, ground = self.world.mesh, self.world.ground
        points = np.array(mesh.vertices)
        occupied = np.zeros((rows, columns, 64), np.bool_)
        for part in parts(len(points)):
            points[part, 2] -= ground.at(points[part, :2].astype(np.float64))
            self._mark(occupied, points[part])
        box = np.array([*self.low[:2], _GROUND_M]), np.array([*self.high[:2], 64 * _LAYER_M])
        for samples in inner_points(points, mesh.faces, _SAMPLE_CELLS * self.cell_m, box):
            self._mark(occupied, samples)
        return np.packbits(occupied, axis=2, bitorder="little").view("<u8")[:, :, 0].astype(np.uint64)

    def _mark(
        self, occupied: Bool[np.ndarray, "rows columns 64"], points: Float32[np.ndarray, "points 3"]
    ) -> None:
        """Set the cells of points (east, north, height above ground), if they stand above the ground."""
        points = points[points[:, 2] > _GROUND_M]
        column, row = self._cell(points[:, :2].astype(np.float64))
        layer = (points[:, 2] / _LAYER_M).astype(np.int64)
        keep = (
            (column >= 0)
            & (column < occupied.shape[1])
            & (row >= 0)
            & (row < occupied.shape[0])
            & (layer < 64)
        )
        occupied[row[keep], column[keep], layer[keep]] = True


def _grown(blocked: Bool[np.ndarray, "rows columns"], *, square: bool) -> Bool[np.ndarray, "rows columns"]:
    """Grow by one cell to the four sides, and to the corners too if `square`."""
    out = blocked.copy()
    out[1:] |= blocked[:-1]
    out[:-1] |= blocked[1:]
    base = out.copy() if square else blocked
    out[:, 1:] |= base[:, :-1]
    out[:, :-1] |= base[:, 1:]
    return out


def _widened(layers: UInt64[np.ndarray, "rows columns"]) -> UInt64[np.ndarray, "rows columns"]:
    """Everything grown by a cell to all sides and by a layer up and down."""
    out = layers | layers << np.uint64(1) | layers >> np.uint64(1)
    for axis in (0, 1):
        grown = out.copy()
        before, after = (slice(None),) * axis + (slice(1, None),), (slice(None),) * axis + (slice(None, -1),)
        grown[before] |= out[after]
        grown[after] |= out[before]
        out = grown
    return np.asarray(out)
