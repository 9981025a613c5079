"""The neighborhood: streets, lots, houses, ground, greenery, wires and the land around, from one generator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from scenegen.buildings.detached.body import Role, outline
from scenegen.buildings.detached.features import home_features
from scenegen.buildings.detached.roofs import home_roofs
from scenegen.buildings.detached.walls import home_walls
from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.relief import draw_relief
from scenegen.maps.neighborhood.grading import Graded, grade
from scenegen.maps.neighborhood.ground import build_ground
from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.maps.neighborhood.lots import divide
from scenegen.maps.neighborhood.outskirts import far_objects
from scenegen.maps.neighborhood.parcels import Parcel, Settler, homes_of
from scenegen.maps.neighborhood.streets import StreetPlan, draw_streets
from scenegen.maps.neighborhood.traffic import build_traffic, find_spots
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.materials.palette import PaletteBuilder
from scenegen.world import World

_MARGIN_M = 10.0
_HEIGHT_CELL_M = 2.0


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
    extent, depth = own.uniform(*knobs.extent_m), own.uniform(*knobs.lot_depth_m)
    width = own.uniform(*knobs.lot_width_m)
    plan = draw_streets(
        extent, depth, own.uniform(*knobs.street_curvature), own.uniform(*knobs.cul_de_sac_share), streets
    )
    relief = draw_relief(hills, hills.uniform(*knobs.relief_m), (240.0, 900.0))
    shop = NeighborhoodWorkshop(relief, PaletteBuilder(skins), GeometryBuilder(), season, knobs)
    division = divide(plan, width, depth, lots_rng)
    parcels = _settle(division.lots, plan, shop, settle_rng)
    half = float(np.abs(plan.outline.bounds).max()) + 8.0
    graded = grade(relief, [pad for p in parcels for pad in _pads(p)], plan.front, half)
    shop = replace(shop, relief=graded)
    homes = homes_of(parcels, shop, roofs_rng)
    spots = find_spots(plan, parcels, shop, cars_rng)
    holes = [home.plan((Role.HOUSE, Role.GARAGE, Role.HUT)) for home in homes]
    holes += [s for home in homes for s in _slabs(home)]

    builder = shop.builder
    builder.add(build_ground(plan, parcels, holes, spots.plan, shop, ground))
    builder.add(home_walls(homes, walls), home_roofs(homes), *home_features(homes, walls))
    builder.add(*build_traffic(spots, shop, cars_rng))
    builder.add(*far_objects(plan, shop, far))
    return _world(plan, parcels, graded, shop, (("cars", len(spots.place)),))


def _settle(lots, plan: StreetPlan, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Parcel]:  # type: ignore[no-untyped-def]
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


def _slabs(home) -> list[shapely.Polygon]:  # type: ignore[no-untyped-def]
    """Plans of porch floors."""
    from scenegen.buildings.detached.body import Top

    porches = [b for b in home.bodies if b.role is Role.SHELTER and b.top is Top.SHED]
    corners = [shapely.get_coordinates(shapely.box(b.x0_m, b.y0_m, b.x1_m, b.y1_m))[:-1] for b in porches]
    return [shapely.Polygon(home.lot.world(c)) for c in corners]


def _world(
    plan: StreetPlan,
    parcels: list[Parcel],
    graded: Graded,
    shop: NeighborhoodWorkshop,
    counts: tuple[tuple[str, int], ...],
) -> World:
    merged = shop.builder.merge()
    half = _inner_half(plan.outline)
    return World(
        map="neighborhood",
        mesh=merged.mesh,
        face_surface=merged.face_surface,
        face_semantic=merged.face_semantic,
        face_object=merged.face_object,
        corner_site=merged.corner_site,
        sites=merged.sites,
        palette=shop.palette.surfaces(),
        ground=graded.sample(float(np.abs(plan.outline.bounds).max()) + 60.0, _HEIGHT_CELL_M),
        flight_box_m=((-half, -half, 0.0), (half, half, shop.knobs.flight_ceiling_m)),
        counts=(
            ("streets", len(plan.lines)),
            ("dead ends", sum(a + b for a, b in plan.dead_end)),
            ("lots", len(parcels)),
            ("houses", sum(p.solid is not None for p in parcels)),
            ("pools", sum(p.garden.pool is not None for p in parcels)),
            ("sheds", sum(p.hut is not None for p in parcels)),
            *counts,
        ),
    )


def _inner_half(outline_: shapely.Polygon) -> float:
    """Half the side [m] of the largest upright square around the origin inside the detailed part."""
    reach = np.linspace(40.0, 460.0, 211)
    inner = outline_.buffer(-_MARGIN_M)
    fits = [inner.contains(shapely.box(-r, -r, r, r)) for r in reach]
    return float(reach[max(int(np.argmin(fits)) - 1, 0)])
