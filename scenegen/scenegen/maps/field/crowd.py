"""People who stay where they are: spectators on seats and at the rail, goalkeepers, some on the forecourt."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.geometry.part import Part
from scenegen.geometry.placement import clear_of, first_come
from scenegen.maps.field.grounds import Grounds, Pitch
from scenegen.maps.field.stands import Seats
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.people.stand import stand

_APART_M = 0.9


def build_crowd(
    grounds: Grounds,
    seats: Sequence[Seats],
    obstacles: np.ndarray,
    shop: FieldWorkshop,
    rng: np.random.Generator,
) -> tuple[list[Part], int]:
    """All people as parts, and their number.

    Parameters
    ----------
    grounds : Grounds
    seats : sequence of Seats
    obstacles : array of shapely geometries
        Vehicles, posts, buildings and footpaths that people keep clear of.
    shop : FieldWorkshop
    rng : numpy.random.Generator
    """
    groups: list[tuple[str, np.ndarray]] = []
    groups.append(("standing", _keepers(grounds.pitches[0], rng)))
    groups += _bystanders(grounds, shop, rng)
    parts, count = [], 0
    placed: list[np.ndarray] = []
    for posture, rows in groups:
        free = clear_of(
            shapely.points(rows[:, :2]), np.asarray([*obstacles, *placed], dtype=object), _APART_M
        )
        free[np.flatnonzero(free)] = first_come(shapely.buffer(shapely.points(rows[free, :2]), _APART_M / 2))
        rows = rows[free]
        placed += list(shapely.points(rows[:, :2]))
        position = np.column_stack([rows[:, :2], shop.relief(rows[:, :2])])
        parts += stand(position, rows[:, 2], posture, shop, rng)
        count += len(rows)
    share = rng.uniform(*shop.knobs.stand_occupancy)
    for row in seats:
        taken = rng.uniform(size=len(row.position)) < share
        taken[1:] &= ~taken[:-1]  # elbow room
        position = row.position[taken]
        heading = row.heading_rad + rng.normal(0.0, 0.2, len(position))
        parts += stand(position, heading, "sitting", shop, rng)
        count += len(position)
    return parts, count


def _keepers(pitch: Pitch, rng: np.random.Generator) -> np.ndarray:
    """Two goalkeepers before their goals: x, y, heading."""
    a = pitch.length_m / 2 - 1.2
    local = np.column_stack([[-a, a], rng.normal(0.0, 1.0, 2)])
    turn = pitch.frame.heading_rad + np.array([0.0, np.pi])
    return np.column_stack([pitch.frame.world(local), turn])


def _bystanders(
    grounds: Grounds, shop: FieldWorkshop, rng: np.random.Generator
) -> list[tuple[str, np.ndarray]]:
    """Along the barrier watching, on the forecourt and between the cars."""
    count = round(rng.uniform(*shop.knobs.bystanders))
    half_x, half_y = grounds.half_m
    watching = round(0.5 * count)
    side = np.where(rng.uniform(size=watching) < 0.5, 1.0, -1.0)
    reach = grounds.stands[-1].length_m / 2 + 3.0 if len(grounds.stands) > 1 else 0.0
    x = rng.uniform(-0.6, 0.6, watching) * half_x
    x = np.where(np.abs(x) < reach, x + np.sign(x + 1e-9) * reach, x)
    y = side * (half_y + 0.6)
    inside = grounds.frame.world(np.column_stack([x, y]))
    rail = np.column_stack([inside, grounds.frame.heading_rad - side * np.pi / 2])
    main = np.abs(x) < grounds.stands[0].length_m / 2 + 2.0
    rail = rail[~(main & (side < 0))]
    x0, y0, x1, y1 = shapely.transform(grounds.forecourt, grounds.frame.local).bounds
    about = rng.uniform((x0 + 1.0, y0 + 1.0), (x1 - 1.0, y1 - 1.0), (count - watching, 2))
    court = np.column_stack([grounds.frame.world(about), rng.uniform(0.0, 2 * np.pi, len(about))])
    return [("standing", rail), ("standing", court)]
