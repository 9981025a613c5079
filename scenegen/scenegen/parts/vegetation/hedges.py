"""Clipped hedges along lines: a dense body and leaf sprays on its faces; they keep their leaves all year."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.template import Template, place
from scenegen.parts.vegetation.branches import unit
from scenegen.parts.vegetation.cards import FACES, sprays
from scenegen.parts.vegetation.lumps import thrice
from scenegen.parts.workshop import Workshop

_PIECE_M = 1.7
_FORMS = 3
_SPRAYS = 42
_FOOT = -0.05
_BODY = 0.70
_TURN_SHARE = 0.35


def hedges(
    line: Sequence[Float64[np.ndarray, "_ 2"]],
    height_m: float,
    width_m: float,
    shop: Workshop,
    rng: np.random.Generator,
    lift_m: float = 0.0,
) -> list[Part]:
    """Hedges along polylines, each with one instance id; about 60 triangles a metre, three sites every 1.7 m.

    Parameters
    ----------
    line : sequence of float64 (k, 2)
        Middle lines in the plan [m]; they follow the relief.
    height_m, width_m : float
    shop : Workshop
    rng : numpy.random.Generator
    lift_m : float
        Height of the ground they stand on above the relief (a kerb).
    """
    if not len(line):
        return []
    first = shop.builder.new_objects(len(line))
    pieces = [_pieces(points, width_m) for points in line]
    plan = np.concatenate([p for p, _ in pieces])
    owner = np.repeat(first + np.arange(len(line)), [len(p) for p, _ in pieces])
    if not len(plan):
        return []
    start, end = plan[:, 0], plan[:, 1]
    z = shop.relief(np.concatenate([start, end])) + lift_m
    z0, z1 = z[: len(start)], z[len(start) :]
    step = end - start
    length = np.linalg.norm(step, axis=1)
    slope = step * ((z1 - z0) / length**2)[:, None]
    skin_of_hedge = np.asarray(shop.palette.variants("tree_crown"), np.int64)
    skin = skin_of_hedge[rng.integers(0, len(skin_of_hedge), len(line))][owner - first]
    position = np.column_stack([start, z0])
    heading = np.arctan2(step[:, 1], step[:, 0])
    scale = np.column_stack([length, np.full(len(length), width_m), np.full(len(length), height_m)])
    parts = []
    for k, child in enumerate(rng.spawn(_FORMS)):
        mine = slice(k, None, _FORMS)
        if len(position[mine]):
            parts.append(place(hedge_piece(child), position[mine], heading[mine], scale[mine],
                               skin[mine, None], owner[mine], slope[mine]))  # fmt: skip
    return parts


def hedge_piece(rng: np.random.Generator) -> Template:
    """A piece of hedge from x = 0 to 1, half a unit to either side, of height 1; one slot, three sites."""
    model = Modeller()
    top = model.site(np.array([0.5, 0.0, 1.01]), np.array([0.0, 0.0, 1.0]), LUMP_STANDOFF_M)
    left = model.site(np.array([0.5, 0.51, 0.55]), np.array([0.0, 1.0, 0.15]), LUMP_STANDOFF_M)
    right = model.site(np.array([0.5, -0.51, 0.55]), np.array([0.0, -1.0, 0.15]), LUMP_STANDOFF_M)
    _body(model, top, left, right)
    side = rng.choice(3, _SPRAYS, p=[0.26, 0.37, 0.37])
    along, rise = rng.uniform(0.0, 1.0, _SPRAYS), rng.uniform(0.05, 0.97, _SPRAYS)
    out = 0.5 * _BODY * rng.uniform(0.85, 1.15, _SPRAYS)
    spread = rng.uniform(-0.40, 0.40, _SPRAYS)
    y = np.choose(side, [spread, out, -out])
    z = np.where(side == 0, 0.88 + 0.06 * rng.uniform(size=_SPRAYS), 0.92 * rise)
    outward = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.25], [0.0, -1.0, 0.25]])[side]
    spin = unit(rng.normal(size=(_SPRAYS, 3)))
    length = rng.uniform(0.20, 0.36, _SPRAYS)
    heading = unit(spin + 0.35 * outward)
    base = np.column_stack([along, y, z]) - 0.35 * length[:, None] * heading
    made = sprays(base, heading, outward + 0.7 * np.roll(spin, 1, axis=0), length, 1.2)
    vertices = np.clip(made.vertices, [-0.05, -0.5, 0.01], [1.05, 0.5, 1.0])
    site = np.repeat(np.array([top, left, right])[side], FACES)
    model.mesh(vertices, made.faces, 0, Semantic.SHRUB, thrice(site))
    return model.finish()


def _body(model: Modeller, top: int, left: int, right: int) -> None:
    """The dense inside, a box narrower at the top; its ends close the hedge."""
    w, v, h = 0.5 * _BODY, 0.42 * _BODY, 0.90
    low = np.array([[0, -w, _FOOT], [1, -w, _FOOT], [1, w, _FOOT], [0, w, _FOOT]], np.float64)
    high = np.array([[0, -v, h], [1, -v, h], [1, v, h], [0, v, h]], np.float64)
    quad = np.array([[4, 5, 6, 7], [2, 3, 7, 6], [0, 1, 5, 4], [3, 0, 4, 7], [1, 2, 6, 5]])
    site = np.repeat(np.array([top, left, right, left, right]), 2)
    faces = quad[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    corner_site = thrice(site)
    model.mesh(np.concatenate([low, high]), faces, 0, Semantic.SHRUB, corner_site)


def _pieces(
    points: Float64[np.ndarray, "points 2"], width_m: float
) -> tuple[Float64[np.ndarray, "pieces 2 2"], int]:
    """Straight pieces along a polyline; at corners they overlap a little so that no gap opens."""
    step = np.diff(points, axis=0)
    length = np.linalg.norm(step, axis=1)
    found = []
    for k in np.flatnonzero(length > 0.05):
        heading = step[k] / length[k]
        before = _TURN_SHARE * width_m if k > 0 else 0.0
        after = _TURN_SHARE * width_m if k < len(step) - 1 else 0.0
        count = max(1, round((length[k] + before + after) / _PIECE_M))
        mark = np.linspace(-before, length[k] + after, count + 1)
        place_of = points[k] + mark[:, None] * heading
        found.append(np.stack([place_of[:-1], place_of[1:]], axis=1))
    made = np.concatenate(found) if found else np.zeros((0, 2, 2))
    return made, len(made)
