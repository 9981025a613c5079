"""What stands in a world, counted: triangles and objects of each class."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenegen.classes import CLASSES, SemanticClass
from scenegen.world import World


@dataclass(frozen=True)
class ClassCount:
    """One class of a world.

    Attributes
    ----------
    kind : SemanticClass
    objects : int
        Instance ids with at least one face of this class.
    triangles : int
    """

    kind: SemanticClass
    objects: int
    triangles: int


def count_classes(world: World) -> tuple[ClassCount, ...]:
    """Count every class that occurs, in the order of their ids."""
    # One code per (class, object): 8 and 32 bits side by side.
    code = world.face_semantic.astype(np.uint64) << np.uint64(32) | world.face_object
    objects = np.bincount((np.unique(code) >> np.uint64(32)).astype(np.int64), minlength=len(CLASSES))
    triangles = np.bincount(world.face_semantic, minlength=len(CLASSES))
    return tuple(
        ClassCount(kind, int(objects[kind.id]), int(triangles[kind.id]))
        for kind in CLASSES
        if triangles[kind.id]
    )


def count_objects(world: World) -> int:
    """Number of different instance ids."""
    return int(np.unique(world.face_object).size)
