"""Roofs of detached houses: ridges with gables, hips and valleys, sheds, and flat slabs, as lattices.

Each roof is drawn in its own frame (u along the ridge, v across, z above the floor) and then moved to the world. A
slope that another roof runs into is cut along the valleys, so that no part of it lies hidden.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scenegen.buildings.detached.body import Body, End, Home, Role, Top
from scenegen.buildings.detached.features import pierced
from scenegen.buildings.detached.ridged import BEHIND_M, THICKNESS_M, RoofQuads, Valley, ridged
from scenegen.classes import Semantic
from scenegen.geometry.hidden import push_out
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.patch import patches

_SPACING_M, _THIN_SPACING_M = 2.9, 6.0
_CLEAR_M = 0.3


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


def _roof(body: Body, home: Home) -> RoofQuads:
    if body.top is Top.FLAT:
        return _flat(body)
    if body.top is Top.SHED:
        return _shed(body)
    return ridged(body, _valleys(body, home))


def _valleys(body: Body, home: Home) -> tuple[Valley | None, Valley | None]:
    """Valleys on the slopes at negative and positive v of a body with its ridge along x."""
    found: list[Valley | None] = [None, None]
    if not body.turned:
        for other in home.bodies:
            if other.top is Top.RIDGED and other.turned and End.VALLEY in other.ends:
                c, e = other.half_across_m, other.eaves_m[0]
                side = 0 if other.y0_m < body.y0_m else 1
                wide = body.half_across_m + e
                middle = (other.x0_m + other.x1_m - body.x0_m - body.x1_m) / 2
                found[side] = Valley(middle, c + e, (e + c) / wide)
    return found[0], found[1]


def _shed(body: Body) -> RoofQuads:
    """One slope that rises towards +v; its own side walls' triangles."""
    size = (body.x1_m - body.x0_m, body.y1_m - body.y0_m)
    h, c = (size[1] / 2, size[0] / 2) if body.turned else (size[0] / 2, size[1] / 2)
    s, t = body.slope, THICKNESS_M if body.role is not Role.SHELTER else 0.1
    over_low, over_high = (0.0 if e is End.WALL else 0.3 for e in body.ends)
    side = 0.25 if body.role is not Role.SHELTER else 0.12

    def at(u: float, v: float, lift: float) -> list[float]:
        return [u, v, body.eave_m + (v + c) * s + lift]

    u0, u1, v0, v1 = -h - side, h + side, -c - over_low, c + over_high
    corners = [(u0, v0), (u1, v0), (u1, v1), (u0, v1)]
    roof = RoofQuads([[at(u, v, t) for u, v in corners]], [], [])
    roof.thin += [
        [at(*a, 0.0), at(*b, 0.0), at(*b, t), at(*a, t)]
        for k, (a, b) in enumerate(zip(corners, [*corners[1:], corners[0]], strict=True))
        if not (k == 2 and body.ends[1] is End.WALL)
    ]
    if body.role is Role.SHELTER:
        roof.top.append([at(u, v, 0.0) for u, v in corners[::-1]])
        return roof
    b = BEHIND_M
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


def _flat(body: Body) -> RoofQuads:
    """A slab that projects a little on all sides but those against a wall (at the lower and the upper x)."""
    half_x, half_y = (body.x1_m - body.x0_m) / 2, (body.y1_m - body.y0_m) / 2
    thick = 0.25 if body.role is not Role.SHELTER else 0.14
    over = [0.0 if end is End.WALL else 0.2 for end in body.ends]
    u0, u1, v = -half_x - over[0], half_x + over[1], half_y + 0.2
    z, corners = body.eave_m, [(u0, -v), (u1, -v), (u1, v), (u0, v)]
    roof = RoofQuads([[[x, y, z + thick] for x, y in corners]], [], [])
    for k in range(4):
        (ax, ay), (bx, by) = corners[k], corners[(k + 1) % 4]
        roof.thin.append([[ax, ay, z], [bx, by, z], [bx, by, z + thick], [ax, ay, z + thick]])
    if body.role is Role.SHELTER:
        roof.top.append([[x, y, z] for x, y in corners[::-1]])
        return roof
    b = BEHIND_M
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
