"""What the tests of all maps ask of a built world: its arrays, what stands in it, and the rules every world keeps."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.part import face_areas, face_normals
from scenegen.world import World

GROUND = [
    Semantic.ROAD, Semantic.SIDEWALK, Semantic.ROAD_MARKING, Semantic.SOIL, Semantic.GRASS, Semantic.WATER,
    Semantic.SPORTS_SURFACE,
]  # fmt: skip
"""Classes of the ground where nothing is built, but for the sea and its shore."""


def arrays(world: World) -> list[np.ndarray]:
    """Every array of a world, those of its movers included."""
    sites = world.sites
    moving = [array for m in world.movers for array in (m.body.vertices, m.body.faces, m.route.rows)]
    return [
        world.mesh.vertices, world.mesh.faces, world.face_surface, world.face_semantic, world.face_object,
        world.corner_site, sites.position, sites.normal, sites.area, sites.surface, sites.object,
        sites.standoff, world.ground.height_m, *moving,
    ]  # fmt: skip


def corners(world: World, mask=slice(None)) -> np.ndarray:
    """Corners (n, 3, 3) of some faces."""
    return world.mesh.vertices[world.mesh.faces[mask]].astype(np.float64)


def normals(world: World, mask=slice(None)) -> np.ndarray:
    """Unit normals (n, 3) of some faces."""
    faces = world.mesh.faces[mask].astype(np.int64)
    return face_normals(world.mesh.vertices.astype(np.float64), faces)[0]


def areas(world: World, mask=slice(None)) -> np.ndarray:
    """Areas (n,) of some faces [m^2]."""
    faces = world.mesh.faces[mask].astype(np.int64)
    return face_areas(world.mesh.vertices.astype(np.float64), faces)


def things(world: World, *semantics: Semantic) -> list[np.ndarray]:
    """Corner points (n, 3) of each object of some classes, in the order of their ids."""
    mask = np.isin(world.face_semantic, semantics)
    if not mask.any():
        return []
    owner = world.face_object[mask]
    order = np.argsort(owner, kind="stable")
    start = np.flatnonzero(np.diff(owner[order])) + 1
    return np.split(corners(world, mask)[order].reshape(-1, 3), 3 * start)


def plans(found: list[np.ndarray]) -> np.ndarray:
    """Convex plans of things."""
    return np.array([shapely.MultiPoint(thing[:, :2]).convex_hull for thing in found], dtype=object)


def feet(found: list[np.ndarray]) -> np.ndarray:
    """Lowest points (things, 3)."""
    return np.array([thing[np.argmin(thing[:, 2])] for thing in found]).reshape(-1, 3)


def ground_below(world: World, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Point and height of every ground face that vertical lines through points meet (plain plane equations)."""
    flat = np.isin(world.face_semantic, GROUND)
    flat[flat] = normals(world, flat)[:, 2] > 0.3
    triangle, normal = corners(world, flat), normals(world, flat)
    tree = shapely.STRtree(shapely.polygons(triangle[..., :2]))
    point, face = tree.query(shapely.points(xy), predicate="intersects")
    a, n = triangle[face, 0], normal[face]
    return point, a[:, 2] - ((xy[point] - a[:, :2]) * n[:, :2]).sum(axis=1) / n[:, 2]


def under(world: World, xy: np.ndarray, *semantics: Semantic) -> np.ndarray:
    """Which points lie in the plan of a face of some classes."""
    tree = shapely.STRtree(shapely.polygons(corners(world, np.isin(world.face_semantic, semantics))[..., :2]))
    return np.isin(np.arange(len(xy)), tree.query(shapely.points(xy), predicate="within")[0])


def check_arrays(world: World, smallest_face_m2: float = 1e-8) -> None:
    """Every array is finite, every index in range, every face a face, and sites agree with their faces."""
    for array in arrays(world):
        assert np.isfinite(array.astype(np.float64)).all()
    assert world.mesh.faces.max() == len(world.mesh.vertices) - 1
    assert world.corner_site.max() == len(world.sites.area) - 1
    assert np.abs(world.mesh.vertices).max() < 1e4
    assert areas(world).min() > smallest_face_m2
    assert np.linalg.norm(world.sites.normal, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert (world.sites.area > 0).all()
    assert world.face_surface.max() < len(world.palette)
    assert world.face_object.min() >= 1
    assert (world.sites.surface[world.corner_site] == world.face_surface[:, None]).all()
    assert (world.sites.object[world.corner_site] == world.face_object[:, None]).all()


def check_palette(world: World) -> None:
    """At most four variants of a material, each with an emissivity of its range."""
    names = [surface.material.name for surface in world.palette]
    assert max(names.count(name) for name in names) <= 4
    for surface in world.palette:
        low, high = surface.material.emissivity_range
        assert low <= surface.emissivity <= high


def check_one_ground(world: World, xy: np.ndarray, *built: Semantic) -> None:
    """A vertical line meets the ground once, or something built that stands in its place."""
    layers = np.bincount(ground_below(world, xy)[0], minlength=len(xy))
    assert layers.max() == 1
    cover = shapely.STRtree(shapely.polygons(corners(world, np.isin(world.face_semantic, built))[..., :2]))
    bare = shapely.points(xy[layers == 0])
    assert len(np.unique(cover.query(bare, predicate="dwithin", distance=0.03)[0])) == len(bare)


def check_same_bytes(first: World, second: World) -> None:
    """Two worlds are one, to the byte."""
    for a, b in zip(arrays(first), arrays(second), strict=True):
        assert a.tobytes() == b.tobytes()
    assert repr(first.palette) == repr(second.palette)
    assert first.counts == second.counts


def check_apart(first: np.ndarray, second: np.ndarray) -> None:
    """Two sets of points, of which neither is empty and less than half of what either holds is in both."""
    assert min(first.mean(), second.mean()) > 0.04
    assert (first & second).sum() < 0.5 * (first | second).sum()
