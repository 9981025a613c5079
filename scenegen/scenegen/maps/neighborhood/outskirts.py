"""Beyond the detailed neighborhood: fields, woods, roads that lead out, and plain houses up to the horizon."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.placement import clear_of, first_come, rectangles
from scenegen.geometry.planar import Triangulation
from scenegen.geometry.relief import Relief
from scenegen.geometry.standing import draped
from scenegen.geometry.template import Template, place
from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, FAR_M, StreetPlan, road_lines
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.countryside import countryside
from scenegen.parts.vegetation.grove import grove

_BELOW_GROUND_M = 1.2
_CROWNS, _FULL_M = 6, 150.0
"""Crowns of a mass of trees; how far beyond the neighborhood it has all of them."""
_FINE_RING_M = 45.0
"""Width of the ring around the neighborhood in which the mesh is as fine as the relief."""


def far_regions(plan: StreetPlan, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Region]:
    """Land around; the first region covers everything."""
    grass = shop.palette.pick("grass_dry", rng)
    half = np.abs(plan.outline.bounds).max()
    count = 70
    angle, reach = rng.uniform(0, 2 * np.pi, count), half + 1700.0 * rng.uniform(0.0, 1.0, count) ** 1.3
    centre = np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None]
    length = rng.uniform(50.0, 110.0, count) * (reach / half)
    heading = rng.uniform(0, np.pi, count)
    fields = rectangles(centre, length, length * rng.uniform(0.4, 0.9, count), heading)
    roads = shapely.buffer(road_lines(plan.exits), CARRIAGEWAY_M / 2, cap_style="flat")
    land = shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M)
    paved = land.buffer(-20.0).difference(plan.outline)
    return countryside(land, grass, plan.outline.buffer(14.0), fields, roads, paved, shop, rng)


def lie_of(plane: Triangulation, plan: StreetPlan, relief: Relief) -> Relief:
    """Height of the ground as its mesh has it: near the neighborhood the relief, farther out a coarse mesh.

    Parameters
    ----------
    plane : Triangulation
        Of the ground.
    plan : StreetPlan
    relief : callable
    """
    near = shapely.convex_hull(plan.outline).buffer(_FINE_RING_M, quad_segs=4)
    shapely.prepare(near)
    corners = plane.points[plane.triangles]
    return draped(corners[~shapely.contains_xy(near, corners.mean(axis=1))], relief)


def far_objects(
    plan: StreetPlan, lie: Relief, shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Plain houses in hamlets, barns, groves and woods; they thin out with distance.

    Parameters
    ----------
    plan : StreetPlan
    lie : callable
        Height of the ground there [m].
    shop : NeighborhoodWorkshop
    rng : numpy.random.Generator
    """
    shop = replace(shop, relief=lie)
    half = float(np.abs(plan.outline.bounds).max())
    count = 1150
    angle = rng.uniform(0.0, 2 * np.pi, count)
    reach = half * 0.8 + 1800.0 * rng.uniform(0.0, 1.0, count) ** 1.6
    centre = np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None]
    hamlets = rng.uniform(-1.0, 1.0, (9, 2)) * 1500.0
    near = np.linalg.norm(centre[:, None] - hamlets[None], axis=2).min(axis=1)
    built = rng.uniform(size=count) < np.where(near < 260.0, 0.85, 0.12)
    heading = 0.5 * np.pi * rng.integers(0, 2, count) + 0.6 * np.sin(2 * angle) + rng.normal(0, 0.1, count)
    length = np.where(built, rng.uniform(9.0, 17.0, count), rng.uniform(14.0, 44.0, count))
    width = np.where(built, rng.uniform(8.0, 11.0, count), length * rng.uniform(0.5, 1.0, count))
    shapes = rectangles(centre, length + 4.0, width + 4.0, heading)
    roads = shapely.buffer(road_lines(plan.exits), CARRIAGEWAY_M / 2 + 3.0, cap_style="flat")
    keep = clear_of(shapes, np.array([plan.outline.buffer(6.0), *roads], dtype=object)) & first_come(shapes)
    houses, woods = keep & built, keep & ~built
    size = np.column_stack([length, width, rng.uniform(3.0, 6.0, count)])
    return [
        _plain_houses(centre[houses], size[houses], heading[houses], shop, rng),
        *_groves(centre[woods], length[woods], half + _FULL_M, shop, rng),
    ]


def _plain_house() -> Template:
    """A unit box with a gable roof. Slots: walls, roof."""
    model = Modeller()
    a, e, r, o = 0.5, 1.0, 1.55, 0.56
    sides = [
        [[-a, -a, 0], [a, -a, 0], [a, -a, e], [-a, -a, e]], [[a, a, 0], [-a, a, 0], [-a, a, e], [a, a, e]],
        [[a, -a, 0], [a, a, 0], [a, a, e], [a, -a, e]], [[-a, a, 0], [-a, -a, 0], [-a, -a, e], [-a, a, e]],
        [[a, -a, e], [a, a, e], [a, 0, r], [a, 0, r]], [[-a, a, e], [-a, -a, e], [-a, 0, r], [-a, 0, r]],
    ]  # fmt: skip
    model.quads(np.array(sides, np.float64), 0, Semantic.WALL)
    low = r - (r - e) * o / a
    slopes = [
        [[-o, -o, low], [o, -o, low], [o, 0, r], [-o, 0, r]], [[o, o, low], [-o, o, low], [-o, 0, r], [o, 0, r]],
    ]  # fmt: skip
    model.quads(np.array(slopes, np.float64) + np.array([0, 0, 0.03]), 1, Semantic.ROOF)
    return model.finish()


def _plain_houses(
    centre: np.ndarray,
    size: np.ndarray,
    heading: np.ndarray,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> Part:
    walls, roofs = ("stucco_render", "brick_red", "wood_siding"), ("clay_roof_tile", "asphalt_shingle")
    count = len(centre)
    wall = [shop.palette.pick(walls[int(k)], rng) for k in rng.integers(0, 3, count)]
    roof = [shop.palette.pick(roofs[int(k)], rng) for k in rng.integers(0, 2, count)]
    skins = np.column_stack([np.array(wall, np.int64), np.array(roof, np.int64)])
    base = np.column_stack([centre, shop.relief(centre) - _BELOW_GROUND_M])
    template = _plain_house()
    lifted = template.site_position.copy()
    lifted[:4, 2] = 0.62  # above the ground on any slope
    owner = shop.builder.new_objects(count) + np.arange(count)
    scale = size + np.array([0.0, 0.0, _BELOW_GROUND_M])
    return place(replace(template, site_position=lifted), base, heading, scale, skins, owner)


def _groves(
    centre: np.ndarray,
    width: np.ndarray,
    full_m: float,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> list[Part]:
    """Masses of trees; those farther from the origin than `full_m` have half the crowns: rays graze dozens."""
    count = len(centre)
    skin = np.array([[shop.palette.pick("tree_crown", rng)] for _ in range(count)], np.int64).reshape(-1, 1)
    scale = np.column_stack([width, width, rng.uniform(8.0, 15.0, count)])
    position = np.column_stack([centre, shop.relief(centre)])
    owner = shop.builder.new_objects(count) + np.arange(count)
    heading = rng.uniform(0.0, 2 * np.pi, count)
    near = np.linalg.norm(centre, axis=1) < full_m
    return [
        place(grove(rng, crowns), position[k], heading[k], scale[k], skin[k], owner[k])
        for crowns, k in ((_CROWNS, near), (_CROWNS // 2, ~near))
    ]
