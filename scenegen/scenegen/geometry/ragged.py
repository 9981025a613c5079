"""Ragged index arithmetic: many small grids of different sizes as flat arrays, without Python loops."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int64


def ragged_arange(
    counts: Int64[np.ndarray, "items"],
) -> tuple[Int64[np.ndarray, "total"], Int64[np.ndarray, "total"]]:
    """For each item 0..count-1: the item it belongs to and the running index inside it."""
    total = int(counts.sum())
    item = np.repeat(np.arange(len(counts)), counts)
    start = np.concatenate([[0], np.cumsum(counts)[:-1]]) if len(counts) else np.zeros(0, np.int64)
    return item, np.arange(total) - np.repeat(start, counts)


def ragged_grid(
    columns: Int64[np.ndarray, "items"], rows: Int64[np.ndarray, "items"]
) -> tuple[Int64[np.ndarray, "total"], Int64[np.ndarray, "total"], Int64[np.ndarray, "total"]]:
    """Item, column and row of every cell of many grids; rows run slowest inside an item."""
    item, index = ragged_arange(columns * rows)
    width = columns[item]
    return item, index % width, index // width


def offsets(counts: Int64[np.ndarray, "items"]) -> Int64[np.ndarray, "items"]:
    """Start of each item in the flat array."""
    return np.asarray(np.cumsum(counts) - counts, np.int64)
