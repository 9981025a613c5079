"""Does anything float, lie buried or stand in something else? An audit of a world by its triangles and ray casts.

Every object has to touch, directly or through others, something that is ground; no object may lie wholly below it; and
nothing that stands may share its place with another thing or with the inside of a building. The audit knows nothing of
how a world was made, so that it holds for every map, and for scenes of others.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from jaxtyping import Bool, Float32, Int64
from scipy import sparse
from scipy.sparse import csgraph

from scenegen.classes import CLASSES, SOLID_GROUND, Semantic
from scenegen.geometry.part import face_areas
from scenegen_render import backend
from scenegen_render.scene import LoadedWorld

GROUND = (*SOLID_GROUND, Semantic.WATER)
"""Classes that carry everything else."""
STANDING = (
    Semantic.TREE, Semantic.CAR, Semantic.LARGE_VEHICLE, Semantic.BOAT, Semantic.PERSON, Semantic.POLE,
    Semantic.TRAFFIC_LIGHT, Semantic.SIGN, Semantic.STREET_FURNITURE,
)  # fmt: skip
"""Classes of things that need a place of their own."""

TOUCH_M = 0.15
"""Things nearer than this touch."""
_FOUNDATION_M = 8.0
_DEEP_M = 60.0
_SAMPLES = 28
_WALKS = 8
"""Surfaces of its own that a ray may leave behind: sprays of a hedge lie close."""
_FOOT_M = 0.6
_MIN_AREA_M2 = 1e-7
_SHARED = 0.1
"""Share of the smaller of two footprints from which on they collide."""


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
    things = _Objects.of(loaded)
    found = [
        *things.report("floating", ~_carried(loaded, things)),
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


@dataclass(frozen=True, eq=False)
class _Objects:
    """The objects of a world and the vertices of each, in one list sorted by object."""

    id: Int64[np.ndarray, "objects"]
    semantic: Int64[np.ndarray, "objects"]
    ground: Bool[np.ndarray, "objects"]
    house: Bool[np.ndarray, "objects"]
    first: Int64[np.ndarray, "objects"]
    count: Int64[np.ndarray, "objects"]
    points: Float32[np.ndarray, "corners 3"]

    @staticmethod
    def of(loaded: LoadedWorld) -> _Objects:
        world = loaded.world
        order = np.argsort(world.face_object, kind="stable")
        ids, first, count = np.unique(world.face_object[order], return_index=True, return_counts=True)
        points = world.mesh.vertices[world.mesh.faces[order]].reshape(-1, 3)
        kinds = np.zeros((len(ids), len(CLASSES)), np.int64)
        owner = np.repeat(np.arange(len(ids)), count)
        np.add.at(kinds, (owner, world.face_semantic[order]), 1)
        return _Objects(
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
        near = self.points[:, 2] <= low[owner] + _FOOT_M
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


def _carried(loaded: LoadedWorld, things: _Objects) -> Bool[np.ndarray, "objects"]:
    """Which objects touch the ground, directly or through others."""
    sample = np.linspace(0.0, 1.0, _SAMPLES)
    spread = things.first[:, None] + (sample * (things.count[:, None] - 1)).astype(np.int64)
    by_height = np.lexsort((things.points[:, 2], things.owner))
    low = by_height[things.first[:, None] + np.minimum(np.arange(6), things.count[:, None] - 1)]
    chosen = np.concatenate([spread, low], axis=1)
    index = np.repeat(np.arange(len(things.id)), chosen.shape[1])
    start = things.points[chosen.ravel()]
    pairs = [np.zeros((0, 2), np.int64)]
    for direction in np.concatenate([np.eye(3), -np.eye(3)]).astype(np.float32):
        reach = _FOUNDATION_M if direction[2] > 0.5 else TOUCH_M
        pairs.append(_touches(loaded, things, start, index, direction, reach))
    touching = np.concatenate(pairs)
    graph = sparse.coo_array(
        (np.ones(len(touching), bool), (touching[:, 0], touching[:, 1])), shape=(len(things.id),) * 2
    )
    _, component = csgraph.connected_components(graph, directed=False)
    grounded = np.zeros(component.max() + 1, bool)
    grounded[component[things.ground]] = True
    return np.asarray(grounded[component])


def _touches(
    loaded: LoadedWorld,
    things: _Objects,
    start: Float32[np.ndarray, "rays 3"],
    index: Int64[np.ndarray, "rays"],
    direction: Float32[np.ndarray, "3"],
    reach_m: float,
) -> Int64[np.ndarray, "pairs 2"]:
    """Pairs of objects where a short ray from one meets the other, walking through the object it starts from.

    A long ray counts only where it meets the ground from below: a foundation.
    """
    found = [np.zeros((0, 2), np.int64)]
    alive, travelled = np.arange(len(start)), np.full(len(start), -1e-3)
    for _ in range(_WALKS):
        origin = start[alive] + direction * travelled[alive, None].astype(np.float32)
        distance, face = _cast(loaded, origin, np.broadcast_to(direction, origin.shape))
        total = travelled[alive] + distance
        within = total < reach_m
        met = np.searchsorted(things.id, loaded.world.face_object[face[within]].astype(np.int64))
        mine = index[alive][within]
        other = met != mine
        counts = other & ((total[within] < TOUCH_M) | things.ground[met])
        found.append(np.column_stack([mine[counts], met[counts]]))
        travelled[alive] = total + 1e-3
        alive = alive[within][~counts]
        if not len(alive):
            break
    return np.unique(np.concatenate(found), axis=0)


def _buried(loaded: LoadedWorld, things: _Objects) -> Bool[np.ndarray, "objects"]:
    """Which objects have even their highest point below the ground."""
    top = np.lexsort((-things.points[:, 2], things.owner))[things.first]
    start = things.points[top] + np.array([0.0, 0.0, 1e-3], np.float32)
    distance, face = _cast(loaded, start, np.broadcast_to(np.array([0.0, 0.0, 1.0], np.float32), start.shape))
    met = np.searchsorted(things.id, loaded.world.face_object[face].astype(np.int64))
    is_ground = np.isin(loaded.world.face_semantic[face], GROUND)
    return np.asarray((distance < _DEEP_M) & is_ground & (met != np.arange(len(met))) & ~things.ground)


def _indoors(loaded: LoadedWorld, things: _Objects) -> Bool[np.ndarray, "objects"]:
    """Which standing things are surrounded by the backs of one building's walls."""
    chosen = np.flatnonzero(np.isin(things.semantic, STANDING) & ~things.house)
    start = things.feet()[chosen] + np.array([0.0, 0.0, 0.5], np.float32)
    inside = np.ones(len(chosen), bool)
    for angle in np.arange(8) * (np.pi / 4) + 0.1:
        direction = np.array([np.cos(angle), np.sin(angle), 0.0], np.float32)
        origin, enclosed = start.copy(), np.zeros(len(chosen), bool)
        for _ in range(_WALKS):
            distance, face = _cast(loaded, origin, np.broadcast_to(direction, start.shape))
            wall = np.isfinite(distance) & np.isin(
                loaded.world.face_semantic[face], (Semantic.WALL, Semantic.WINDOW, Semantic.DOOR)
            )
            enclosed |= wall & (_face_normal(loaded, face) @ direction > 0.0)
            origin = origin + direction * np.where(wall, 0.0, np.minimum(distance, 1e3) + 1e-3)[
                :, None
            ].astype(np.float32)
        inside &= enclosed
    wrong = np.zeros(len(things.id), bool)
    wrong[chosen[inside]] = True
    return wrong


def _overlapping(things: _Objects) -> Bool[np.ndarray, "objects"]:
    """Which standing things share a tenth of their foot with another one at the same height."""
    owner, low = things.owner, things.lowest()
    chosen = np.isin(things.semantic, STANDING) & ~things.house & ~things.ground
    near = chosen[owner] & (things.points[:, 2] <= low[owner] + _FOOT_M)
    who, compact = np.unique(owner[near], return_inverse=True)
    if not len(who):
        return np.zeros(len(things.id), bool)
    clouds = shapely.multipoints(things.points[near, :2].astype(np.float64), indices=compact)
    hull = shapely.convex_hull(clouds)
    a, b = shapely.STRtree(hull).query(hull, predicate="intersects")
    apart = (a < b) & (np.abs(low[who[a]] - low[who[b]]) < _FOOT_M)
    a, b = a[apart], b[apart]
    shared = shapely.area(shapely.intersection(hull[a], hull[b]))
    smaller = np.minimum(shapely.area(hull[a]), shapely.area(hull[b]))
    collide = shared > _SHARED * np.maximum(smaller, 1e-4)
    wrong = np.zeros(len(things.id), bool)
    wrong[who[np.maximum(a, b)[collide]]] = True
    return wrong


def _cast(
    loaded: LoadedWorld, origin: Float32[np.ndarray, "rays 3"], direction: Float32[np.ndarray, "rays 3"]
) -> tuple[np.ndarray, np.ndarray]:
    """Distance [m] (inf where nothing) and face of the nearest hit of each ray."""
    mi, dr = backend.modules()
    if not len(origin):
        return np.zeros(0), np.zeros(0, np.int64)
    lane = dr.arange(mi.UInt, len(origin))
    o: Any = dr.gather(mi.Point3f, backend.upload(np.ascontiguousarray(origin)), lane)
    d: Any = dr.gather(mi.Vector3f, backend.upload(np.ascontiguousarray(direction)), lane)
    hit = loaded.scene.ray_intersect_preliminary(mi.Ray3f(o, d))
    valid = np.asarray(hit.is_valid())
    distance = np.where(valid, np.asarray(hit.t).astype(np.float64), np.inf)
    return distance, np.where(valid, np.asarray(hit.prim_index).astype(np.int64), 0)


def _face_normal(loaded: LoadedWorld, face: Int64[np.ndarray, "some"]) -> np.ndarray:
    mesh = loaded.world.mesh
    a, b, c = (mesh.vertices[mesh.faces[face, k]].astype(np.float64) for k in range(3))
    return np.asarray(np.cross(b - a, c - a))
