"""A high-voltage line: lattice towers with three cross-arms, insulator strings and seven sagging wires."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.template import Template, place
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.fixtures.strands import prisms
from scenegen.parts.fixtures.wires import wires

HEIGHT_M = 38.0
"""Height of a tower of scale one."""

CORRIDOR_M = 13.0
"""Half the width of the strip that is kept free of trees."""

_BASE_M, _WAIST_M, _WAIST_Z, _FOOT_M = 3.1, 0.85, 20.0, 1.8
_ARMS = ((21.0, 6.2), (26.5, 7.6), (32.0, 5.4))
"""Height and reach of the cross-arms [m]."""

_STRING_M = 2.0
_LEG_M, _BRACE_M = 0.11, 0.055
_BANDS = (0.0, 12.0, 22.0, HEIGHT_M)


def draw_line(
    taken: shapely.Geometry, half_m: float, far_m: float, rng: np.random.Generator
) -> np.ndarray | None:
    """Feet of the towers (towers, 2) of a straight line that misses what is taken; None if none of the draws does."""
    for _ in range(60):
        heading, offset = rng.uniform(0.0, 2 * np.pi), rng.uniform(0.45, 1.0) * half_m
        span, shift = rng.uniform(210.0, 290.0), rng.uniform(0.0, 1.0)
        along = np.array([np.cos(heading), np.sin(heading)])
        middle = offset * np.array([-along[1], along[0]])
        mark = (np.arange(-40, 41) + shift) * span
        feet = middle + mark[:, None] * along
        feet = feet[np.abs(feet).max(axis=1) < far_m - 150.0]
        strip = shapely.LineString(feet).buffer(CORRIDOR_M)
        towers = shapely.union_all(shapely.buffer(shapely.points(feet), 6.0))
        if not taken.intersects(strip) and not taken.buffer(8.0).intersects(towers):
            return np.asarray(feet)
    return None


def build_pylons(feet: np.ndarray, shop: FieldWorkshop, rng: np.random.Generator) -> list[Part]:
    """Towers at the given feet and the wires between them."""
    step = feet[-1] - feet[0]
    heading = np.full(len(feet), np.arctan2(step[1], step[0]))
    steel, glass = shop.palette.pick("steel_galv_post", rng), shop.palette.pick("vehicle_glass", rng)
    cable = shop.palette.pick("cable_weathered", rng)
    position = np.column_stack([feet, shop.relief(feet)])
    size = rng.uniform(0.85, 1.1)
    owner = shop.builder.new_objects(len(feet)) + np.arange(len(feet))
    skins = np.tile([[steel, glass]], (len(feet), 1))
    parts = [place(lattice_tower(), position, heading, np.full((len(feet), 3), size), skins, owner)]
    slack = rng.uniform(0.022, 0.034)
    along = step / np.linalg.norm(step)
    left = np.array([-along[1], along[0], 0.0])
    hangs = [(side * reach, z - _STRING_M) for z, reach in _ARMS for side in (-1.0, 1.0)]
    for across, z in (*hangs, (0.0, HEIGHT_M)):
        hang = position + size * (across * left + np.array([0.0, 0.0, z]))
        span = np.linalg.norm(np.diff(hang, axis=0), axis=1)
        own = shop.builder.new_objects() + np.zeros(len(span), np.int64)
        sag = span * (slack if across else 0.7 * slack)
        parts.append(wires(hang[:-1], hang[1:], sag, 0.016, cable, int(Semantic.WIRE), own, chords=24))
    return parts


def lattice_tower() -> Template:
    """A tower for a line along x. Slots: 0 steel, 1 insulators. Eight lumped sites, by height and side."""
    model = Modeller()
    sites = [
        model.site(np.array([0.0, side * 0.5, z]), np.array([0.0, side, 0.0]), LUMP_STANDOFF_M)
        for z in (6.0, 17.0, 30.0)
        for side in (-1.0, 1.0)
    ]
    legs, braces = _members()
    for ends, radius in ((legs, _LEG_M), (braces, _BRACE_M)):
        vertices, faces = prisms(ends[:, 0], ends[:, 1], radius, sides=4)
        middle = ends.mean(axis=1)
        band = np.clip(np.searchsorted(_BANDS, middle[:, 2]) - 1, 0, 2)
        site = np.array(sites)[2 * band + (middle[:, 1] > 0.0)]
        model.mesh(vertices, faces, 0, Semantic.POLE, np.repeat(np.repeat(site, 8)[:, None], 3, axis=1))
    tips = np.array([[0.0, side * reach, z] for z, reach in _ARMS for side in (-1.0, 1.0)])
    vertices, faces = prisms(tips - np.array([0.0, 0.0, _STRING_M]), tips, 0.11, sides=6)
    for side, mine in ((-1.0, tips[:, 1] < 0.0), (1.0, tips[:, 1] > 0.0)):
        site_of = model.site(np.array([0.0, side * 6.5, 25.5]), np.array([0.0, side, 0.0]), LUMP_STANDOFF_M)
        chosen = np.flatnonzero(np.repeat(mine, 12))
        model.mesh(vertices, faces[chosen], 1, Semantic.POLE, np.full((len(chosen), 3), site_of))
    return model.finish()


def _half_width(z: np.ndarray) -> np.ndarray:
    """Half the side of the tower's square section at a height [m]."""
    return np.asarray(
        np.interp(z, [0.0, _WAIST_Z, 33.5, HEIGHT_M], [_BASE_M, _WAIST_M, _WAIST_M * 0.8, 0.05])
    )


def _members() -> tuple[np.ndarray, np.ndarray]:
    """Ends of legs and of everything thinner (members, 2, 3)."""
    level = [0.0]
    while level[-1] < 33.0:
        level.append(level[-1] + max(1.9 * float(_half_width(np.array(level[-1]))), 1.7))
    z = np.array([-_FOOT_M, *level[1:], HEIGHT_M])
    w = _half_width(z)
    corner = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    nodes = np.concatenate(
        [corner[None] * w[:, None, None], np.broadcast_to(z[:, None, None], (len(z), 4, 1))], axis=2
    )
    legs = np.stack([nodes[:-1], nodes[1:]], axis=2).reshape(-1, 2, 3)
    turned = np.roll(nodes, -1, axis=1)
    panels = slice(0, len(z) - 2)
    braces = [
        np.stack([nodes[panels], turned[1:-1]], axis=2).reshape(-1, 2, 3),
        np.stack([turned[panels], nodes[1:-1]], axis=2).reshape(-1, 2, 3),
        np.stack([nodes[1:-1], turned[1:-1]], axis=2).reshape(-1, 2, 3),
    ]
    return legs, np.concatenate([*braces, _arms()])


def _arms() -> np.ndarray:
    """Tapered lattice arms to both sides."""
    rows = []
    for z, reach in _ARMS:
        w = float(_half_width(np.array(z)))
        for side in (-1.0, 1.0):
            tip = [0.0, side * reach, z]
            low = [[x, side * w, z] for x in (-w, w)]
            high = [[x, side * w, z + 1.5] for x in (-w, w)]
            rows += [(p, tip) for p in (*low, *high)]
            for share in (0.25, 0.5, 0.75):
                below, above = (
                    ((1 - share) * np.array(p) + share * np.array(tip)).tolist() for p in (low, high)
                )
                rows += [(below[0], above[0]), (below[1], above[1]), (below[0], below[1])]
    return np.array(rows, np.float64)
