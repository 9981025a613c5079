"""Overhead wires: from pole to pole, between streets, and down to masts on the roofs of houses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.buildings.detached.body import Home, Role, Top
from scenegen.classes import Semantic
from scenegen.geometry.part import Part
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.fixtures.utility import fastenings
from scenegen.parts.fixtures.wires import wires

_WIRE_M, _CABLE_M, _DROP_M = 0.009, 0.016, 0.011
_SAG, _DROP_SAG = 0.018, 0.03
_LONGEST_SPAN_M, _LONGEST_DROP_M = 52.0, 42.0
_MAST_IN_M, _MAST_UP_M, _MAST_RADIUS_M = 0.6, 1.05, 0.035


@dataclass(frozen=True, eq=False)
class Overhead:
    """Poles and what hangs between them.

    Attributes
    ----------
    poles : tuple of float64 (n, 3)
        Utility poles of each stretch of street, in order; position and heading along the line.
    links : float64 (links, 2, 2)
        Spans between poles of different stretches.
    drops : tuple of (int, float64 (3,), float64 (3,))
        Index of the home, top of its mast, fastening at the pole.
    """

    poles: tuple[Float64[np.ndarray, "_ 3"], ...]
    links: Float64[np.ndarray, "links 2 2"]
    drops: tuple[tuple[int, np.ndarray, np.ndarray], ...]

    def spans(self) -> Float64[np.ndarray, "spans 2 2"]:
        """Plan of everything that hangs; trees keep clear."""
        lines = [np.stack([p[:-1, :2], p[1:, :2]], axis=1) for p in self.poles]
        down = [np.array([[top[:2], end[:2]]]) for _, top, end in self.drops]
        return np.concatenate([np.zeros((0, 2, 2)), *lines, self.links, *down])


def hang(
    poles: Sequence[np.ndarray], homes: Sequence[Home], solid: np.ndarray, shop: NeighborhoodWorkshop
) -> Overhead:
    """Decide which poles and houses are wired together.

    Parameters
    ----------
    poles : sequence of float64 (n, 3)
        Of each stretch of street.
    homes : sequence of Home
    solid : array of shapely.Polygon
        Plan of each home.
    shop : NeighborhoodWorkshop
    """
    houses = shapely.STRtree(solid)
    drops = _drops(poles, homes, houses, shop)
    return Overhead(tuple(poles), _links(poles, houses), tuple(drops))


def _links(poles: Sequence[np.ndarray], houses: shapely.STRtree) -> np.ndarray:
    """Spans between the ends of different stretches, so that few lines end nowhere; none over a house."""
    if len(poles) < 2:
        return np.zeros((0, 2, 2))
    ends = np.array([[p[0, :2], p[-1, :2]] for p in poles])
    everyone = np.concatenate([p[:, :2] for p in poles])
    owner = np.repeat(np.arange(len(poles)), [len(p) for p in poles])
    found, joined = [], set()
    for k, pair in enumerate(ends):
        for end in pair:
            gap = np.linalg.norm(everyone - end, axis=1)
            gap[owner == k] = np.inf
            near = int(np.argmin(gap))
            key = (min(k, int(owner[near])), max(k, int(owner[near])))
            if gap[near] < _LONGEST_SPAN_M and key not in joined:
                joined.add(key)
                found.append([end, everyone[near]])
    spans = np.array(found).reshape(-1, 2, 2)
    crossing = houses.query(shapely.linestrings(spans), predicate="intersects")[0] if len(spans) else []
    return np.delete(spans, np.unique(crossing).astype(np.int64), axis=0)


def _drops(
    poles: Sequence[np.ndarray], homes: Sequence[Home], houses: shapely.STRtree, shop: NeighborhoodWorkshop
) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """From poles to masts on the roofs of houses nearby, where no other house is in the way."""
    if not poles:
        return []
    every = np.concatenate(poles)
    _, cables = fastenings(shop.on_verge(every), every[:, 2])
    drops = []
    for k, home in enumerate(homes):
        if home.bodies[0].role is not Role.HOUSE:
            continue
        tops = _mast_tops(home)
        gap = np.linalg.norm(tops[:, None, :2] - cables[None, :, :2], axis=2)
        corner, pole = np.unravel_index(int(np.argmin(gap)), gap.shape)
        span = shapely.LineString([tops[corner, :2], cables[pole, :2]])
        others = set(houses.query(span, predicate="intersects").tolist()) - {k}
        if gap[corner, pole] < _LONGEST_DROP_M and not others:
            drops.append((k, tops[corner], cables[pole] + np.array([0.0, 0.0, 0.45])))
    return drops


def _mast_tops(home: Home) -> np.ndarray:
    """Tops of masts that might stand at the four corners of the main roof."""
    body, d = home.bodies[0], _MAST_IN_M
    local = np.array([[x, y] for x in (body.x0_m + d, body.x1_m - d) for y in (body.y0_m + d, body.y1_m - d)])
    over = {Top.RIDGED: d * body.slope, Top.FLAT: 0.25, Top.SHED: body.rise_m}[body.top]
    top = home.floor_m + body.eave_m + over + _MAST_UP_M
    return np.column_stack([home.lot.world(local), np.full(4, top)])


def build_overhead(
    overhead: Overhead, homes: Sequence[Home], shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Conductors and telephone cables from pole to pole, drops and the masts they end on."""
    starts, ends = [np.zeros((0, 4, 3))], [np.zeros((0, 4, 3))]
    cable_starts, cable_ends = [np.zeros((0, 3))], [np.zeros((0, 3))]
    tips: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for row in overhead.poles:
        insulators, cables = fastenings(shop.on_verge(row), row[:, 2])
        starts.append(insulators[:-1])
        ends.append(insulators[1:])
        cable_starts.append(cables[:-1])
        cable_ends.append(cables[1:])
        tips.append((row[:, :2], insulators, cables))
    if tips:
        places, insulators, cables = (np.concatenate([t[k] for t in tips]) for k in range(3))
        for a, b in overhead.links:
            i, j = (int(np.argmin(np.linalg.norm(places - p, axis=1))) for p in (a, b))
            cable_starts.append(cables[i : i + 1])
            cable_ends.append(cables[j : j + 1])
    aluminium = shop.palette.pick("metal_galv_weathered", rng)
    rubber = shop.palette.only("tyre_rubber")
    parts = [
        _hung(
            np.concatenate(starts).reshape(-1, 3),
            np.concatenate(ends).reshape(-1, 3),
            _SAG,
            _WIRE_M,
            aluminium,
            shop,
        )
    ]
    parts.append(
        _hung(np.concatenate(cable_starts), np.concatenate(cable_ends), 1.3 * _SAG, _CABLE_M, rubber, shop)
    )
    if overhead.drops:
        tops = np.array([d[1] for d in overhead.drops])
        parts.append(_hung(tops, np.array([d[2] for d in overhead.drops]), _DROP_SAG, _DROP_M, rubber, shop))
        owner = np.array([homes[k].object for k, _, _ in overhead.drops], np.int64)
        eave = np.array([homes[k].floor_m + homes[k].bodies[0].eave_m for k, _, _ in overhead.drops])
        feet = np.column_stack([tops[:, :2], eave - 0.1])
        upper = tops + np.array([0.0, 0.0, 0.06])
        none = np.zeros(len(tops))
        parts.append(wires(feet, upper, none, _MAST_RADIUS_M, aluminium, int(Semantic.POLE), owner, chords=1))
    return parts


def _hung(
    start: np.ndarray, end: np.ndarray, sag: float, radius_m: float, skin: int, shop: NeighborhoodWorkshop
) -> Part:
    """Wires whose sag is a share of their span, one instance each."""
    span = np.linalg.norm(end - start, axis=1)
    owner = shop.builder.new_objects(len(start)) + np.arange(len(start))
    return wires(start, end, sag * span, radius_m, skin, int(Semantic.WIRE), owner)
