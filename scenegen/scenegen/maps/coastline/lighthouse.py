"""The lighthouse: a tapered tower with bands, door and windows, a gallery with railing, the lantern and its dome."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.template import Template, place
from scenegen.maps.coastline.layout import Layout
from scenegen.maps.coastline.revolve import revolve
from scenegen.maps.coastline.workshop import CoastWorkshop

WALL, BAND, GLASS, METAL, DOOR = 0, 1, 2, 3, 4
"""Surface slots of a lighthouse."""

_SINK_M = 0.8
_RAIL_M = 1.1


def lighthouse(height_m: float, foot_m: float, top_m: float, bands: int) -> Template:
    """A tower on z = 0, its door towards +x.

    Parameters
    ----------
    height_m : float
        Of the gallery's floor.
    foot_m, top_m : float
        Radius of the tower at foot and gallery.
    bands : int
        Painted bands; an even division of the tower.
    """
    model = Modeller()
    plinth = [(foot_m + 0.5, -_SINK_M), (foot_m + 0.5, 0.7), (foot_m + 0.05, 0.75)]
    revolve(model, plinth, (WALL, WALL), Semantic.WALL)
    pieces = 2 * bands + 1
    z = np.linspace(0.0, height_m, pieces + 1)
    share = (z / height_m) ** 0.85
    radius = foot_m + (top_m - foot_m) * share
    slots = [BAND if k % 2 else WALL for k in range(pieces)]
    revolve(model, list(zip(radius.tolist(), z.tolist(), strict=True)), slots, Semantic.WALL, sites=8)
    _openings(model, height_m, foot_m, top_m)
    _gallery(model, height_m, top_m)
    _lantern(model, height_m, top_m)
    return model.finish()


def _openings(model: Modeller, height_m: float, foot_m: float, top_m: float) -> None:
    """A door at the foot, windows up the stair on alternating sides; frames stand proud of the wall."""
    model.box((foot_m - 0.35, -0.75, 0.0), (foot_m + 0.12, 0.75, 2.6), WALL, Semantic.WALL)
    front = np.array(
        [
            [
                [foot_m + 0.14, -0.5, 0.1],
                [foot_m + 0.14, 0.5, 0.1],
                [foot_m + 0.14, 0.5, 2.3],
                [foot_m + 0.14, -0.5, 2.3],
            ]
        ]
    )
    model.quads(front, DOOR, Semantic.DOOR)
    for k, z in enumerate(np.arange(4.2, height_m - 2.0, 3.4)):
        r = foot_m + (top_m - foot_m) * (z / height_m) ** 0.85
        turn = (k % 3) * 2 * np.pi / 3
        c, s = np.cos(turn), np.sin(turn)
        spin = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        y, tall = 0.42, 1.1
        corner = np.array([[0, -y, z], [0, y, z], [0, y, z + tall], [0, -y, z + tall]])
        proud = corner + np.array([r + 0.06, 0, 0])
        deep = corner - np.array([0, 0, 0]) + np.array([r - 0.5, 0, 0])
        ring = [[a, (a + 1) % 4] for a in range(4)]
        sides = np.array([[deep[a], deep[b], proud[b], proud[a]] for a, b in ring])
        model.quads(sides @ spin, WALL, Semantic.WALL)
        inner = proud.copy()
        inner[:, 1] *= 0.86
        inner[:, 2] = np.where(inner[:, 2] > z + 0.5, z + tall - 0.08, z + 0.08)
        frame = np.array([[proud[a], proud[b], inner[b], inner[a]] for a, b in ring])
        model.quads(frame @ spin, WALL, Semantic.WALL)
        model.quads((inner[None] - np.array([0.04, 0, 0])) @ spin, GLASS, Semantic.WINDOW)


def _gallery(model: Modeller, height_m: float, top_m: float) -> None:
    """A corbelled floor around the lantern, with posts and three rails."""
    outer = top_m + 0.95
    floor = [(top_m, height_m - 0.6), (outer, height_m), (outer, height_m + 0.18), (0.3, height_m + 0.19)]
    revolve(model, floor, (WALL, METAL, METAL), Semantic.WALL)
    count, r = 14, outer - 0.07
    turn = 2 * np.pi * np.arange(count) / count
    foot = np.column_stack([r * np.cos(turn), r * np.sin(turn), np.full(count, height_m + 0.15)])
    after = np.roll(foot, -1, axis=0)
    up = np.array([0.0, 0.0, 1.0])
    for a, b in zip(foot, after, strict=True):
        model.tube(a, a + (_RAIL_M + 0.03) * up, 0.028, 0.028, METAL, Semantic.FENCE, sides=5)
        for rise in (0.4, 0.75, _RAIL_M):
            model.tube(a + rise * up, b + rise * up, 0.018, 0.018, METAL, Semantic.FENCE, sides=4)


def _lantern(model: Modeller, height_m: float, top_m: float) -> None:
    """Murette, panes between mullions, the lens behind them, dome, ball and lightning rod."""
    r, sides = 0.72 * top_m, 12
    z0, z1, z2 = height_m + 0.18, height_m + 1.1, height_m + 3.1
    revolve(model, [(r, z0), (r, z1)], (WALL,), Semantic.WALL)
    revolve(model, [(r, z1), (r, z2)], (GLASS,), Semantic.WINDOW, sides=sides)
    revolve(model, [(0.0, z1 - 0.2), (0.45, z1 - 0.2), (0.55, z1 + 0.8), (0.4, z1 + 1.7), (0.0, z1 + 1.7)],
            (METAL, METAL, METAL, METAL), Semantic.OTHER, sides=10, sites=3)  # fmt: skip
    for angle in 2 * np.pi * np.arange(sides) / sides:
        edge = np.array([(r + 0.02) * np.cos(angle), (r + 0.02) * np.sin(angle), 0.0])
        up = np.array([0.0, 0.0, 1.0])
        model.tube(edge + z1 * up, edge + z2 * up, 0.04, 0.04, METAL, Semantic.WALL, sides=4)
    dome = [
        (r + 0.3, z2),
        (r + 0.3, z2 + 0.12),
        (0.85 * r, z2 + 0.7),
        (0.5 * r, z2 + 1.15),
        (0.15, z2 + 1.35),
    ]
    revolve(model, dome, (METAL,) * 4, Semantic.ROOF, sides=sides * 2)
    revolve(
        model, [(0.15, z2 + 1.35), (0.28, z2 + 1.6), (0.02, z2 + 1.9)], (METAL, METAL), Semantic.ROOF, sides=8
    )
    model.tube(
        np.array([0, 0, z2 + 1.85]), np.array([0, 0, z2 + 3.6]), 0.03, 0.012, METAL, Semantic.POLE, sides=4
    )


def build_lighthouse(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> Part:
    """The world's lighthouse, one instance."""
    height, foot = rng.uniform(11.0, 24.0), rng.uniform(2.9, 3.9)
    template = lighthouse(height, foot, foot * rng.uniform(0.62, 0.75), int(rng.integers(1, 4)))
    names = ("stucco_render", "brick_red", "window_glass", "steel_painted", "timber_weathered")
    skins = np.array([[shop.palette.pick(name, rng) for name in names]], np.int64)
    inland = shop.coast.frame.heading_rad + 0.5 * np.pi
    owner = np.array([shop.builder.new_objects()])
    return place(template, layout.lighthouse[None], np.array([inland]), np.ones((1, 3)), skins, owner)
