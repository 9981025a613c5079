"""Open land around a place: grass to the horizon, fields of one crop or bare soil each, and the roads that lead out."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.geometry.placement import clear_of, first_come
from scenegen.parts.workshop import Workshop

_COVERS = ("grass_watered", "grass_dry", "soil_dry", "grass_dry", "soil_wet", "grass_watered")
_VERGE_M, _HEM_M = 4.0, 50.0
"""Between a field and a road; between a field and the end of the land."""


def countryside(
    land: shapely.Polygon,
    grass: int,
    place: shapely.Polygon,
    fields: np.ndarray,
    roads: np.ndarray,
    paved: shapely.Polygon,
    shop: Workshop,
    rng: np.random.Generator,
) -> list[Region]:
    """Cover the land around a place; the first region is all of it.

    Parameters
    ----------
    land : shapely.Polygon
        Everything, the place included.
    grass : int
        Variant of the material of what is neither field nor road.
    place : shapely.Polygon
        Where no field lies.
    fields : array of shapely polygons
        Where fields might lie, the most wanted first; those in the way of the place, a road or an earlier one
        are left out.
    roads : array of shapely polygons
    paved : shapely.Polygon
        As far as roads are laid.
    shop : Workshop
    rng : numpy.random.Generator
    """
    open_land, crops, road = (shop.builder.new_objects() for _ in range(3))
    regions = [Region(land, grass, int(Semantic.GRASS), open_land)]
    taken = np.array([place, *shapely.buffer(roads, _VERGE_M)], dtype=object)
    keep = clear_of(fields, taken) & first_come(fields) & shapely.within(fields, land.buffer(-_HEM_M))
    for shape, k in zip(fields[keep], rng.integers(0, len(_COVERS), keep.sum()), strict=True):
        name = _COVERS[int(k)]
        semantic = Semantic.SOIL if name.startswith("soil") else Semantic.GRASS
        regions.append(Region(shape, shop.palette.pick(name, rng), int(semantic), crops))
    asphalt = shop.palette.pick("asphalt_aged", rng)
    for piece in shapely.get_parts(shapely.intersection(roads, paved)):
        if piece.geom_type == "Polygon":
            regions.append(Region(piece, asphalt, int(Semantic.ROAD), road))
    return regions
