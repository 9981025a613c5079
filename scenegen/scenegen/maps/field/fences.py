"""Fences of the grounds: chain-link around everything, rails around the main field, nets behind the goals."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.part import Part, concatenate
from scenegen.maps.field.country import Country
from scenegen.maps.field.frame import Plot
from scenegen.maps.field.grounds import Grounds, Pitch
from scenegen.maps.field.track import LANE_M, LANES, RADIUS_M, oval
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.fixtures.fences import fence
from scenegen.parts.fixtures.nets import net
from scenegen.parts.fixtures.strands import prisms, two_sided

_BARRIER_M, _GATE_M = 1.1, 3.4
_NET_HALF_M, _POLE_PITCH_M, _MESH_M, _CORD_M = 20.0, 5.0, 0.145, 0.003


def build_fences(
    grounds: Grounds, country: Country, shop: FieldWorkshop, rng: np.random.Generator
) -> list[Part]:
    """All fences and ball-catching nets."""
    height, tall = rng.uniform(*shop.knobs.fence_height_m), rng.uniform(*shop.knobs.net_height_m)
    gate = shapely.LineString(grounds.access).buffer(_GATE_M)
    parts = []
    for line in shapely.get_parts(shapely.line_merge(grounds.outline.exterior.difference(gate))):
        parts += fence(shapely.get_coordinates(line), "chain_link", height, shop, rng)
    for line in _barrier(grounds):
        parts += fence(shapely.get_coordinates(line), "rail", _BARRIER_M, shop, rng)
    for line in _farm_fence(country):
        parts += fence(shapely.get_coordinates(line), "rail", 1.25, shop, rng)
    for pitch in grounds.pitches:
        if not (pitch.main and grounds.track):
            parts += [_ball_net(pitch, side, tall, shop, rng) for side in (-1.0, 1.0)]
    return parts


def _barrier(grounds: Grounds) -> list[shapely.LineString]:
    """Around the main field, open at the halfway line and at both ends."""
    if grounds.track:
        ring = shapely.Polygon(grounds.frame.world(oval(RADIUS_M + LANES * LANE_M + 0.9)))
    else:
        ring = Plot(grounds.frame, grounds.half_m[0] - 0.3, grounds.half_m[1] - 0.3).outline()
    reach = max(grounds.half_m) + 5.0
    gates = [grounds.frame.box(-1.3, -reach, 1.3, 0.0), grounds.frame.box(-reach, -1.3, reach, 1.3)]
    pieces = shapely.line_merge(ring.exterior.difference(shapely.union_all(gates)))
    return [p for p in shapely.get_parts(pieces) if p.length > 2.0]


def _farm_fence(country: Country) -> list[shapely.LineString]:
    """Rails around a paddock beside the farmyard."""
    yard = country.farm.yard
    paddock = yard.frame.box(yard.half_x_m + 2.0, -yard.half_y_m, yard.half_x_m + 30.0, yard.half_y_m - 6.0)
    return [shapely.LineString(paddock.exterior)]


def _ball_net(
    pitch: Pitch, side: float, height_m: float, shop: FieldWorkshop, rng: np.random.Generator
) -> Part:
    """A net on poles behind a goal, one instance."""
    cord, steel = shop.palette.pick("netting_polymer", rng), shop.palette.pick("steel_galv_post", rng)
    x = side * (pitch.length_m / 2 + pitch.margin_m - 0.8)
    y = np.linspace(-_NET_HALF_M, _NET_HALF_M, round(2 * _NET_HALF_M / _POLE_PITCH_M) + 1)
    xy = pitch.frame.world(np.column_stack([np.full(len(y), x), y]))
    foot = np.column_stack([xy, shop.relief(xy)])
    top = foot + np.array([0.0, 0.0, height_m])
    low = foot + np.array([0.0, 0.0, 0.05])
    panels = np.stack([low[:-1], low[1:], top[1:], top[:-1]], axis=1)
    owner = shop.builder.new_objects()
    fence_id = int(Semantic.FENCE)
    mesh = net(panels, _MESH_M, _CORD_M, cord, fence_id, np.full(len(panels), owner), 0.1, 2)
    poles, pole_faces = prisms(
        foot - np.array([0.0, 0.0, 0.3]), top + np.array([0.0, 0.0, 0.1]), 0.055, sides=8
    )
    rope, rope_faces = prisms(top[:-1], top[1:], 0.012, sides=4)
    pole = np.repeat(np.arange(len(foot)), 16)
    rope_of = np.repeat(np.arange(len(foot) - 1), 8)
    facing = np.tile([np.cos(pitch.frame.heading_rad), np.sin(pitch.frame.heading_rad), 0.0], (len(foot), 1))
    frame = two_sided(
        np.concatenate([poles, rope]),
        np.concatenate([pole_faces, rope_faces + len(poles)]),
        np.concatenate([pole, rope_of]),
        0.5 * (foot + top),
        facing,
        steel,
        fence_id,
        np.full(len(foot), owner),
        reach_m=0.06,
    )
    return concatenate([mesh, frame])
