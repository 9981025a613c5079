"""The neighborhood: streets, lots, houses, ground, greenery, wires and the land around, from one generator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from jaxtyping import Float64
from scipy.ndimage import distance_transform_cdt

from scenegen.buildings.detached.body import Home, Role, Top, outline
from scenegen.buildings.detached.features import home_features
from scenegen.buildings.detached.roofs import home_roofs
from scenegen.buildings.detached.walls import home_walls
from scenegen.buildings.lots import Lot
from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import draw_relief, sample_height_field
from scenegen.maps.neighborhood.borders import build_fences, plan_borders
from scenegen.maps.neighborhood.grading import Graded, grade
from scenegen.maps.neighborhood.greenery import Obstacles, build_greenery, obstacles, plan_trees
from scenegen.maps.neighborhood.ground import build_ground
from scenegen.maps.neighborhood.kerbside import build_kerbside, plan_kerbside
from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.maps.neighborhood.lots import divide
from scenegen.maps.neighborhood.motion import plan_rounds, set_out
from scenegen.maps.neighborhood.outskirts import far_objects, lie_of
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.people import people
from scenegen.maps.neighborhood.settler import Settler, homes_of
from scenegen.maps.neighborhood.streets import StreetPlan, draw_streets
from scenegen.maps.neighborhood.traffic import Spots, build_traffic, find_spots
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.materials.palette import PaletteBuilder
from scenegen.movers.mover import Mover
from scenegen.world import World

_MARGIN_M = 10.0
_HEIGHT_CELL_M, _RASTER_M = 2.0, 4.0


def build_neighborhood(knobs: NeighborhoodKnobs, season: Season, rng: np.random.Generator) -> World:
    """Build one neighborhood.

    Parameters
    ----------
    knobs : NeighborhoodKnobs
    season : Season
        Decides what is in leaf, and how warm unheated rooms are.
    rng : numpy.random.Generator
        The only source of randomness; each subsystem gets a child of its own, so that none disturbs another.
    """
    own, streets, hills, skins, lots_rng, settle_rng, roofs_rng, ground, walls, cars_rng, far = rng.spawn(11)
    posts_rng, border_rng, tree_rng, people_rng, ways_rng, motion_rng = rng.spawn(6)
    extent, depth = own.uniform(*knobs.extent_m), own.uniform(*knobs.lot_depth_m)
    width = own.uniform(*knobs.lot_width_m)
    plan = draw_streets(
        extent, depth, own.uniform(*knobs.street_curvature), own.uniform(*knobs.cul_de_sac_share), streets
    )
    relief = draw_relief(hills, hills.uniform(*knobs.relief_m), (240.0, 900.0))
    palette = PaletteBuilder(skins)
    palette.variants("asphalt_aged", 3)  # the fourth is its paint
    shop = NeighborhoodWorkshop(relief, palette, GeometryBuilder(), season, knobs)
    division = divide(plan, width, depth, lots_rng)
    parcels = _settle(division.lots, plan, shop, settle_rng)
    half = float(np.abs(plan.outline.bounds).max()) + 8.0
    graded = grade(relief, [pad for p in parcels for pad in _pads(p)], plan.front, half)
    shop = replace(shop, relief=graded)
    homes = homes_of(parcels, shop, roofs_rng)
    rounds = plan_rounds(plan, ways_rng)
    walks = rounds.walk_lines()
    spots = find_spots(plan, parcels, rounds, shop, cars_rng)
    holes = _holes(homes)

    solid = np.array([home.plan() for home in homes], dtype=object)
    kerbside = plan_kerbside(plan, parcels, homes, solid, walks, shop, posts_rng)
    borders = plan_borders(division, parcels, plan, shop, border_rng)
    blocked = obstacles(plan, parcels, holes, kerbside, borders, walks)
    trees = plan_trees(plan, parcels, blocked, shop, tree_rng)

    builder = shop.builder
    land, plane = build_ground(plan, parcels, holes, spots.plan, blocked.lines, shop, ground)
    builder.add(land, home_walls(homes, walls), home_roofs(homes), *home_features(homes, walls))
    builder.add(*build_kerbside(kerbside, homes, shop, posts_rng), *build_fences(borders, shop, border_rng))
    builder.add(*build_traffic(spots, shop, cars_rng))
    builder.add(*build_greenery(trees, borders, parcels, blocked, shop, tree_rng))
    busy = np.concatenate([_occupied(parcels, blocked, spots, trees.xy), walks])
    crowd, standing = people(parcels, busy, shop, people_rng)
    builder.add(*crowd, *far_objects(plan, lie_of(plane, plan, relief), shop, far))
    movers = set_out(plan, rounds, shop, motion_rng)
    counts = (
        ("cars", len(spots.place)),
        ("trees", len(trees.xy)),
        ("fences", sum(line.style != "hedge" for line in borders)),
        ("hedges", sum(line.style == "hedge" for line in borders)),
        ("utility poles", sum(len(p) for p in kerbside.overhead.poles)),
        ("service drops", len(kerbside.overhead.drops)),
        ("lamps", len(kerbside.lamps)),
        ("people who stand", len(standing)),
        ("vehicles that drive", sum(m.kind != "person" for m in movers)),
        ("people who walk or run", sum(m.kind == "person" for m in movers)),
    )
    return _world(plan, parcels, graded, shop, counts, movers)


def _occupied(
    parcels: list[Parcel], blocked: Obstacles, spots: Spots, trees: Float64[np.ndarray, "trees 2"]
) -> np.ndarray:
    """Plans of everything that nobody can stand in, as shapely geometries."""
    trunks = shapely.buffer(shapely.points(trees), 0.4, quad_segs=1)
    pools = [p.garden.coping for p in parcels if p.garden.coping is not None]
    return np.concatenate(
        [blocked.solid, blocked.posts, blocked.lines, spots.plan, trunks, np.array(pools, dtype=object)]
    )


def _settle(
    lots: tuple[Lot, ...], plan: StreetPlan, shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> list[Parcel]:
    """Build on all lots; neighbours are of about the same age."""
    age, each = rng.spawn(2)
    vector, phase = age.normal(0.0, 2 * np.pi / 420.0, (3, 2)), age.uniform(0.0, 2 * np.pi, 3)
    settler = Settler.draw(shop, plan, age)
    parcels = []
    for lot, child in zip(lots, each.spawn(len(lots)), strict=True):
        wave = np.sin(vector @ lot.corner + phase).sum()
        parcels.append(settler.settle(lot, 0.5 + 0.28 * float(wave), child))
    return parcels


def _pads(parcel: Parcel) -> list[shapely.Polygon]:
    """Rectangles that need level ground: the house with its patio, the pool with its coping, the shed."""
    pads = []
    if parcel.solid is not None:
        patio = parcel.garden.patio
        pads.append([parcel.solid] if patio is None else [parcel.solid, patio])
    if parcel.garden.coping is not None:
        pads.append([parcel.garden.coping])
    if parcel.hut is not None:
        pads.append([parcel.world(outline((parcel.hut,)))])
    return [_box_in_frame(parcel, pieces) for pieces in pads]


def _box_in_frame(parcel: Parcel, pieces: list[shapely.Polygon]) -> shapely.Polygon:
    """The bounding rectangle along the axes of the lot."""
    turn, corner = parcel.lot.heading_rad, parcel.lot.corner
    axes = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    xy = (np.concatenate([shapely.get_coordinates(p) for p in pieces]) - corner) @ axes
    (x0, y0), (x1, y1) = xy.min(axis=0), xy.max(axis=0)
    return shapely.Polygon(parcel.lot.world(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])))


def _holes(homes: list[Home]) -> list[shapely.Polygon]:
    """Where there is no ground: below houses, sheds and the floors of porches."""
    holes = []
    for home in homes:
        holes.append(home.plan((Role.HOUSE, Role.GARAGE, Role.HUT)))
        for body in home.bodies:
            if body.role is Role.SHELTER and body.top is Top.SHED:
                box = shapely.box(body.x0_m, body.y0_m, body.x1_m, body.y1_m)
                holes.append(shapely.Polygon(home.lot.world(shapely.get_coordinates(box)[:-1])))
    return holes


def _world(
    plan: StreetPlan,
    parcels: list[Parcel],
    graded: Graded,
    shop: NeighborhoodWorkshop,
    counts: tuple[tuple[str, int], ...],
    movers: tuple[Mover, ...],
) -> World:
    x, y, half = _inner_square(plan.outline)
    return shop.builder.merge().world(
        map="neighborhood",
        palette=shop.palette.surfaces(),
        ground=sample_height_field(graded, float(np.abs(plan.outline.bounds).max()) + 60.0, _HEIGHT_CELL_M),
        flight_box_m=((x - half, y - half, 0.0), (x + half, y + half, shop.knobs.flight_ceiling_m)),
        counts=(
            ("streets", len(plan.lines)),
            ("dead ends", sum(a + b for a, b in plan.dead_end)),
            ("lots", len(parcels)),
            ("houses", sum(p.solid is not None for p in parcels)),
            ("pools", sum(p.garden.pool is not None for p in parcels)),
            ("sheds", sum(p.hut is not None for p in parcels)),
            *counts,
        ),
        movers=movers,
    )


def _inner_square(outline_: shapely.Polygon) -> tuple[float, float, float]:
    """Middle and half the side [m] of the largest upright square inside the detailed part."""
    inner = outline_.buffer(-_MARGIN_M)
    x0, y0, x1, y1 = inner.bounds
    x, y = np.arange(x0, x1, _RASTER_M), np.arange(y0, y1, _RASTER_M)
    east, north = np.meshgrid(x, y)
    inside = shapely.contains_xy(inner, east.ravel(), north.ravel()).reshape(east.shape)
    reach = distance_transform_cdt(np.pad(inside, 1), "chessboard")[1:-1, 1:-1]
    i, j = np.unravel_index(int(np.argmax(reach)), reach.shape)
    return float(x[j]), float(y[i]), float((reach[i, j] - 1) * _RASTER_M)
