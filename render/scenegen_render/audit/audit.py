"""Does anything float, lie buried or stand in something else?

Every object has to touch, directly or through others, something that is ground; no object may lie wholly below it; and
nothing that stands may share its place with another thing or with the inside of a building. The audit knows nothing of
how a world was made, so that it holds for every map, and for scenes of others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Bool

from scenegen.classes import Semantic
from scenegen.geometry.part import face_areas
from scenegen_render.audit.carried import carried
from scenegen_render.audit.casting import WALKS, cast, face_normal
from scenegen_render.audit.things import FOOT_M, GROUND, Finding, Things
from scenegen_render.scene import LoadedWorld

_STANDING = (
    Semantic.TREE, Semantic.CAR, Semantic.LARGE_VEHICLE, Semantic.BOAT, Semantic.PERSON, Semantic.POLE,
    Semantic.TRAFFIC_LIGHT, Semantic.SIGN, Semantic.STREET_FURNITURE,
)  # fmt: skip
"""Classes of things that need a place of their own."""

_DEEP_M = 60.0
"""Ground that is farther above a thing than this is the underside of something else."""
_MIN_AREA_M2 = 1e-7
"""Faces below this area are degenerate."""
_SHARED = 0.1
"""Share of the smaller of two footprints from which on they collide."""


@dataclass(frozen=True)
class Audit:
    """What an audit found.

    Attributes
    ----------
    objects : int
        Number of objects looked at.
    non_finite, degenerate : int
        Vertices that are not numbers; faces without area.
    findings : tuple of Finding
    """

    objects: int
    non_finite: int
    degenerate: int
    findings: tuple[Finding, ...]

    @property
    def clean(self) -> bool:
        """Whether nothing is wrong."""
        return not (self.non_finite or self.degenerate or self.findings)


def audit(loaded: LoadedWorld) -> Audit:
    """Audit a world.

    Parameters
    ----------
    loaded : LoadedWorld
    """
    world = loaded.world
    mesh = world.mesh
    area = face_areas(mesh.vertices.astype(np.float64), mesh.faces.astype(np.int64))
    things = Things.of(loaded)
    found = [
        *things.report("floating", ~carried(loaded, things)),
        *things.report("buried", _buried(loaded, things)),
        *things.report("inside a building", _indoors(loaded, things)),
        *things.report("overlapping", _overlapping(things)),
    ]
    return Audit(
        objects=len(things.id),
        non_finite=int((~np.isfinite(mesh.vertices)).any(axis=1).sum()),
        degenerate=int((area < _MIN_AREA_M2).sum()),
        findings=tuple(found),
    )


def _buried(loaded: LoadedWorld, things: Things) -> Bool[np.ndarray, "objects"]:
    """Which objects have even their highest point below the ground."""
    top = np.lexsort((-things.points[:, 2], things.owner))[things.first]
    start = things.points[top] + np.array([0.0, 0.0, 1e-3], np.float32)
    distance, face = cast(loaded, start, np.broadcast_to(np.array([0.0, 0.0, 1.0], np.float32), start.shape))
    met = np.searchsorted(things.id, loaded.world.face_object[face].astype(np.int64))
    is_ground = np.isin(loaded.world.face_semantic[face], GROUND)
    return np.asarray((distance < _DEEP_M) & is_ground & (met != np.arange(len(met))) & ~things.ground)


def _indoors(loaded: LoadedWorld, things: Things) -> Bool[np.ndarray, "objects"]:
    """Which standing things are surrounded by the backs of one building's walls."""
    chosen = np.flatnonzero(np.isin(things.semantic, _STANDING) & ~things.house)
    start = things.feet()[chosen] + np.array([0.0, 0.0, 0.5], np.float32)
    inside = np.ones(len(chosen), bool)
    for angle in np.arange(8) * (np.pi / 4) + 0.1:
        direction = np.array([np.cos(angle), np.sin(angle), 0.0], np.float32)
        origin, enclosed = start.copy(), np.zeros(len(chosen), bool)
        for _ in range(WALKS):
            distance, face = cast(loaded, origin, np.broadcast_to(direction, start.shape))
            wall = np.isfinite(distance) & np.isin(
                loaded.world.face_semantic[face], (Semantic.WALL, Semantic.WINDOW, Semantic.DOOR)
            )
            enclosed |= wall & (face_normal(loaded, face) @ direction > 0.0)
            origin = origin + direction * np.where(wall, 0.0, np.minimum(distance, 1e3) + 1e-3)[
                :, None
            ].astype(np.float32)
        inside &= enclosed
    wrong = np.zeros(len(things.id), bool)
    wrong[chosen[inside]] = True
    return wrong


def _overlapping(things: Things) -> Bool[np.ndarray, "objects"]:
    """Which standing things share a tenth of their foot with another one at the same height."""
    owner, low = things.owner, things.lowest()
    chosen = np.isin(things.semantic, _STANDING) & ~things.house & ~things.ground
    near = chosen[owner] & (things.points[:, 2] <= low[owner] + FOOT_M)
    who, compact = np.unique(owner[near], return_inverse=True)
    if not len(who):
        return np.zeros(len(things.id), bool)
    clouds = shapely.multipoints(things.points[near, :2].astype(np.float64), indices=compact)
    hull = shapely.convex_hull(clouds)
    a, b = shapely.STRtree(hull).query(hull, predicate="intersects")
    apart = (a < b) & (np.abs(low[who[a]] - low[who[b]]) < FOOT_M)
    a, b = a[apart], b[apart]
    shared = shapely.area(shapely.intersection(hull[a], hull[b]))
    smaller = np.minimum(shapely.area(hull[a]), shapely.area(hull[b]))
    collide = shared > _SHARED * np.maximum(smaller, 1e-4)
    wrong = np.zeros(len(things.id), bool)
    wrong[who[np.maximum(a, b)[collide]]] = True
    return wrong
