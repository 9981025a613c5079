"""Beyond the detailed square: woods, tree lines along boundaries, farmsteads and hamlets, up to the horizon."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.placement import clear_of, first_come, rectangles
from scenegen.geometry.scatter import hexagonal
from scenegen.geometry.template import Template, place
from scenegen.maps.field.country import FAR_M, ROAD_HALF_M, Country, Cover
from scenegen.maps.field.thicket import thicket
from scenegen.maps.field.workshop import FieldWorkshop
from scenegen.parts.vegetation.foliage import leaf_fraction

_WALLS = ("stucco_render", "brick_red", "stucco_render", "wood_siding")
_ROOFS = ("clay_roof_tile", "clay_roof_tile", "slate_roof", "metal_roof_painted_mid")
_FINE_M = 480.0
_DECIDUOUS = 0.7
_BEYOND_M, _EDGE_M = 42.0, 230.0
_CELLS_M = ((250.0, 600.0, 1200.0, 2200.0), (4.0, 16.0, 38.0, 60.0))
"""About half the size of the ground's triangles [m] at distances from the origin [m]."""
_LEVELS_M = (0.0, 450.0, 700.0, 1100.0, 1700.0, 1e9)


def far_objects(
    country: Country, nearer: np.ndarray, half_m: float, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[list[Part], int, int]:
    """Woods, tree lines and farms outside the detailed square.

    Parameters
    ----------
    country : Country
    nearer : float64 (places, 4)
        x, y, diameter, height of masses of trees inside the square.
    half_m : float
        Half the side of the detailed square.
    shop : FieldWorkshop
    rng : numpy.random.Generator

    Returns
    -------
    parts : list of Part
    groves, houses : int
        Numbers of masses of trees and of farm buildings.
    """
    near = shapely.box(-half_m, -half_m, half_m, half_m).buffer(_BEYOND_M, join_style="mitre")
    houses, plan = _farms(country, near, shop, rng)
    spots = np.concatenate([_woods(country, rng), _lines(country, shop, rng)])
    crowns = shapely.buffer(shapely.points(spots[:, :2]), 0.33 * spots[:, 2], quad_segs=3)
    taken = np.array([near, country.carriageway.buffer(1.0), country.corridor, *plan], dtype=object)
    keep = clear_of(crowns, taken, 1.0) & (np.abs(spots[:, :2]).max(axis=1) < FAR_M - _EDGE_M)
    spots = np.concatenate([nearer, spots[keep]])
    spots = spots[first_come(shapely.buffer(shapely.points(spots[:, :2]), 0.33 * spots[:, 2], quad_segs=3))]
    return [*_groves(spots, shop, rng), *houses], len(spots), len(plan)


def _pitch_m(reach: np.ndarray | float) -> np.ndarray:
    """Distance between masses of trees [m]: coarser with distance, as one sees it."""
    return np.asarray(17.0 + 0.026 * np.asarray(reach))


def _woods(country: Country, rng: np.random.Generator) -> np.ndarray:
    """Masses of trees over all wood parcels: x, y, diameter, height."""
    woods = shapely.union_all([p.outline for p in country.parcels if p.cover is Cover.WOOD])
    if woods.is_empty:
        return np.zeros((0, 4))
    shapely.prepare(woods)
    rows = [np.zeros((0, 4))]
    for low, high in pairwise(_LEVELS_M):
        reach = min(high, FAR_M)
        pitch = float(_pitch_m(0.5 * (low + reach)))
        xy = hexagonal(-reach, -reach, reach, reach, pitch, rng, 0.3)
        far = np.abs(xy).max(axis=1)
        xy = xy[(far >= low) & (far < reach) & shapely.contains_xy(woods, xy)]
        size = pitch * rng.uniform(1.1, 1.45, len(xy))
        rows.append(np.column_stack([xy, size, rng.uniform(10.0, 19.0, len(xy))]))
    return np.concatenate(rows)


def _lines(country: Country, shop: FieldWorkshop, rng: np.random.Generator) -> np.ndarray:
    """Rows of trees and bushes along chosen boundaries, gaps included: x, y, diameter, height."""
    share = rng.uniform(*shop.knobs.hedge_share)
    rows = [np.zeros((0, 4))]
    for line in country.boundaries:
        if rng.uniform() > share or len(line) < 2:
            continue
        path = shapely.LineString(line)
        reach = float(np.linalg.norm(line, axis=1).mean())
        pitch = float(_pitch_m(reach)) * rng.uniform(0.6, 1.6)
        mark = np.arange(4.0, path.length - 4.0, pitch)
        mark = mark[rng.uniform(size=len(mark)) < rng.uniform(0.5, 1.0)]
        xy = shapely.get_coordinates(shapely.line_interpolate_point(path, mark))
        tall = rng.uniform(3.0, 14.0) * rng.uniform(0.7, 1.2, len(xy))
        rows.append(np.column_stack([xy, np.clip(1.3 * tall, 5.0, 1.3 * pitch), tall]))
    return np.concatenate(rows)


def _groves(spots: np.ndarray, shop: FieldWorkshop, rng: np.random.Generator) -> list[Part]:
    """Masses of trees, finer ones nearby; in winter most are bare twigs, which warm and cool as bark does."""
    leaves, bark = (np.array(shop.palette.variants(name)) for name in ("tree_crown", "bark_trunk"))
    skin = leaves[rng.integers(len(leaves), size=len(spots))]
    wood = bark[rng.integers(len(bark), size=len(spots))]
    bare = rng.uniform(size=len(spots)) < _DECIDUOUS * (1.0 - leaf_fraction(shop.season))
    skin = np.where(bare, wood, skin)[:, None]
    position = np.column_stack([spots[:, :2], _on_mesh(spots[:, :2], shop)])
    scale, heading = spots[:, [2, 2, 3]], rng.uniform(0.0, 2 * np.pi, len(spots))
    owner = shop.builder.new_objects(len(spots)) + np.arange(len(spots))
    near = np.linalg.norm(spots[:, :2], axis=1) < _FINE_M
    return [
        place(thicket(rng, fine), position[k], heading[k], scale[k], skin[k], owner[k])
        for fine, k in ((True, near), (False, ~near))
    ]


def _on_mesh(xy: np.ndarray, shop: FieldWorkshop) -> np.ndarray:
    """Height [m] of the ground's mesh or just below: its coarse triangles cut across hilltops far away."""
    reach = np.interp(np.linalg.norm(xy, axis=1), *_CELLS_M)[:, None]
    angle = 2 * np.pi * np.arange(6) / 6
    around = [shop.relief(xy + reach * np.array([np.cos(a), np.sin(a)])) for a in angle]
    return np.asarray(np.minimum(shop.relief(xy), np.mean(around, axis=0)))


def _farms(
    country: Country, near: shapely.Polygon, shop: FieldWorkshop, rng: np.random.Generator
) -> tuple[list[Part], np.ndarray]:
    """Clusters of gabled buildings, some of them hamlets with a church; their plans."""
    count = round(rng.uniform(*shop.knobs.farms))
    angle, reach = rng.uniform(0.0, 2 * np.pi, count), 300.0 + 1900.0 * rng.uniform(0.0, 1.0, count) ** 1.3
    middle = np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None]
    size = np.where(rng.uniform(size=count) < 0.25, rng.integers(8, 22, count), rng.integers(2, 6, count))
    farm = np.repeat(np.arange(count), size)
    total = len(farm)
    spread = 11.0 * np.sqrt(size[farm])[:, None]
    xy = middle[farm] + rng.normal(size=(total, 2)) * spread
    barn = rng.uniform(size=total) < np.where(size[farm] < 7, 0.55, 0.15)
    length = np.where(barn, rng.uniform(18.0, 40.0, total), rng.uniform(9.0, 15.0, total))
    width = np.where(barn, rng.uniform(10.0, 18.0, total), rng.uniform(7.5, 10.0, total))
    heading = rng.uniform(0.0, np.pi, count)[farm] + 0.5 * np.pi * rng.integers(0, 2, total)
    shapes = rectangles(xy, length + 3.0, width + 3.0, heading)
    taken = np.array([near, country.carriageway.buffer(ROAD_HALF_M), country.corridor], dtype=object)
    keep = clear_of(shapes, taken, 2.0) & first_come(shapes) & (np.abs(xy).max(axis=1) < FAR_M - 40.0)
    xy, length, width, heading, barn = xy[keep], length[keep], width[keep], heading[keep], barn[keep]
    wall = [shop.palette.pick(_WALLS[int(k)], rng) for k in rng.integers(0, 4, len(xy))]
    roof = [shop.palette.pick(_ROOFS[int(k)], rng) for k in rng.integers(0, 4, len(xy))]
    height = np.where(barn, rng.uniform(5.0, 9.0, len(xy)), rng.uniform(5.5, 10.0, len(xy)))
    base = np.column_stack([xy, _on_mesh(xy, shop) - 1.2])
    owner = shop.builder.new_objects(len(xy)) + np.arange(len(xy))
    scale = np.column_stack([length, width, height + 1.2])
    part = place(gabled(), base, heading, scale, np.column_stack([wall, roof]).astype(np.int64), owner)
    return [part], rectangles(xy, length, width, heading)


def gabled() -> Template:
    """A plain building of unit size under a gable roof with eaves. Slots: 0 walls, 1 roof."""
    model = Modeller()
    eave, ridge, over = 0.6, 1.0, 0.53
    model.box((-0.5, -0.5, 0.0), (0.5, 0.5, eave), 0, Semantic.WALL, covered=True)
    fall = (over - 0.5) * (ridge - eave) / 0.5
    for side in (-1.0, 1.0):
        y, low = side * over, eave - fall
        slope = [[-over, y, low], [over, y, low], [over, 0.0, ridge], [-over, 0.0, ridge]]
        model.quads(np.array([slope if side < 0 else slope[::-1]]), 1, Semantic.ROOF)
        gable = np.array([[side * 0.5, -0.5, eave], [side * 0.5, 0.5, eave], [side * 0.5, 0.0, ridge]])
        site = model.site(gable.mean(axis=0), np.array([side, 0.0, 0.0]))
        face = np.array([[0, 1, 2] if side > 0 else [0, 2, 1]])
        model.mesh(gable, face, 0, Semantic.WALL, np.full((1, 3), site))
    return model.finish()
