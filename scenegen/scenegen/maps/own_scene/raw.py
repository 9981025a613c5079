"""A scene as its file has it, after repair: triangles, and the names they go by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64


class Names(NamedTuple):
    """What a part of a scene is called in its file; "" where it has no such name.

    Attributes
    ----------
    node, mesh, material : str
        In glTF those very things; in OBJ the group (else the object), the object and the material.
    object : int
        Parts of one node share it: they become one object of the world.
    """

    node: str
    mesh: str
    material: str
    object: int

    @property
    def shown(self) -> str:
        """How to call it in a message."""
        return self.node or self.mesh or self.material or "(without a name)"


@dataclass(frozen=True, eq=False)
class RawScene:
    """Triangles of a scene in ENU metres, welded and sound.

    Attributes
    ----------
    vertices : float64 (vertices, 3)
        [m], no two alike; all representable as float32.
    faces : int64 (faces, 3)
        No two alike, none without area.
    part : int64 (faces,)
        Index into `parts`.
    parts : tuple of Names
    repairs : tuple of (str, int)
        What was dropped, and how many.
    shift_m : (float, float)
        East and north that were taken off all coordinates, to bring a far-away scene to the origin.
    """

    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    part: Int64[np.ndarray, "faces"]
    parts: tuple[Names, ...]
    repairs: tuple[tuple[str, int], ...]
    shift_m: tuple[float, float]
