"""Recordings as text: CSV with a header, and the TUM format of visual odometry."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from scenegen.foundation.errors import InputError
from scenegen_flythrough.recordings.recording import Recording, checked

_TIME = ("time_s", "t", "time", "timestamp")
_PLACE = (("x_m", "x"), ("y_m", "y"), ("z_m", "z"))
_TURN = ("qx", "qy", "qz", "qw")


def read_csv(path: Path) -> Recording:
    """Columns by name: ``time_s, x, y, z`` and, if known, ``qx, qy, qz, qw``; others are ignored.

    Raises
    ------
    InputError
        In one line.
    """
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.reader(file))
    header = [cell.strip().lower() for cell in rows[0]] if rows else []
    time = next((header.index(name) for name in _TIME if name in header), None)
    places = [next((header.index(name) for name in names if name in header), None) for names in _PLACE]
    if time is None or None in places:
        raise InputError(f"{path}: the first line must name the columns time_s, x, y, z (and qx, qy, qz, qw)")
    turns = [header.index(name) for name in _TURN if name in header]
    if len(turns) not in (0, 4):
        raise InputError(f"{path}: an orientation takes all of qx, qy, qz, qw")
    columns = [time, *(k for k in places if k is not None), *turns]
    return _recording(path, [[row[k] if k < len(row) else "" for k in columns] for row in rows[1:] if row], 2)


def read_tum(path: Path) -> Recording:
    """Lines ``timestamp x y z qx qy qz qw``, blanks between, ``#`` for comments (vision.in.tum.de, RGB-D benchmark).

    Raises
    ------
    InputError
        In one line.
    """
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    kept = [
        (k, line.split())
        for k, line in enumerate(lines, 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    for k, cells in kept:
        if len(cells) != 8:
            raise InputError(
                f"{path}: line {k} has {len(cells)} numbers, not 8 (timestamp x y z qx qy qz qw)"
            )
    return _recording(path, [cells for _, cells in kept], 1)


def _recording(path: Path, rows: list[list[str]], first_line: int) -> Recording:
    try:
        values = np.array(rows, np.float64).reshape(len(rows), -1)
    except ValueError:
        for k, row in enumerate(rows):
            for cell in row:
                _number(path, k + first_line, cell)
        raise
    if values.shape[1] == 0:
        values = np.zeros((0, 8))
    quaternion = values[:, 4:8] if values.shape[1] == 8 else None
    return checked(str(path), values[:, 0], values[:, 1:4], quaternion)


def _number(path: Path, line: int, cell: str) -> float:
    try:
        return float(cell)
    except ValueError as error:
        raise InputError(f"{path}: line {line}: '{cell[:40]}' is not a number") from error
