"""What makes a house a home: chimneys with pots, dormers, posts and slabs of porches and carports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from scenegen.buildings.detached.body import Body, Home, Role, Top
from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.patch import patches
from scenegen.geometry.template import Template, place

SLAB_M = 0.1
"""Top of porch floors below the floor of the house [m]."""

_STACK_M = (0.95, 0.6)
_BELOW_RIDGE_M = 1.6
_POST_M = 0.14
_DORMER_FRONT_M, _DORMER_WALL_M, _DORMER_SLOPE = 0.8, 1.15, 0.75
"""From the wall line to a dormer's front; height of its front; slope of its roof."""
_DORMER_OUT_M, _DORMER_EAVES_M = 0.25, 0.18


def home_features(homes: Sequence[Home], rng: np.random.Generator) -> list[Part]:
    """All parts beyond walls and roofs."""
    return [*_chimneys(homes, rng), *_dormers(homes), *_posts(homes)]


def pierced(home: Home) -> list[shapely.Polygon]:
    """Rectangles of the plan where chimneys and dormers stand on the main roof."""
    body, found = home.bodies[0], []
    for x, y, _ in home.chimneys:
        a, b = _STACK_M[::-1] if body.turned else _STACK_M
        found.append(shapely.box(x - a / 2, y - b / 2, x + a / 2, y + b / 2))
    for along, side, width in home.dormers:
        a = width / 2 + _DORMER_EAVES_M
        depth = _DORMER_FRONT_M + _dormer_rise(width) / body.slope
        corners = np.array([[-a, 0.3, 0.0], [a, 0.3, 0.0], [a, depth, 0.0], [-a, depth, 0.0]])
        found.append(shapely.Polygon(_on_slope(corners, body, float(along), float(side))[:, :2]))
    return [shapely.Polygon(home.lot.world(shapely.get_coordinates(f)[:4])) for f in found]


def _dormer_rise(width: float) -> float:
    """From the foot of a dormer's front to its ridge [m]."""
    return _DORMER_WALL_M + width / 2 * _DORMER_SLOPE


def _stack(pots: int) -> Template:
    """A chimney of unit height with a cap and pots; the sites of its sides above the roof."""
    model = Modeller()
    model.box((-0.5, -0.5, 0.0), (0.5, 0.5, 0.92), 0, Semantic.CHIMNEY)
    model.box((-0.57, -0.6, 0.92), (0.57, 0.6, 1.0), 1, Semantic.CHIMNEY)
    for x in np.linspace(-0.25, 0.25, pots) if pots > 1 else (0.0,):
        model.tube(np.array([x, 0, 0.98]), np.array([x, 0, 1.16]), 0.13, 0.1, 2, Semantic.CHIMNEY, sides=7)
    stack = model.finish()
    sides = (np.abs(stack.site_normal[:, 2]) < 0.5) & (stack.site_standoff < LUMP_STANDOFF_M)
    position = stack.site_position.copy()
    position[sides, 2] = np.maximum(position[sides, 2], 0.8)
    return replace(stack, site_position=position)


def _chimneys(homes: Sequence[Home], rng: np.random.Generator) -> list[Part]:
    rows, skins, owner = [], [], []
    for home in homes:
        for x, y, top in home.chimneys:
            heading = home.lot.heading_rad + (0.5 * np.pi if home.bodies[0].turned else 0.0)
            rows.append(
                [*home.lot.world(np.array([[x, y]]))[0], home.floor_m + top - _BELOW_RIDGE_M, heading]
            )
            skins.append([home.style.stone, home.style.stone, home.style.roof])
            owner.append(home.object)
    table, pots = np.array(rows).reshape(-1, 4), rng.integers(1, 3, len(rows))
    parts = []
    for k in (1, 2):
        mine = np.flatnonzero(pots == k)
        size = np.tile([[*_STACK_M, _BELOW_RIDGE_M]], (len(mine), 1))
        surfaces = np.array(skins, np.int64).reshape(-1, 3)[mine]
        parts.append(
            place(_stack(k), table[mine, :3], table[mine, 3], size, surfaces, np.array(owner, np.int64)[mine])
        )
    return parts


def _dormers(homes: Sequence[Home]) -> list[Part]:
    """Small gabled houses with a window on the slopes of main roofs."""
    quads, skins, labels, owner = [], [], [], []
    for home in homes:
        body = home.bodies[0]
        for along, side, width in home.dormers:
            for corners, kind, label in _dormer(body, width):
                local = _on_slope(corners, body, float(along), float(side))
                xy = home.lot.world(local[:, :2])
                quads.append(np.column_stack([xy, local[:, 2] + home.floor_m]))
                skins.append(getattr(home.style, kind))
                labels.append(int(label))
                owner.append(home.object)
    corners = np.array(quads, np.float64).reshape(-1, 4, 3)
    skin, semantic = np.array(skins, np.int64), np.array(labels, np.int64)
    return [patches(corners, 9.0, skin, semantic, np.array(owner, np.int64))]


def _on_slope(points: np.ndarray, body: Body, along: float, side: float) -> np.ndarray:
    """From the frame of a dormer (u right, w into the roof, z above the eaves) to the frame of the lot."""
    middle = np.array([(body.x0_m + body.x1_m) / 2, (body.y0_m + body.y1_m) / 2])
    u, w = points[:, 0], points[:, 1]
    v = side * (body.half_across_m - w)  # measured from the ridge towards that side
    x = along - side * u
    xy = np.column_stack([-v, x]) if body.turned else np.column_stack([x, v])
    return np.column_stack([xy + middle, points[:, 2] + body.eave_m])


def _dormer(body: Body, width: float) -> list[tuple[np.ndarray, str, Semantic]]:
    """Quads of one dormer: front with a pane, cheeks, roof slopes that run back into the main slope."""
    s, a = body.slope, width / 2
    front = _DORMER_FRONT_M
    foot = front * s + 0.16
    head = foot + _DORMER_WALL_M
    peak = foot + _dormer_rise(width)
    out, over, b = _DORMER_OUT_M, _DORMER_EAVES_M, 0.16

    def back(z: float) -> float:
        return (z - 0.16) / s

    p = [(-a, foot), (a, foot), (a, head), (-a, head)]
    q = [(-a + b, foot + b), (a - b, foot + b), (a - b, head - b), (-a + b, head - b)]
    pieces: list[tuple[list[list[float]], str, Semantic]] = []
    for k in range(4):
        n = (k + 1) % 4
        frame = [
            [p[k][0], front, p[k][1]],
            [p[n][0], front, p[n][1]],
            [q[n][0], front, q[n][1]],
            [q[k][0], front, q[k][1]],
        ]
        pieces.append((frame, "gable", Semantic.WALL))
    pieces.append(([[x, front, z] for x, z in q], "glass", Semantic.WINDOW))
    pieces.append(
        ([[-a, front, head], [a, front, head], [0, front, peak], [0, front, peak]], "gable", Semantic.WALL)
    )
    tip = [back(head), head]
    pieces.append(([[a, front, foot], [a, *tip], [a, *tip], [a, front, head]], "gable", Semantic.WALL))
    pieces.append(([[-a, *tip], [-a, front, foot], [-a, front, head], [-a, *tip]], "gable", Semantic.WALL))
    low, t = head - over * _DORMER_SLOPE, 0.08
    for sign in (-1.0, 1.0):
        e = sign * (a + over)
        slope = [
            [0.0, front - out, peak + t], [0.0, back(peak + t), peak + t],
            [e, back(low + t), low + t], [e, front - out, low + t],
        ]  # fmt: skip
        pieces.append((slope if sign < 0 else slope[::-1], "roof", Semantic.ROOF))
        under = [[*p[:2], p[2] - t] for p in slope]
        under[1][1], under[2][1] = front, front
        pieces.append((under[::-1] if sign < 0 else under, "roof", Semantic.ROOF))
    return [(np.array(quad, np.float64), kind, label) for quad, kind, label in pieces]


def _posts(homes: Sequence[Home]) -> list[Part]:
    """Posts of porches and carports, and the floor slabs of porches."""
    posts, slabs = [], []
    for home in homes:
        main = home.bodies[0]
        for body in home.bodies:
            if body.role is not Role.SHELTER:
                continue
            porch = body.top is Top.SHED
            for x, y in _post_places(body, porch, main):
                posts.append((home, x, y, body.eave_m + 0.03))
            if porch:
                slabs.append((home, body))
    parts = []
    if posts:
        xy = np.array([home.lot.world(np.array([[x, y]]))[0] for home, x, y, _ in posts])
        size = np.tile([_POST_M, _POST_M], (len(posts), 1))
        high = np.array([h.floor_m + top for h, _, _, top in posts])
        parts.append(_upright([h for h, *_ in posts], xy, size, high, "timber", 0.6))
    if slabs:
        middle = [[(b.x0_m + b.x1_m) / 2, (b.y0_m + b.y1_m) / 2] for _, b in slabs]
        xy = np.array([h.lot.world(np.array([m]))[0] for (h, _), m in zip(slabs, middle, strict=True)])
        size = np.array([[b.x1_m - b.x0_m, b.y1_m - b.y0_m] for _, b in slabs])
        high = np.array([h.floor_m - SLAB_M for h, _ in slabs])
        parts.append(_upright([h for h, _ in slabs], xy, size, high, "stone", 0.97))
    return parts


def _post_places(body: Body, porch: bool, main: Body) -> list[tuple[float, float]]:
    """Along the free edges: the front of a porch, the far side of a carport."""
    inset = 0.15
    if porch:
        count = max(round((body.x1_m - body.x0_m) / 2.8), 1) + 1
        return [
            (float(x), body.y0_m + inset) for x in np.linspace(body.x0_m + inset, body.x1_m - inset, count)
        ]
    x = body.x1_m - inset if body.x0_m >= main.x1_m - 1e-6 else body.x0_m + inset
    return [(x, float(y)) for y in np.linspace(body.y0_m + inset, body.y1_m - inset, 3)]


def _upright(
    homes: Sequence[Home], xy: np.ndarray, size: np.ndarray, high: np.ndarray, skin: str, site_at: float
) -> Part:
    """Boxes from the foundation to a height; the sites of their sides lie at a share of it, above ground."""
    model = Modeller()
    model.box((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0), 0, Semantic.WALL)
    box = model.finish()
    position = box.site_position.copy()
    position[:4, 2] = site_at
    low = np.array([h.floor_m - h.foundation_m for h in homes])
    return place(
        replace(box, site_position=position),
        np.column_stack([xy, low]),
        np.array([h.lot.heading_rad for h in homes]),
        np.column_stack([size, high - low]),
        np.array([[getattr(h.style, skin)] for h in homes], np.int64),
        np.array([h.object for h in homes], np.int64),
    )
