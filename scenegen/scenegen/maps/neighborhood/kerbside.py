"""What stands along the streets: lamps, utility poles with their wires, signs, letter boxes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.buildings.detached.body import Home
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of
from scenegen.maps.neighborhood.letterboxes import build_letter_boxes, letter_box_places
from scenegen.maps.neighborhood.overhead import Overhead, build_overhead, hang
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.fixtures.erect import erect

_POLE_PITCH_M, _LAMP_PITCH_M = (31.0, 39.0), (30.0, 38.0)
_FROM_DRIVE_M, _FROM_KERB_M, _FROM_POST_M, _END_M = 0.7, 0.3, 1.5, 7.0
_FROM_WALK_M, _FROM_SIGN_M = 0.7, 0.36


@dataclass(frozen=True, eq=False)
class Kerbside:
    """Where things stand along streets.

    Attributes
    ----------
    lamps, signs, boxes : float64 (n, 3)
        Position and heading.
    overhead : Overhead
        Utility poles and their wires.
    """

    lamps: Float64[np.ndarray, "lamps 3"]
    signs: Float64[np.ndarray, "signs 3"]
    boxes: Float64[np.ndarray, "boxes 3"]
    overhead: Overhead

    def feet(self) -> Float64[np.ndarray, "feet 2"]:
        """Plan of all posts."""
        rows = [self.lamps, self.signs, self.boxes, *self.overhead.poles]
        return np.concatenate([r[:, :2] for r in rows])


def plan_kerbside(
    plan: StreetPlan,
    parcels: Sequence[Parcel],
    homes: Sequence[Home],
    solid: np.ndarray,
    walks: np.ndarray,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> Kerbside:
    """Draw places that keep clear of driveways and of each other.

    Parameters
    ----------
    plan, parcels, homes
        What was drawn so far.
    solid : array of shapely.Polygon
        Plan of each home.
    walks : array of shapely lines
        Ways of people, which stay free.
    shop : NeighborhoodWorkshop
    rng : numpy.random.Generator
    """
    drives = np.array([p.driveway for p in parcels if p.driveway is not None], dtype=object)
    ways = shapely.buffer(walks, max(_FROM_WALK_M - _FROM_DRIVE_M, 0.01))
    kerb = plan.carriageway.buffer(_FROM_KERB_M - _FROM_DRIVE_M)
    tree = shapely.STRtree(np.concatenate([drives, ways, [kerb]]))
    share = rng.uniform(*shop.knobs.pole_share)
    lamps: list[np.ndarray] = []
    poles: list[np.ndarray] = []
    for line in plan.lines:
        side = 1.0 if rng.uniform() < 0.5 else -1.0
        if rng.uniform() < share:
            row = _row(line, rng.uniform(*_POLE_PITCH_M), side * _offset(plan), tree, rng)
            row = _apart(row, np.concatenate([np.zeros((0, 3)), *poles]))
            if len(row) > 1:
                poles.append(_facing_on(row))
        light = _row(line, rng.uniform(*_LAMP_PITCH_M), -side * _offset(plan), tree, rng)
        light[:, 2] += -0.5 * np.pi * side
        lamps.append(light)
    pylons = np.concatenate([np.zeros((0, 3)), *poles])
    lights = np.zeros((0, 3))
    for row in lamps:
        lights = np.concatenate([lights, _apart(row, np.concatenate([pylons, lights]))])
    signs = _signs(plan)
    signs = signs[clear_of(np.asarray(shapely.points(signs[:, :2])), walks, _FROM_SIGN_M)]
    signs = _apart(signs, np.concatenate([pylons, lights]))
    return Kerbside(
        lights,
        signs,
        letter_box_places(parcels, np.concatenate([pylons, lights, signs])),
        hang(poles, homes, solid, shop),
    )


def build_kerbside(
    kerbside: Kerbside, homes: Sequence[Home], shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Posts, wires and boxes as parts."""
    parts = erect("lamp", shop.on_verge(kerbside.lamps), kerbside.lamps[:, 2], shop, rng, 0.8)
    parts += erect("stop_sign", shop.on_verge(kerbside.signs), kerbside.signs[:, 2], shop, rng, 0.95)
    parts += build_letter_boxes(kerbside.boxes, shop, rng)
    every = np.concatenate([np.zeros((0, 3)), *kerbside.overhead.poles])
    loaded = rng.uniform(size=len(every)) < 0.16
    for kind, mine in (("utility_pole", ~loaded), ("transformer_pole", loaded)):
        parts += erect(kind, shop.on_verge(every[mine]), every[mine, 2], shop, rng)
    return parts + build_overhead(kerbside.overhead, homes, shop, rng)


def _offset(plan: StreetPlan) -> float:
    """From the centre line to posts: on the verge, or behind the sidewalk."""
    half = CARRIAGEWAY_M / 2
    return half + 0.55 * plan.verge_m if plan.verge_m > 1.0 else half + plan.walk_m + 0.35


def _row(
    line: np.ndarray, pitch_m: float, right_m: float, drives: shapely.STRtree, rng: np.random.Generator
) -> np.ndarray:
    """Evenly spaced posts beside a street, each shifted or left out where a driveway or a turning circle is."""
    length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
    count = int((length - 2 * _END_M) / pitch_m) + 1
    if length < 3 * _END_M:
        return np.zeros((0, 3))
    marks = np.linspace(_END_M, length - _END_M, max(count, 2)) + rng.uniform(-1.0, 1.0, max(count, 2))
    rows = []
    for mark in marks:
        for shift in (0.0, 2.5, -2.5, 5.0, -5.0):
            at = np.clip(mark + shift, 3.0, length - 3.0)
            xy, heading = along(line, np.array([at]), np.array([right_m]))
            if not len(drives.query(shapely.Point(xy[0]), predicate="dwithin", distance=_FROM_DRIVE_M)):
                rows.append([*xy[0], float(heading[0])])
                break
    return np.array(rows).reshape(-1, 3)


def _apart(rows: np.ndarray, others: np.ndarray) -> np.ndarray:
    """The posts that keep their distance from those of other streets, as at junctions."""
    if not len(rows) or not len(others):
        return rows
    gap = np.linalg.norm(rows[:, None, :2] - others[None, :, :2], axis=2).min(axis=1)
    return np.asarray(rows[gap > _FROM_POST_M])


def _facing_on(row: np.ndarray) -> np.ndarray:
    """Poles turned so that cross-arms halve the angle between their two spans."""
    step = np.diff(row[:, :2], axis=0)
    unit = step / np.linalg.norm(step, axis=1)[:, None]
    mean = np.concatenate([unit[:1], unit[:-1] + unit[1:], unit[-1:]])
    return np.column_stack([row[:, :2], np.arctan2(mean[:, 1], mean[:, 0])])


def _signs(plan: StreetPlan) -> np.ndarray:
    """A stop sign at the right of each street that ends at a junction."""
    rows = []
    for line, (start, end) in zip(plan.lines, plan.dead_end, strict=True):
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        if length < 50.0 or np.linalg.norm(line[0] - line[-1]) < 1.0:
            continue
        right = CARRIAGEWAY_M / 2 + max(0.4 * plan.verge_m, 0.3)
        for dead, at, side in ((end, length - 9.5, 1.0), (start, 9.5, -1.0)):
            if not dead:
                xy, heading = along(line, np.array([at]), np.array([side * right]))
                rows.append([*xy[0], float(heading[0]) + (np.pi if side > 0 else 0.0)])
    table = np.array(rows[::2]).reshape(-1, 3)
    return np.asarray(table[~shapely.dwithin(plan.carriageway, shapely.points(table[:, :2]), 0.2)])
