"""Letter boxes where paths meet the sidewalk."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.template import Template, place
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop


def letter_box_places(parcels: Sequence[Parcel], posts: np.ndarray) -> np.ndarray:
    """Position and heading of one box beside each path, facing the street; clear of driveways and posts."""
    rows = []
    for parcel in parcels:
        door = parcel.bodies[0].entrance_m if parcel.bodies else None
        if parcel.path is None or door is None:
            continue
        rows.append(
            [*parcel.lot.world(np.array([[door + 1.1, 0.35]]))[0], parcel.lot.heading_rad - 0.5 * np.pi]
        )
    table = np.array(rows).reshape(-1, 3)
    drives = np.array([p.driveway for p in parcels if p.driveway is not None], dtype=object)
    points = shapely.points(table[:, :2])
    blocked = shapely.STRtree(drives).query(points, predicate="dwithin", distance=0.5)[0]
    inside = np.zeros(len(table), bool)
    areas = shapely.STRtree(np.array([p.lot.area for p in parcels], dtype=object))
    inside[areas.query(points, predicate="within")[0]] = True
    inside[blocked] = False
    if len(posts):
        inside[
            shapely.STRtree(shapely.points(posts[:, :2])).query(points, predicate="dwithin", distance=0.8)[0]
        ] = False
    return table[inside]


def build_letter_boxes(rows: np.ndarray, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Part]:
    """Boxes as parts."""
    if not len(rows):
        return []
    count = len(rows)
    metal = np.array([shop.palette.pick("metal_galv_weathered", rng) for _ in range(count)], np.int64)
    wood = np.full(count, shop.palette.pick("wood_siding", rng))
    owner = shop.builder.new_objects(count) + np.arange(count)
    skins = np.column_stack([metal, wood])
    return [place(_letter_box(), shop.on_verge(rows), rows[:, 2], np.ones((count, 3)), skins, owner)]


def _letter_box() -> Template:
    """A box with a round top on a post, its door towards +x. Slots: 0 metal, 1 timber."""
    model = Modeller()
    kind = Semantic.STREET_FURNITURE
    model.box((-0.05, -0.05, -0.1), (0.05, 0.05, 1.0), 1, kind, LUMP_STANDOFF_M, covered=True)
    angle = np.linspace(0.0, np.pi, 6)
    rim = np.concatenate(
        [[[0.11, 0.0]], np.column_stack([0.11 * np.cos(angle), 0.14 + 0.11 * np.sin(angle)]), [[-0.11, 0.0]]]
    )
    back, front = (np.column_stack([np.full(len(rim), x), rim[:, 0], 1.0 + rim[:, 1]]) for x in (-0.22, 0.26))
    k, after = np.arange(len(rim)), (np.arange(len(rim)) + 1) % len(rim)
    shell = np.stack([k, after, after + len(rim), k + len(rim)], axis=1)
    fan = np.stack([np.zeros(len(rim) - 2, np.int64), k[1:-1], k[2:]], axis=1)
    faces = np.concatenate([shell[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3), fan[:, ::-1], fan + len(rim)])
    top = model.site(np.array([0.0, 0.0, 1.3]), np.array([0.0, 0.0, 1.0]), LUMP_STANDOFF_M)
    door = model.site(np.array([0.3, 0.0, 1.15]), np.array([1.0, 0.0, 0.2]), LUMP_STANDOFF_M)
    site = np.full(faces.shape, top)
    site[-len(fan) :] = door
    model.mesh(np.concatenate([back, front]), faces, 0, kind, site)
    return model.finish()
