"""Our classes in the words of others: Cityscapes labels, and object names as AirSim scenes have them.

Cityscapes numbers and names are those of its label list (Cordts et al. 2016, doi:10.1109/CVPR.2016.350, "labels.py" of
the benchmark); what it does not tell apart gets its nearest label, so that the mapping never splits one of our classes.
AirSim has no classes of its own: its segmentation colours objects by the names of their meshes, and
``simSetSegmentationObjectID("Tree.*", 12, True)`` groups them by such a stem.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from jaxtyping import UInt8

from scenegen.classes import CLASSES, Semantic

CITYSCAPES_LABELS: Mapping[str, int] = MappingProxyType(
    {
        "static": 4, "ground": 6, "road": 7, "sidewalk": 8, "building": 11, "fence": 13,
        "guard rail": 14, "bridge": 15, "pole": 17, "traffic light": 19, "traffic sign": 20, "vegetation": 21,
        "terrain": 22, "sky": 23, "person": 24, "car": 26, "truck": 27,
    }
)  # fmt: skip
"""Ids of the Cityscapes labels that our classes map to."""

CITYSCAPES: Mapping[Semantic, str] = MappingProxyType(
    {
        Semantic.SKY: "sky",
        Semantic.ROAD: "road",
        Semantic.SIDEWALK: "sidewalk",
        Semantic.ROAD_MARKING: "road",
        Semantic.SOIL: "terrain",
        Semantic.GRASS: "terrain",
        Semantic.SAND: "terrain",
        Semantic.ROCK: "terrain",
        Semantic.WATER: "ground",
        Semantic.SPORTS_SURFACE: "ground",
        Semantic.WALL: "building",
        Semantic.ROOF: "building",
        Semantic.WINDOW: "building",
        Semantic.DOOR: "building",
        Semantic.BALCONY: "building",
        Semantic.ROOF_EQUIPMENT: "building",
        Semantic.CHIMNEY: "building",
        Semantic.BRIDGE: "bridge",
        Semantic.TREE: "vegetation",
        Semantic.SHRUB: "vegetation",
        Semantic.CAR: "car",
        Semantic.LARGE_VEHICLE: "truck",
        Semantic.BOAT: "static",
        Semantic.PERSON: "person",
        Semantic.POLE: "pole",
        Semantic.WIRE: "static",
        Semantic.TRAFFIC_LIGHT: "traffic light",
        Semantic.SIGN: "traffic sign",
        Semantic.FENCE: "fence",
        Semantic.BARRIER: "guard rail",
        Semantic.STREET_FURNITURE: "static",
        Semantic.PIER: "bridge",
        Semantic.STAND: "building",
        Semantic.GOAL: "static",
        Semantic.OTHER: "static",
    }
)
"""Nearest Cityscapes label of each class."""

AIRSIM: Mapping[Semantic, str] = MappingProxyType(
    {
        Semantic.SKY: "Sky",
        Semantic.ROAD: "Road",
        Semantic.SIDEWALK: "Sidewalk",
        Semantic.ROAD_MARKING: "Road",
        Semantic.SOIL: "Ground",
        Semantic.GRASS: "Grass",
        Semantic.SAND: "Ground",
        Semantic.ROCK: "Rock",
        Semantic.WATER: "Water",
        Semantic.SPORTS_SURFACE: "Field",
        Semantic.WALL: "House",
        Semantic.ROOF: "Roof",
        Semantic.WINDOW: "Window",
        Semantic.DOOR: "Door",
        Semantic.BALCONY: "House",
        Semantic.ROOF_EQUIPMENT: "Roof",
        Semantic.CHIMNEY: "Chimney",
        Semantic.BRIDGE: "Bridge",
        Semantic.TREE: "Tree",
        Semantic.SHRUB: "Hedge",
        Semantic.CAR: "Car",
        Semantic.LARGE_VEHICLE: "Truck",
        Semantic.BOAT: "Boat",
        Semantic.PERSON: "Person",
        Semantic.POLE: "Pole",
        Semantic.WIRE: "Powerline",
        Semantic.TRAFFIC_LIGHT: "TrafficLight",
        Semantic.SIGN: "Sign",
        Semantic.FENCE: "Fence",
        Semantic.BARRIER: "Barrier",
        Semantic.STREET_FURNITURE: "Prop",
        Semantic.PIER: "Pier",
        Semantic.STAND: "Stand",
        Semantic.GOAL: "Goal",
        Semantic.OTHER: "Prop",
    }
)
"""Stem of an object name, as scenes for AirSim use them."""


def cityscapes_table() -> UInt8[np.ndarray, "classes"]:
    """Look-up table from our ids to Cityscapes label ids: ``cityscapes_table()[sample["semantic"]]``."""
    return np.array([CITYSCAPES_LABELS[CITYSCAPES[row.id]] for row in CLASSES], np.uint8)
