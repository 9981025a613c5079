"""What separates gardens: fences of several kinds, hedges, or nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.part import Part
from scenegen.geometry.relief import Relief
from scenegen.maps.neighborhood.lots import Division
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import KERB_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.fixtures.fences import fence

_STYLES = (("board", 0.18, (1.5, 1.9)), ("picket", 0.16, (0.9, 1.2)), ("rail", 0.34, (1.0, 1.3)),
           ("wall", 0.22, (0.8, 1.7)), ("chain_link", 0.07, (1.1, 1.5)))  # fmt: skip
"""Style, share, range of height [m]."""

_SHORTEST_M, _FRONT_M, _CLEAR_M = 4.0, 5.0, 0.5
_HEDGES_M = ((1.0, 0.6), (1.4, 0.8), (1.8, 0.9), (2.2, 1.1))
"""Height and width of the hedges there are."""


@dataclass(frozen=True, eq=False)
class Line:
    """One fence or hedge.

    Attributes
    ----------
    points : float64 (points, 2)
        Plan [m].
    style : str
        Of a fence, or "hedge".
    height_m, width_m : float
    """

    points: Float64[np.ndarray, "points 2"]
    style: str
    height_m: float
    width_m: float


@dataclass(frozen=True, eq=False)
class Raised:
    """A relief lifted to the level of gardens."""

    base: Relief

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Height [m] at plan points."""
        return np.asarray(self.base(xy) + KERB_M)


def on_gardens(shop: NeighborhoodWorkshop) -> NeighborhoodWorkshop:
    """The workshop with its relief at the level of gardens."""
    return replace(shop, relief=Raised(shop.relief))


def plan_borders(
    division: Division,
    parcels: list[Parcel],
    plan: StreetPlan,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> list[Line]:
    """Choose what stands on each border; it ends before the front garden and keeps clear of paving and sheds."""
    hedges, fences = rng.uniform(*shop.knobs.hedge_share), rng.uniform(*shop.knobs.fence_share)
    weights = np.array([s[1] for s in _STYLES]) * rng.uniform(0.3, 1.7, len(_STYLES))
    taken = [g for p in parcels for g in (p.solid, p.driveway, p.garden.coping) if g is not None]
    obstacles = shapely.STRtree(np.array(taken, dtype=object))
    public = plan.front.buffer(0.3)
    open_front = plan.front.buffer(_FRONT_M)
    lines: list[Line] = []
    for border in division.borders:
        choice, full = rng.uniform(), rng.uniform() < 0.25
        kind = int(rng.choice(len(_STYLES), p=weights / weights.sum()))
        size = float(rng.uniform())
        if choice > hedges + (1 - hedges) * fences:
            continue
        hedge = choice < hedges
        line = shapely.simplify(shapely.LineString(border), 0.25).difference(
            public if full or hedge else open_front
        )
        near = obstacles.query(line, predicate="dwithin", distance=_CLEAR_M + 0.5 * hedge)
        if len(near):
            line = line.difference(
                shapely.union_all(obstacles.geometries[near]).buffer(_CLEAR_M + 0.5 * hedge)
            )
        for piece in shapely.get_parts(line):
            if piece.geom_type == "LineString" and piece.length > _SHORTEST_M:
                lines.append(_line(shapely.get_coordinates(piece), hedge, kind, size))
    return lines


def _line(points: np.ndarray, hedge: bool, kind: int, size: float) -> Line:
    if hedge:
        return Line(points, "hedge", *_HEDGES_M[int(size * len(_HEDGES_M))])
    style, _, (low, high) = _STYLES[kind]
    return Line(points, style, low + size * (high - low), 0.1)


def build_fences(lines: list[Line], shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Part]:
    """All fences; hedges are greenery."""
    raised = on_gardens(shop)
    return [
        part
        for line in lines
        if line.style != "hedge"
        for part in fence(line.points, line.style, line.height_m, raised, rng)
    ]
