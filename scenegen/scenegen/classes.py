"""The semantic classes of all maps: ids, names and colours are fixed and never reused.

Users train on these ids, so a class may be added at the end but never renumbered. Colours follow the Cityscapes
habit where it has one, so that pictures read at a glance.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Semantic(IntEnum):
    """Class id of a surface, as stored in the `semantic` layer."""

    SKY = 0
    ROAD = 1
    SIDEWALK = 2
    ROAD_MARKING = 3
    SOIL = 4
    GRASS = 5
    SAND = 6
    ROCK = 7
    WATER = 8
    SPORTS_SURFACE = 9
    WALL = 10
    ROOF = 11
    WINDOW = 12
    DOOR = 13
    BALCONY = 14
    ROOF_EQUIPMENT = 15
    CHIMNEY = 16
    BRIDGE = 17
    TREE = 18
    SHRUB = 19
    CAR = 20
    LARGE_VEHICLE = 21
    BOAT = 22
    PERSON = 23
    POLE = 24
    WIRE = 25
    TRAFFIC_LIGHT = 26
    SIGN = 27
    FENCE = 28
    BARRIER = 29
    STREET_FURNITURE = 30
    PIER = 31
    STAND = 32
    GOAL = 33
    OTHER = 34


SOLID_GROUND = (
    Semantic.ROAD,
    Semantic.SIDEWALK,
    Semantic.ROAD_MARKING,
    Semantic.SOIL,
    Semantic.GRASS,
    Semantic.SAND,
    Semantic.ROCK,
    Semantic.SPORTS_SURFACE,
)
"""Classes of land that things stand on; water carries things too, but is not solid."""


@dataclass(frozen=True)
class SemanticClass:
    """One row of the class list.

    Attributes
    ----------
    id : Semantic
        Number stored in the data.
    name : str
        Lower-case name used in files and listings.
    colour : tuple of int
        sRGB, 0-255, for pictures.
    thing : bool
        True for countable objects ("thing"), False for amorphous regions ("stuff").
    """

    id: Semantic
    name: str
    colour: tuple[int, int, int]
    thing: bool


_STUFF = {
    Semantic.SKY: (70, 130, 180),
    Semantic.ROAD: (128, 64, 128),
    Semantic.SIDEWALK: (244, 35, 232),
    Semantic.ROAD_MARKING: (235, 235, 235),
    Semantic.SOIL: (152, 118, 84),
    Semantic.GRASS: (152, 251, 152),
    Semantic.SAND: (237, 214, 150),
    Semantic.ROCK: (110, 105, 100),
    Semantic.WATER: (30, 90, 200),
    Semantic.SPORTS_SURFACE: (200, 90, 60),
    Semantic.WALL: (102, 102, 102),
    Semantic.ROOF: (170, 60, 60),
    Semantic.BRIDGE: (150, 100, 100),
    Semantic.BARRIER: (102, 102, 156),
    Semantic.FENCE: (190, 153, 153),
}
_THINGS = {
    Semantic.WINDOW: (40, 200, 230),
    Semantic.DOOR: (120, 80, 30),
    Semantic.BALCONY: (140, 140, 170),
    Semantic.ROOF_EQUIPMENT: (255, 170, 60),
    Semantic.CHIMNEY: (190, 90, 20),
    Semantic.TREE: (20, 110, 35),
    Semantic.SHRUB: (107, 142, 35),
    Semantic.CAR: (0, 0, 142),
    Semantic.LARGE_VEHICLE: (0, 60, 100),
    Semantic.BOAT: (0, 20, 60),
    Semantic.PERSON: (220, 20, 60),
    Semantic.POLE: (153, 153, 153),
    Semantic.WIRE: (60, 60, 60),
    Semantic.TRAFFIC_LIGHT: (250, 170, 30),
    Semantic.SIGN: (220, 220, 0),
    Semantic.STREET_FURNITURE: (250, 120, 160),
    Semantic.PIER: (150, 120, 90),
    Semantic.STAND: (90, 70, 140),
    Semantic.GOAL: (255, 255, 160),
    Semantic.OTHER: (81, 0, 81),
}

CLASSES: tuple[SemanticClass, ...] = tuple(
    SemanticClass(id=s, name=s.name.lower(), colour=(_STUFF | _THINGS)[s], thing=s in _THINGS)
    for s in Semantic
)
"""All classes, indexed by id."""
