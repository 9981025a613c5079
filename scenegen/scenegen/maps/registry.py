"""All map families. A new one is a folder and a line here.

What a family can be asked is known at once; the code that builds its worlds is imported with the first of them, so that
help, checks and plans do not wait for geometry.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError, nearest
from scenegen.foundation.section import Section
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.world import World


@dataclass(frozen=True)
class MapFamily:
    """A kind of world.

    Attributes
    ----------
    name : str
        As users write it.
    description : str
        One line for listings.
    knobs : type of Section
        What can be turned.
    builder : str
        ``module:function``, from knobs, season and generator to world.
    """

    name: str
    description: str
    knobs: type[Section]
    builder: str


_FAMILIES = (
    MapFamily(
        "city",
        "dense streets, blocks and parks of a European or American town",
        CityKnobs,
        "scenegen.maps.city.city:build_city",
    ),
    MapFamily(
        "coastline",
        "cliffs, dunes and beach by a wavy sea, with pier, breakwater and lighthouse",
        CoastlineKnobs,
        "scenegen.maps.coastline.coastline:build_coastline",
    ),
    MapFamily(
        "neighborhood",
        "a suburb: winding streets, houses with gardens, pools and sheds, trees, utility poles",
        NeighborhoodKnobs,
        "scenegen.maps.neighborhood.neighborhood:build_neighborhood",
    ),
    MapFamily(
        "field",
        "a football ground in rolling farmland: pitches, stands, floodlights, nets",
        FieldKnobs,
        "scenegen.maps.field.field:build_field",
    ),
)

MAPS: Mapping[str, MapFamily] = MappingProxyType({family.name: family for family in _FAMILIES})
"""All map families by name."""


def map_family(name: str) -> MapFamily:
    """Look a map family up.

    Raises
    ------
    InputError
        If there is none of this name; names the nearest one.
    """
    try:
        return MAPS[name]
    except KeyError:
        raise InputError(f"unknown map '{name}'{nearest(name, MAPS)}") from None


def build_world(map: str, knobs: Section, season: Season, rng: np.random.Generator) -> World:
    """Build a world.

    Parameters
    ----------
    map : str
        Name of the family, or of an own scene.
    knobs : Section
        Of the family's own class; `OwnScene` for an own scene.
    season : Season
        Decides what is in leaf; the sun comes later.
    rng : numpy.random.Generator
        The world is a pure function of map, knobs, season and the state of this generator.

    Raises
    ------
    InputError
        If the map is unknown or the knobs belong to another family.
    """
    if isinstance(knobs, OwnScene):
        from scenegen.maps.own_scene.own_scene import build_own_scene

        return build_own_scene(map, knobs, season, rng)
    family = map_family(map)
    if not isinstance(knobs, family.knobs):
        raise InputError(f"map '{map}' takes {family.knobs.__name__}, not {type(knobs).__name__}")
    world: World = pkgutil.resolve_name(family.builder)(knobs, season, rng)
    return world
