"""Where one may fly in a world: a coarse map of what stands at which height, and the exact mesh to prove paths with.

The coarse map only proposes. It may miss a twig and may call a free gap occupied: no path is accepted on its word.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float64, Int64, UInt8, UInt32, UInt64

from scenegen.world import World
from scenegen_flythrough.clearance import MeshProximity

_LAYER_M = 2.0  # 64 layers of 2 m: heights of 0 to 128 m above ground in one 64-bit word
_GROUND_M = 0.5  # what reaches no higher above the ground is ground
_MAX_CELLS = 1_500_000
_SAMPLE_CELLS = 2.0  # step of the samples: walls may show gaps of a cell, too narrow to be taken for a way
_SAMPLES_AT_ONCE = 200_000
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

    def look_up(
        self, room: UInt8[np.ndarray, "rows columns"], xy: Float64[np.ndarray, "*points 2"]
    ) -> Int64[np.ndarray, "*points"]:
        """Room at points; 0 outside the flight box."""
        column, row = self._cell(xy)
        inside = (column >= 0) & (column < room.shape[1]) & (row >= 0) & (row < room.shape[0])
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

    def _cell(
        self, xy: Float64[np.ndarray, "*points 2"]
    ) -> tuple[Int64[np.ndarray, "*points"], Int64[np.ndarray, "*points"]]:
        grid = np.floor((xy - self.low[:2]) / self.cell_m).astype(np.int64)
        return grid[..., 0], grid[..., 1]

    def _occupied_layers(self, rows: int, columns: int) -> UInt64[np.ndarray, "rows columns"]:
        """One bit per layer of 2 m above ground, set where the mesh has a point."""
        mesh = self.world.mesh
        points = mesh.vertices.astype(np.float64)
        points[:, 2] -= self.world.ground.at(points[:, :2])
        occupied = np.zeros((rows, columns, 64), np.bool_)
        for samples in (points, *_inner_points(points, mesh.faces, _SAMPLE_CELLS * self.cell_m)):
            column, row = self._cell(samples[:, :2])
            layer = np.floor(samples[:, 2] / _LAYER_M)
            keep = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
            keep &= (samples[:, 2] > _GROUND_M) & (layer < 64)
            occupied[row[keep], column[keep], layer[keep].astype(np.int64)] = True
        return np.packbits(occupied, axis=2, bitorder="little").view("<u8")[:, :, 0].astype(np.uint64)


def _grown(blocked: Bool[np.ndarray, "rows columns"], *, square: bool) -> Bool[np.ndarray, "rows columns"]:
    """Grow by one cell to the four sides, and to the corners too if `square`."""
    out = blocked.copy()
    out[1:] |= blocked[:-1]
    out[:-1] |= blocked[1:]
    base = out.copy() if square else blocked
    out[:, 1:] |= base[:, :-1]
    out[:, :-1] |= base[:, 1:]
    return out


def _inner_points(
    points: Float64[np.ndarray, "vertices 3"], faces: UInt32[np.ndarray, "faces 3"], step_m: float
) -> Iterator[Float64[np.ndarray, "samples 3"]]:
    """Points inside triangles longer than a step, about a step apart; triangles on the ground are left out.

    Each triangle is covered by rows parallel to its longest side, so that a tall pane costs its area, not its height
    squared.
    """
    standing = faces[_standing_large(points, faces, step_m)]
    sides = np.stack(
        [_length2(points[standing[:, k - 2]] - points[standing[:, k]]) for k in range(3)], axis=1
    )
    base = np.argmax(sides, axis=1)
    longest = np.sqrt(np.take_along_axis(sides, base[:, None], axis=1)[:, 0])
    a, b, c = (points[np.take_along_axis(standing, (base[:, None] + k) % 3, axis=1)[:, 0]] for k in range(3))
    width = np.sqrt(_length2(np.cross(b - a, c - a))) / longest
    columns = np.minimum(np.ceil(longest / step_m), 1024.0).astype(np.int64) + 1
    rows = np.minimum(np.ceil(width / step_m), 1024.0).astype(np.int64) + 1
    counts = columns * rows
    ends = np.cumsum(counts)
    starts = ends - counts
    for first, last in _runs(ends, _SAMPLES_AT_ONCE):
        pick = np.repeat(np.arange(first, last), counts[first:last])
        index = np.arange(len(pick)) - np.repeat(starts[first:last] - starts[first], counts[first:last])
        row, column = np.divmod(index, columns[pick])
        v = (row / (rows[pick] - 1))[:, None]
        u = (column / (columns[pick] - 1))[:, None] * (1.0 - v)
        yield a[pick] + u * (b - a)[pick] + v * (c - a)[pick]


def _standing_large(
    points: Float64[np.ndarray, "vertices 3"], faces: UInt32[np.ndarray, "faces 3"], step_m: float
) -> Int64[np.ndarray, "large"]:
    """Faces that rise above the ground and are longer than a step along some axis."""
    risen = np.zeros(len(faces), np.bool_)
    long = np.zeros(len(faces), np.bool_)
    for axis in range(3):
        value = points[:, axis].astype(np.float32)
        a, b, c = (value[faces[:, k]] for k in range(3))
        highest = np.maximum(np.maximum(a, b), c)
        long |= highest - np.minimum(np.minimum(a, b), c) > step_m
        if axis == 2:
            risen = highest > _GROUND_M
    return np.flatnonzero(long & risen)


def _runs(ends: Int64[np.ndarray, "items"], size: int) -> Iterator[tuple[int, int]]:
    """Consecutive ranges of items whose counts (cumulative: `ends`) add up to about `size`."""
    first = 0
    while first < len(ends):
        done = int(ends[first - 1]) if first else 0
        last = max(int(np.searchsorted(ends, done + size)), first + 1)
        yield first, last
        first = last


def _length2(v: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n"]:
    return np.asarray((v * v).sum(axis=1))
