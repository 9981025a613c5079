"""Paint on the carriageway: lane lines, zebra crossings and stop lines, as quads cut into the ground plan."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.placement import along
from scenegen.maps.city.streets import Link, Rank, Street, StreetPlan

_ZEBRA_LENGTH_M, _ZEBRA_STRIPE_M, _ZEBRA_PITCH_M = 3.0, 0.5, 1.05
_LINE_M = 0.16


def marking_quads(plan: StreetPlan, rng: np.random.Generator) -> np.ndarray:
    """Corners (quads, 4, 2) of all markings [m]; they do not overlap."""
    quads = [np.zeros((0, 4, 2))]
    for link in plan.links:
        street = plan.streets[link.street]
        zebra = street.rank is not Rank.SIDE or rng.uniform() < 0.3
        if zebra and link.end_m - link.start_m > 30.0:
            quads.append(_crossing(street, link.start_m, -1.0))
            quads.append(_crossing(street, link.end_m, 1.0))
        quads.append(_lane_lines(street, link))
    return np.concatenate(quads)


def _strips(
    street: Street, start_m: np.ndarray, end_m: np.ndarray, right_m: np.ndarray, width_m: np.ndarray
) -> np.ndarray:
    """Quads along a street between two distances, centred at an offset to the right."""
    a, _ = along(street.line, start_m, right_m)
    b, _ = along(street.line, end_m, right_m)
    step = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    side = np.column_stack([step[:, 1], -step[:, 0]]) * (width_m / 2)[:, None]
    return np.stack([a + side, b + side, b - side, a - side], axis=1)


def _crossing(street: Street, at_m: float, inward: float) -> np.ndarray:
    """Zebra stripes just inside a link's end, and the stop line behind them on the approaching lane."""
    half = street.width_m / 2
    count = int((street.width_m - 1.4) / _ZEBRA_PITCH_M)
    right = (np.arange(count) - (count - 1) / 2) * _ZEBRA_PITCH_M
    near, far = sorted((at_m, at_m - inward * _ZEBRA_LENGTH_M))
    zebra = _strips(street, np.full(count, near), np.full(count, far), right, np.full(count, _ZEBRA_STRIPE_M))
    line = at_m - inward * (_ZEBRA_LENGTH_M + 1.2)
    stop = _strips(
        street,
        np.array([line - 0.2]),
        np.array([line + 0.2]),
        np.array([inward * half / 2]),
        np.array([half - 0.6]),
    )
    return np.concatenate([zebra, stop])


def _lane_lines(street: Street, link: Link) -> np.ndarray:
    """Dashes between lanes; side streets have none."""
    patterns = {
        Rank.ARTERIAL: ((0.0, 4.0, 6.0), (3.5, 3.0, 9.0), (-3.5, 3.0, 9.0)),
        Rank.COLLECTOR: ((0.0, 3.0, 9.0),),
        Rank.SIDE: (),
    }[street.rank]
    quads = [np.zeros((0, 4, 2))]
    for right, dash, pitch in patterns:
        start = np.arange(link.start_m + 6.0, link.end_m - 6.0 - dash, pitch)
        if len(start):
            quads.append(
                _strips(street, start, start + dash, np.full(len(start), right), np.full(len(start), _LINE_M))
            )
    return np.concatenate(quads)
