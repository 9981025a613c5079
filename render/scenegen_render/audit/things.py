"""The objects of a world as an audit sees them: their corners, what they are, and what is found about them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Int64

from scenegen.classes import CLASSES, SOLID_GROUND, Semantic
from scenegen_render.scene import LoadedWorld

GROUND = (*SOLID_GROUND, Semantic.WATER)
"""Classes that carry everything else."""

FOOT_M = 0.6
"""So much of a thing, from its lowest point up, is its foot."""


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong.

    Attributes
    ----------
    problem : str
        "floating", "buried", "inside a building" or "overlapping".
    object : int
        Instance id.
    semantic : str
        Its class name.
    position_m : (float, float, float)
        Middle of its foot.
    """

    problem: str
    object: int
    semantic: str
    position_m: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Things:
    """The objects of a world and the corners of each, in one list sorted by object.

    Attributes
    ----------
    id : int64 (objects,)
        Instance ids, rising.
    semantic : int64 (objects,)
        The class most of its faces have.
    ground, house : bool (objects,)
        Whether any of its faces is ground, or a wall.
    first, count : int64 (objects,)
        Where its corners begin among `points`, and how many they are.
    points : float32 (corners, 3)
        [m].
    """

    id: Int64[np.ndarray, "objects"]
    semantic: Int64[np.ndarray, "objects"]
    ground: Bool[np.ndarray, "objects"]
    house: Bool[np.ndarray, "objects"]
    first: Int64[np.ndarray, "objects"]
    count: Int64[np.ndarray, "objects"]
    points: Float32[np.ndarray, "corners 3"]

    @staticmethod
    def of(loaded: LoadedWorld) -> Things:
        """Sort the faces of a world by their objects."""
        world = loaded.world
        order = np.argsort(world.face_object, kind="stable")
        ids, first, count = np.unique(world.face_object[order], return_index=True, return_counts=True)
        points = world.mesh.vertices[world.mesh.faces[order]].reshape(-1, 3)
        kinds = np.zeros((len(ids), len(CLASSES)), np.int64)
        owner = np.repeat(np.arange(len(ids)), count)
        np.add.at(kinds, (owner, world.face_semantic[order]), 1)
        return Things(
            id=ids.astype(np.int64),
            semantic=kinds.argmax(axis=1),
            ground=np.asarray((kinds[:, list(GROUND)] > 0).any(axis=1)),
            house=kinds[:, Semantic.WALL] > 0,
            first=3 * first.astype(np.int64),
            count=3 * count.astype(np.int64),
            points=points,
        )

    @property
    def owner(self) -> Int64[np.ndarray, "corners"]:
        """Object (by position in the list) of each point."""
        return np.repeat(np.arange(len(self.id)), self.count)

    def lowest(self) -> Float32[np.ndarray, "objects"]:
        """Lowest height of each object [m]."""
        return np.minimum.reduceat(self.points[:, 2], self.first)

    def feet(self) -> Float32[np.ndarray, "objects 3"]:
        """Middle of the lowest half metre of each object."""
        owner, low = self.owner, self.lowest()
        near = self.points[:, 2] <= low[owner] + FOOT_M
        count = np.bincount(owner[near], minlength=len(self.id))
        mean = [
            np.bincount(owner[near], self.points[near, k], minlength=len(self.id)) / count for k in range(2)
        ]
        return np.column_stack([*mean, low]).astype(np.float32)

    def report(self, problem: str, wrong: Bool[np.ndarray, "objects"]) -> list[Finding]:
        """Findings for the objects that a check calls wrong."""
        feet = self.feet() if wrong.any() else np.zeros((len(self.id), 3), np.float32)
        return [
            Finding(
                problem,
                int(self.id[k]),
                CLASSES[int(self.semantic[k])].name,
                (float(feet[k, 0]), float(feet[k, 1]), float(feet[k, 2])),
            )
            for k in np.flatnonzero(wrong)
        ]
