"""Parts in, world arrays out: merged, without slivers, with the labels of sites, invariants checked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import UInt8, UInt16, UInt32

from scenegen.geometry.beside import beside_things
from scenegen.geometry.part import Part, concatenate, face_areas
from scenegen.materials.material import Surface
from scenegen.movers.mover import Mover
from scenegen.world import HeightField, Sites, TriangleMesh, World

MIN_FACE_AREA_M2 = 1e-6
"""Faces below this area are dropped: nobody sees a square millimetre, and its normal is noise in float32."""

MAX_COORDINATE_M = 1e4


@dataclass(frozen=True, eq=False)
class MergedGeometry:
    """The geometric half of a `scenegen.world.World`."""

    mesh: TriangleMesh
    face_surface: UInt16[np.ndarray, "faces"]
    face_semantic: UInt8[np.ndarray, "faces"]
    face_object: UInt32[np.ndarray, "faces"]
    corner_site: UInt32[np.ndarray, "faces 3"]
    sites: Sites

    def world(
        self,
        map: str,
        palette: tuple[Surface, ...],
        ground: HeightField,
        flight_box_m: tuple[tuple[float, float, float], tuple[float, float, float]],
        counts: tuple[tuple[str, int], ...],
        movers: tuple[Mover, ...] = (),
    ) -> World:
        """Add the other half; its fields are those of `scenegen.world.World`."""
        return World(
            map=map,
            mesh=self.mesh,
            face_surface=self.face_surface,
            face_semantic=self.face_semantic,
            face_object=self.face_object,
            corner_site=self.corner_site,
            sites=self.sites,
            palette=palette,
            ground=ground,
            flight_box_m=flight_box_m,
            counts=counts,
            movers=movers,
        )


class GeometryBuilder:
    """Collects parts in a fixed order and hands out instance ids."""

    def __init__(self) -> None:
        self._parts: list[Part] = []
        self._next_object = 1

    def new_objects(self, count: int = 1) -> int:
        """Reserve consecutive instance ids; returns the first."""
        first = self._next_object
        self._next_object += count
        return first

    def add(self, *parts: Part) -> None:
        """Append parts; their order is the order of the world's faces."""
        self._parts.extend(p for p in parts if len(p.faces))

    def merge(self) -> MergedGeometry:
        """Merge what was collected.

        Raises
        ------
        AssertionError
            If an index is out of range, a number is not finite or a site is shared by two surfaces or
            objects: a mistake in the map's code.
        """
        part, face_area = _without_slivers(concatenate(self._parts))
        assert np.isfinite(part.vertices).all() and np.abs(part.vertices).max() < MAX_COORDINATE_M
        part = beside_things(part)
        surface, owner, area = _site_labels(part, face_area)
        return MergedGeometry(
            mesh=TriangleMesh(part.vertices.astype(np.float32), part.faces.astype(np.uint32)),
            face_surface=part.surface.astype(np.uint16),
            face_semantic=part.semantic.astype(np.uint8),
            face_object=part.object.astype(np.uint32),
            corner_site=part.corner_site.astype(np.uint32),
            sites=Sites(
                position=part.site_position.astype(np.float32),
                normal=part.site_normal.astype(np.float32),
                area=area.astype(np.float32),
                surface=surface.astype(np.uint16),
                object=owner.astype(np.uint32),
                standoff=part.site_standoff.astype(np.float32),
            ),
        )


def _without_slivers(part: Part) -> tuple[Part, np.ndarray]:
    """Drop faces without area, then unused vertices and sites; returns the areas [m^2] of what stays."""
    area = face_areas(part.vertices.astype(np.float32).astype(np.float64), part.faces)
    keep = area > MIN_FACE_AREA_M2
    faces, corner_site = part.faces[keep], part.corner_site[keep]
    vertex_used, faces = _compact(faces, len(part.vertices))
    site_used, corner_site = _compact(corner_site, len(part.site_position))
    kept = Part(
        vertices=part.vertices[vertex_used],
        faces=faces,
        surface=part.surface[keep],
        semantic=part.semantic[keep],
        object=part.object[keep],
        corner_site=corner_site,
        site_position=part.site_position[site_used],
        site_normal=part.site_normal[site_used],
        site_standoff=part.site_standoff[site_used],
    )
    return kept, area[keep]


def _compact(index: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Mask of the entries that `index` uses, and `index` into the entries that stay."""
    used = np.zeros(count, bool)
    used[index.ravel()] = True
    return used, (np.cumsum(used) - 1)[index]


def _site_labels(part: Part, area: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Surface, object and area [m^2] of every site: a third of each face goes to each of its corners."""
    corners = part.corner_site.ravel()
    count = len(part.site_position)
    surface = np.zeros(count, np.int64)
    owner = np.zeros(count, np.int64)
    surface[corners] = np.repeat(part.surface, 3)
    owner[corners] = np.repeat(part.object, 3)
    assert (surface[part.corner_site] == part.surface[:, None]).all(), "a site is shared by two surfaces"
    assert (owner[part.corner_site] == part.object[:, None]).all(), "a site is shared by two objects"
    return surface, owner, np.bincount(corners, np.repeat(area / 3.0, 3), count)
