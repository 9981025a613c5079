"""Roofs of detached houses: ridges with gables, hips and valleys, sheds, and flat slabs, as lattices.

Each roof is drawn in its own frame (u along the ridge, v across, z above the floor) and then moved to the world. A
slope that another roof runs into is cut along the valleys, so that no part of it lies hidden.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scenegen.buildings.detached.body import Body, End, Home, Role, Top
from scenegen.buildings.detached.features import pierced
from scenegen.classes import Semantic
from scenegen.geometry.hidden import push_out
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.patch import patches

_SPACING_M, _THIN_SPACING_M = 2.9, 6.0
_THICKNESS_M = 0.16
_VERGE_M = 0.3
_BEHIND_M, _CLEAR_M = 0.05, 0.3

Quads = list[list[list[float]]]


@dataclass(frozen=True)
class _Valley:
    """Where another roof runs into a slope: middle, half width at the eaves, and how high it reaches (0 to 1)."""

    middle_m: float
    half_m: float
    reach: float


@dataclass
class _Roof:
    """Quads of one roof in its own frame."""

    top: Quads
    thin: Quads
    gables: Quads


def home_roofs(homes: Sequence[Home]) -> Part:
    """Roofs of all bodies and the gable walls below them."""
    tops: list[np.ndarray] = []
    thins: list[np.ndarray] = []
    labels: list[list[tuple[int, int, int]]] = [[], []]
    for home in homes:
        style, roof = home.style, int(Semantic.ROOF)
        for body in home.bodies:
            drawn = _roof(body, home)
            for quads, bucket, k, skin, semantic in (
                (drawn.top, tops, 0, style.roof, roof),
                (drawn.thin, thins, 1, style.roof, roof),
                (drawn.gables, tops, 0, style.gable, int(Semantic.WALL)),
            ):
                if quads:
                    bucket.append(_placed(np.array(quads, np.float64), body, home))
                    labels[k] += [(skin, semantic, home.object)] * len(quads)
    upper = _patched(tops, labels[0], _SPACING_M, False)
    return concatenate([_cleared(upper, homes), _patched(thins, labels[1], _THIN_SPACING_M, True)])


def _cleared(roofs: Part, homes: Sequence[Home]) -> Part:
    """Roof sites moved out from below chimneys and dormers."""
    plans = [rectangle for home in homes for rectangle in pierced(home)]
    return push_out(roofs, np.array(plans, dtype=object), _CLEAR_M) if plans else roofs


def _patched(
    quads: list[np.ndarray], labels: list[tuple[int, int, int]], spacing_m: float, lumped: bool
) -> Part:
    table = np.array(labels, np.int64).reshape(-1, 3)
    corners = np.concatenate([np.zeros((0, 4, 3)), *quads])
    return patches(corners, spacing_m, table[:, 0], table[:, 1], table[:, 2], lumped_rows=lumped)


def _placed(quads: np.ndarray, body: Body, home: Home) -> np.ndarray:
    """From the frame of a roof to the world."""
    u, v, z = quads[..., 0], quads[..., 1], quads[..., 2]
    if body.top is Top.SHED and body.falling:
        u, v = -u, -v
    x, y = (-v, u) if body.turned and body.top is Top.RIDGED else (v, -u) if body.turned else (u, v)
    x, y = x + (body.x0_m + body.x1_m) / 2, y + (body.y0_m + body.y1_m) / 2
    xy = home.lot.world(np.column_stack([x.ravel(), y.ravel()])).reshape(*x.shape, 2)
    return np.concatenate([xy, (z + home.floor_m)[..., None]], axis=-1)


def _roof(body: Body, home: Home) -> _Roof:
    if body.top is Top.FLAT:
        return _flat(body)
    if body.top is Top.SHED:
        return _shed(body)
    return _ridged(body, _valleys(body, home))


def _valleys(body: Body, home: Home) -> tuple[_Valley | None, _Valley | None]:
    """Valleys on the slopes at negative and positive v of a body with its ridge along x."""
    found: list[_Valley | None] = [None, None]
    if not body.turned:
        for other in home.bodies:
            if other.top is Top.RIDGED and other.turned and End.VALLEY in other.ends:
                c, e = other.half_across_m, other.eaves_m[0]
                side = 0 if other.y0_m < body.y0_m else 1
                wide = body.half_across_m + e
                middle = (other.x0_m + other.x1_m - body.x0_m - body.x1_m) / 2
                found[side] = _Valley(middle, c + e, (e + c) / wide)
    return found[0], found[1]


def _ridged(body: Body, valleys: tuple[_Valley | None, _Valley | None]) -> _Roof:
    """Two slopes with their ends, undersides and edges."""
    h = (body.y1_m - body.y0_m if body.turned else body.x1_m - body.x0_m) / 2
    c, s, t = body.half_across_m, body.slope, _THICKNESS_M
    # Turned by 90 degrees, +v points to -x.
    e_low, e_high = body.eaves_m[::-1] if body.turned else body.eaves_m
    ridge = body.eave_m + c * s
    ends = [_end(end, h, c, s, sign) for end, sign in zip(body.ends, (-1.0, 1.0), strict=True)]
    if all(end is End.HIP for end in body.ends) and h <= c + 0.15:
        ends = [(eave, -0.15 if k == 0 else 0.15) for k, (eave, _) in enumerate(ends)]
    roof = _Roof([], [], [])
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
        lip = min((over + _BEHIND_M) / wide, 0.9)
        for a, b in _eave_runs(left, right, valley):
            under = [at(b, 0.0, 0.0), at(a, 0.0, 0.0), at(a, lip, 0.0), at(b, lip, 0.0)]
            face = [at(a, 0.0, 0.0), at(b, 0.0, 0.0), at(b, 0.0, t), at(a, 0.0, t)]
            if over > 0.05:  # else it lies against a wall
                roof.thin.append(under if side < 0 else under[::-1])
                roof.thin.append(face if side < 0 else face[::-1])
        for k, sign in ((0, -1.0), (1, 1.0)):
            if body.ends[k] is End.GABLE:
                _verge(roof, at, edge(k, 0.0), sign * (h - _BEHIND_M), lip, side, sign, t)
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


def _cut_slope(edge, valley: _Valley | None) -> list[list[tuple[float, float]]]:  # type: ignore[no-untyped-def]
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


def _eave_runs(left: float, right: float, valley: _Valley | None) -> list[tuple[float, float]]:
    if valley is None:
        return [(left, right)]
    a, b = valley.middle_m - valley.half_m, valley.middle_m + valley.half_m
    return [(p, q) for p, q in ((left, a), (b, right)) if q - p > 0.05]


def _verge(roof: _Roof, at, u: float, back: float, lip: float, side: float, sign: float, t: float) -> None:  # type: ignore[no-untyped-def]
    """Edge and underside of a slope beyond a gable."""
    face = [at(u, 0.0, 0.0), at(u, 1.0, 0.0), at(u, 1.0, t), at(u, 0.0, t)]
    under = [at(u, 1.0, 0.0), at(u, lip, 0.0), at(back, lip, 0.0), at(back, 1.0, 0.0)]
    flip = side * sign > 0
    roof.thin.append(face[::-1] if flip else face)
    roof.thin.append(under[::-1] if flip else under)


def _hip_end(
    roof: _Roof, body: Body, end: tuple[float, float], over: float, ridge: float, sign: float
) -> None:
    """Triangle, edge and underside of a hip."""
    c, t = body.half_across_m, _THICKNESS_M
    low, foot = body.eave_m - over * body.slope, end[0] + sign * over
    wide = c + over
    apex = [end[1], 0.0, ridge + t]
    a, b = [foot, -sign * wide, low], [foot, sign * wide, low]
    lifted = [[p[0], p[1], p[2] + t] for p in (a, b)]
    roof.top.append([*lifted, apex, apex])
    roof.thin.append([a, b, lifted[1], lifted[0]])
    share = (over + _BEHIND_M) / wide
    inner = [
        [p[0] + share * (end[1] - p[0]), p[1] * (1 - share), low + share * (ridge - low)] for p in (a, b)
    ]
    roof.thin.append([b, a, inner[0], inner[1]])


def _shed(body: Body) -> _Roof:
    """One slope that rises towards +v; its own side walls' triangles."""
    size = (body.x1_m - body.x0_m, body.y1_m - body.y0_m)
    h, c = (size[1] / 2, size[0] / 2) if body.turned else (size[0] / 2, size[1] / 2)
    s, t = body.slope, _THICKNESS_M if body.role is not Role.SHELTER else 0.1
    over_low, over_high = (0.0 if e is End.WALL else 0.3 for e in body.ends)
    side = 0.25 if body.role is not Role.SHELTER else 0.12

    def at(u: float, v: float, lift: float) -> list[float]:
        return [u, v, body.eave_m + (v + c) * s + lift]

    u0, u1, v0, v1 = -h - side, h + side, -c - over_low, c + over_high
    corners = [(u0, v0), (u1, v0), (u1, v1), (u0, v1)]
    roof = _Roof([[at(u, v, t) for u, v in corners]], [], [])
    roof.thin += [
        [at(*a, 0.0), at(*b, 0.0), at(*b, t), at(*a, t)]
        for k, (a, b) in enumerate(zip(corners, [*corners[1:], corners[0]], strict=True))
        if not (k == 2 and body.ends[1] is End.WALL)
    ]
    if body.role is Role.SHELTER:
        roof.top.append([at(u, v, 0.0) for u, v in corners[::-1]])
        return roof
    b = _BEHIND_M
    inner = [(-h + b, -c + b), (h - b, -c + b), (h - b, c - b), (-h + b, c - b)]
    for k in range(3 if body.ends[1] is End.WALL else 4):
        k = (k + 3) % 4  # the higher side last
        p, q, q_in, p_in = corners[k], corners[(k + 1) % 4], inner[(k + 1) % 4], inner[k]
        roof.thin.append([at(*q, 0.0), at(*p, 0.0), at(*p_in, 0.0), at(*q_in, 0.0)])
    for u, sign in ((-h, -1.0), (h, 1.0)):
        foot, high = [u, -sign * c, body.eave_m], [u, sign * c, body.eave_m]
        apex = [u, c, body.eave_m + 2 * c * s]
        roof.gables.append([foot, high, apex, apex])
    return roof


def _flat(body: Body) -> _Roof:
    """A slab that projects a little on all sides but those against a wall (at the lower and the upper x)."""
    half_x, half_y = (body.x1_m - body.x0_m) / 2, (body.y1_m - body.y0_m) / 2
    thick = 0.25 if body.role is not Role.SHELTER else 0.14
    over = [0.0 if end is End.WALL else 0.2 for end in body.ends]
    u0, u1, v = -half_x - over[0], half_x + over[1], half_y + 0.2
    z, corners = body.eave_m, [(u0, -v), (u1, -v), (u1, v), (u0, v)]
    roof = _Roof([[[x, y, z + thick] for x, y in corners]], [], [])
    for k in range(4):
        (ax, ay), (bx, by) = corners[k], corners[(k + 1) % 4]
        roof.thin.append([[ax, ay, z], [bx, by, z], [bx, by, z + thick], [ax, ay, z + thick]])
    if body.role is Role.SHELTER:
        roof.top.append([[x, y, z] for x, y in corners[::-1]])
        return roof
    b = _BEHIND_M
    inner = [
        (-half_x + b, -half_y + b),
        (half_x - b, -half_y + b),
        (half_x - b, half_y - b),
        (-half_x + b, half_y - b),
    ]
    for k in range(4):
        p, q, q_in, p_in = corners[k], corners[(k + 1) % 4], inner[(k + 1) % 4], inner[k]
        roof.thin.append([[*q, z], [*p, z], [*p_in, z], [*q_in, z]])
    return roof
