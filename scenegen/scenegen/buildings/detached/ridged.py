"""Roofs with a ridge: two slopes whose ends are gables, hips, walls of higher bodies or valleys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from scenegen.buildings.detached.body import Body, End

THICKNESS_M, BEHIND_M = 0.16, 0.05
"""Of roofs, measured upright; how far behind a wall's face the underside of the eaves ends."""

_VERGE_M = 0.3

Quads = list[list[list[float]]]
"""Corners (u, v, z), counter-clockwise from outside."""

Point = Callable[..., list[float]]
"""Point of a slope: position along the ridge, share of the way from eaves to ridge, lift [m]."""


@dataclass(frozen=True)
class Valley:
    """Where another roof runs into a slope: middle, half width at the eaves, and how high it reaches (0 to 1)."""

    middle_m: float
    half_m: float
    reach: float


@dataclass
class RoofQuads:
    """Quads of one roof in its own frame."""

    top: Quads
    thin: Quads
    gables: Quads


def ridged(body: Body, valleys: tuple[Valley | None, Valley | None]) -> RoofQuads:
    """Two slopes with their ends, undersides and edges."""
    h = (body.y1_m - body.y0_m if body.turned else body.x1_m - body.x0_m) / 2
    c, s, t = body.half_across_m, body.slope, THICKNESS_M
    # Turned by 90 degrees, +v points to -x.
    e_low, e_high = body.eaves_m[::-1] if body.turned else body.eaves_m
    ridge = body.eave_m + c * s
    ends = [_end(end, h, c, s, sign) for end, sign in zip(body.ends, (-1.0, 1.0), strict=True)]
    if all(end is End.HIP for end in body.ends) and h <= c + 0.15:
        ends = [(eave, -0.15 if k == 0 else 0.15) for k, (eave, _) in enumerate(ends)]
    roof = RoofQuads([], [], [])
    for side, over, valley in ((-1.0, e_low, valleys[0]), (1.0, e_high, valleys[1])):
        low, wide = body.eave_m - over * s, c + over
        left, right = (_eave_corner(ends[k], body.ends[k], over, k) for k in (0, 1))

        def at(
            u: float, share: float, lift: float, low: float = low, wide: float = wide, side: float = side
        ) -> list[float]:
            return [u, side * wide * (1 - share), low + share * (ridge - low) + lift]

        def edge(k: int, share: float, left: float = left, right: float = right) -> float:
            foot = (left, right)[k]
            return foot + share * (ends[k][1] - foot)

        for quad in _cut_slope(edge, valley):
            points = [at(u, q, t) for u, q in quad]
            roof.top.append(points if side < 0 else points[::-1])
        lip = min((over + BEHIND_M) / wide, 0.9)
        for a, b in _eave_runs(left, right, valley):
            under = [at(b, 0.0, 0.0), at(a, 0.0, 0.0), at(a, lip, 0.0), at(b, lip, 0.0)]
            face = [at(a, 0.0, 0.0), at(b, 0.0, 0.0), at(b, 0.0, t), at(a, 0.0, t)]
            if over > 0.05:  # else it lies against a wall
                roof.thin.append(under if side < 0 else under[::-1])
                roof.thin.append(face if side < 0 else face[::-1])
        for k, sign in ((0, -1.0), (1, 1.0)):
            if body.ends[k] is End.GABLE:
                _verge(roof, at, edge(k, 0.0), sign * (h - BEHIND_M), lip, side, sign, t)
    over = max(body.eaves_m)
    for k, sign in ((0, -1.0), (1, 1.0)):
        if body.ends[k] is End.HIP:
            _hip_end(roof, body, ends[k], over, ridge, sign)
        if body.ends[k] is End.GABLE:
            u = sign * h
            apex = [u, 0.0, ridge]
            roof.gables.append([[u, -sign * c, body.eave_m], [u, sign * c, body.eave_m], apex, apex])
    return roof


def _end(end: End, h: float, c: float, s: float, sign: float) -> tuple[float, float]:
    """Position along the ridge of an end's wall line and of the ridge's end."""
    ridge = {
        End.GABLE: h + _VERGE_M,
        End.HIP: max(h - c, 0.15),
        End.WALL: h - 0.01,
        End.VALLEY: h + c,
    }[end]
    return sign * h, sign * ridge


def _eave_corner(end: tuple[float, float], kind: End, over: float, k: int) -> float:
    """Position along the ridge of the eaves' corner."""
    sign = 1.0 if k == 1 else -1.0
    shift = {End.GABLE: _VERGE_M, End.HIP: over, End.WALL: -0.01, End.VALLEY: -over}[kind]
    return end[0] + sign * shift


def _cut_slope(edge: Callable[[int, float], float], valley: Valley | None) -> list[list[tuple[float, float]]]:
    """Quads (u, share of the height) of a slope, without the triangle behind a valley."""
    whole = [[(edge(0, 0.0), 0.0), (edge(1, 0.0), 0.0), (edge(1, 1.0), 1.0), (edge(0, 1.0), 1.0)]]
    if valley is None:
        return whole
    x, half, q = valley.middle_m, valley.half_m, min(valley.reach, 1.0)
    pieces = [
        [(edge(0, 0.0), 0.0), (x - half, 0.0), (x, q), (edge(0, q), q)],
        [(x + half, 0.0), (edge(1, 0.0), 0.0), (edge(1, q), q), (x, q)],
    ]
    if q < 0.995:
        pieces.append([(edge(0, q), q), (edge(1, q), q), (edge(1, 1.0), 1.0), (edge(0, 1.0), 1.0)])
    return pieces


def _eave_runs(left: float, right: float, valley: Valley | None) -> list[tuple[float, float]]:
    if valley is None:
        return [(left, right)]
    a, b = valley.middle_m - valley.half_m, valley.middle_m + valley.half_m
    return [(p, q) for p, q in ((left, a), (b, right)) if q - p > 0.05]


def _verge(
    roof: RoofQuads, at: Point, u: float, back: float, lip: float, side: float, sign: float, t: float
) -> None:
    """Edge and underside of a slope beyond a gable."""
    face = [at(u, 0.0, 0.0), at(u, 1.0, 0.0), at(u, 1.0, t), at(u, 0.0, t)]
    under = [at(u, 1.0, 0.0), at(u, lip, 0.0), at(back, lip, 0.0), at(back, 1.0, 0.0)]
    flip = side * sign > 0
    roof.thin.append(face[::-1] if flip else face)
    roof.thin.append(under[::-1] if flip else under)


def _hip_end(
    roof: RoofQuads, body: Body, end: tuple[float, float], over: float, ridge: float, sign: float
) -> None:
    """Triangle, edge and underside of a hip."""
    c, t = body.half_across_m, THICKNESS_M
    low, foot = body.eave_m - over * body.slope, end[0] + sign * over
    wide = c + over
    apex = [end[1], 0.0, ridge + t]
    a, b = [foot, -sign * wide, low], [foot, sign * wide, low]
    lifted = [[p[0], p[1], p[2] + t] for p in (a, b)]
    roof.top.append([*lifted, apex, apex])
    roof.thin.append([a, b, lifted[1], lifted[0]])
    share = (over + BEHIND_M) / wide
    inner = [
        [p[0] + share * (end[1] - p[0]), p[1] * (1 - share), low + share * (ridge - low)] for p in (a, b)
    ]
    roof.thin.append([b, a, inner[0], inner[1]])
