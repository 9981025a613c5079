"""Goals with nets, corner flags, dugouts and benches of a pitch."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.template import Template, place
from scenegen.maps.field.grounds import Pitch
from scenegen.maps.field.pitch import GOAL_HEIGHT_M, GOAL_WIDTH_M, LINE_M
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.fixtures.erect import erect
from scenegen.parts.fixtures.nets import net

_TOP_DEPTH_M, _FOOT_DEPTH_M = 0.9, 2.0
_MESH_M, _CORD_M = 0.12, 0.003


def build_goals(pitch: Pitch, shop: FieldWorkshop, rng: np.random.Generator) -> list[Part]:
    """Two goals, each one instance with its net."""
    white = shop.palette.special("steel_painted", "white", solar_absorptance=0.32)
    mesh = shop.palette.pick("netting_polymer", rng)
    parts = []
    for side, turn in ((1.0, 0.0), (-1.0, np.pi)):
        owner = shop.builder.new_objects()
        frame = pitch.frame.at(side * (pitch.length_m / 2 - LINE_M / 2), 0.0, turn)
        foot = np.array([[frame.x_m, frame.y_m, float(shop.relief(np.array([[frame.x_m, frame.y_m]]))[0])]])
        heading, skin, own = np.array([frame.heading_rad]), np.array([[white]]), np.array([owner])
        posts = place(goal_frame(), foot, heading, np.ones((1, 3)), skin, own)
        panels = _net_panels()
        flat = panels.reshape(-1, 3)
        world = np.column_stack([frame.world(flat[:, :2]), flat[:, 2] + foot[0, 2]]).reshape(-1, 4, 3)
        owners = np.full(len(world), owner)
        slack = rng.uniform(0.02, 0.14)
        cords = [
            net(world[k : k + 1], _MESH_M, _CORD_M, mesh, int(Semantic.GOAL), owners[:1], s, 3 if s else 1)
            for k, s in enumerate((0.0, slack, 0.5 * slack, 0.5 * slack))
        ]
        parts.append(concatenate([posts, *cords]))
    return parts


def goal_frame() -> Template:
    """Posts, bar and the stanchions behind: the middle of the goal line at the origin, the net towards +x.

    Posts and bar are as thick as the line; 7.32 m lie between the posts and 2.44 m below the bar.
    """
    model, r = Modeller(), LINE_M / 2
    y, z = GOAL_WIDTH_M / 2 + r, GOAL_HEIGHT_M + r
    for side in (-y, y):
        foot, top = np.array([0.0, side, -0.1]), np.array([0.0, side, z])
        model.tube(foot, top, r, r, 0, Semantic.GOAL, sides=10, sites=2)
        behind, far = np.array([_TOP_DEPTH_M, side, z]), np.array([_FOOT_DEPTH_M, side, 0.02])
        model.tube(top, behind, 0.02, 0.02, 0, Semantic.GOAL, sides=5)
        model.tube(behind, far, 0.02, 0.02, 0, Semantic.GOAL, sides=5)
    bar = np.array([[0.0, -y, z], [0.0, y, z]])
    model.tube(bar[0], bar[1], r, r, 0, Semantic.GOAL, sides=10, sites=2)
    ground = bar + np.array([_FOOT_DEPTH_M, 0.0, 0.02 - z])
    model.tube(ground[0], ground[1], 0.02, 0.02, 0, Semantic.GOAL, sides=5)
    return model.finish()


def _net_panels() -> np.ndarray:
    """Roof, back and two sides of the net (4, 4, 3) in the frame of the goal; fronts look outwards."""
    y, z = GOAL_WIDTH_M / 2 + LINE_M / 2, GOAL_HEIGHT_M + LINE_M / 2
    a, b = _TOP_DEPTH_M, _FOOT_DEPTH_M
    roof = [[0.02, -y, z], [a, -y, z], [a, y, z], [0.02, y, z]]
    back = [[b, -y, 0.03], [b, y, 0.03], [a, y, z], [a, -y, z]]
    right = [[0.02, -y, 0.03], [b, -y, 0.03], [a, -y, z], [0.02, -y, z]]
    left = [[b, y, 0.03], [0.02, y, 0.03], [0.02, y, z], [a, y, z]]
    return np.array([roof, back, right, left])


def corner_flag() -> Template:
    """A post of 1.5 m with a small flag. Slots: 0 post, 1 cloth."""
    model = Modeller()
    model.tube(
        np.array([0, 0, -0.08]), np.array([0, 0, 1.5]), 0.018, 0.018, 0, Semantic.POLE, sides=6, sites=2
    )
    flag = np.array([[0.018, 0.0, 1.48], [0.42, 0.05, 1.33], [0.018, 0.0, 1.18]])
    for side, turn in ((1.0, 1), (-1.0, -1)):
        site = model.site(flag.mean(axis=0), np.array([0.0, -side, 0.0]))
        shifted = flag + np.array([0.0, -0.003 * side, 0.0])
        model.mesh(shifted, np.array([[2, 1, 0]])[:, ::turn], 1, Semantic.OTHER, np.full((1, 3), site))
    return model.finish()


def build_corner_flags(pitch: Pitch, shop: FieldWorkshop, rng: np.random.Generator) -> Part:
    """Four flags, blown the same way."""
    a, b = pitch.length_m / 2, pitch.width_m / 2
    xy = pitch.frame.world(np.array([[-a, -b], [a, -b], [a, b], [-a, b]]))
    position = np.column_stack([xy, shop.relief(xy)])
    skins = np.array([[shop.palette.only("plastic_dark"), shop.palette.only("sailcloth")]]).repeat(4, axis=0)
    heading = np.full(4, rng.uniform(0.0, 2 * np.pi))
    owner = shop.builder.new_objects(4) + np.arange(4)
    return place(corner_flag(), position, heading, np.ones((4, 3)), skins, owner)


def build_benches(pitch: Pitch, track: bool, shop: FieldWorkshop, rng: np.random.Generator) -> list[Part]:
    """Two dugouts on one touch line, or benches where a track leaves no room."""
    kind = "bench" if track else "bus_shelter"
    y = pitch.width_m / 2 + (0.75 if track else 2.3)
    x = np.array([-13.0, 13.0]) if not track else np.array([-13.0, -10.8, 10.8, 13.0])
    side = -1.0 if pitch.main else 1.0
    xy = pitch.frame.world(np.column_stack([x, np.full(len(x), side * y)]))
    position = np.column_stack([xy, shop.relief(xy)])
    heading = pitch.frame.heading_rad + (0.0 if side > 0 else np.pi)
    return erect(kind, position, np.full(len(x), heading), shop, rng)
