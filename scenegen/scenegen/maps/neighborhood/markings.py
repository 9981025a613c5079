"""Paint on the carriageway: centre dashes on the longer streets, stop lines before junctions."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.placement import along
from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, StreetPlan

_DASH_M, _PITCH_M, _LINE_M = 3.0, 9.0, 0.14
_CLEAR_M, _STOP_M = 14.0, 9.0
_LONG_M = 110.0


def marking_quads(plan: StreetPlan, rng: np.random.Generator) -> np.ndarray:
    """Corners (quads, 4, 2) of all markings [m]; they do not overlap."""
    quads = [np.zeros((0, 4, 2))]
    for line, (start, end) in zip(plan.lines, plan.dead_end, strict=True):
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        if length > _LONG_M and rng.uniform() < 0.7:
            marks = np.arange(_CLEAR_M, length - _CLEAR_M - _DASH_M, _PITCH_M)
            quads.append(
                _strips(line, marks, marks + _DASH_M, np.zeros(len(marks)), np.full(len(marks), _LINE_M))
            )
        half = CARRIAGEWAY_M / 2
        for dead, at, side in ((end, length - _STOP_M, 1.0), (start, _STOP_M, -1.0)):
            if not dead and length > 40.0:
                right, wide = np.array([side * half / 2]), np.array([half - 0.7])
                quads.append(_strips(line, np.array([at - 0.18]), np.array([at + 0.18]), right, wide))
    return np.concatenate(quads)


def _strips(
    line: np.ndarray, start_m: np.ndarray, end_m: np.ndarray, right_m: np.ndarray, width_m: np.ndarray
) -> np.ndarray:
    """Quads along a street between two distances, centred at an offset to the right."""
    a, _ = along(line, start_m, right_m)
    b, _ = along(line, end_m, right_m)
    step = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    side = np.column_stack([step[:, 1], -step[:, 0]]) * (width_m / 2)[:, None]
    return np.stack([a + side, b + side, b - side, a - side], axis=1)
