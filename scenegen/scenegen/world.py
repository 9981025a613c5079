"""The world as data: one triangle mesh, what each face is, and the sites where heat lives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, UInt8, UInt16, UInt32

from scenegen.materials.material import Surface
from scenegen.movers.mover import Mover


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Merged triangles in a fixed order, ENU metres, counter-clockwise seen from outside."""

    vertices: Float32[np.ndarray, "vertices 3"]
    faces: UInt32[np.ndarray, "faces 3"]


@dataclass(frozen=True, eq=False)
class Sites:
    """Where temperature, irradiance and emissivity live: a vertex of a facet, a patch of a tree crown, a car part.

    Attributes
    ----------
    position : float32 (sites, 3)
        [m], on the surface.
    normal : float32 (sites, 3)
        Outward unit normal; the hemisphere the site exchanges radiation with.
    area : float32 (sites,)
        Surface represented [m^2].
    surface : uint16 (sites,)
        Index into the world's palette.
    object : uint32 (sites,)
        Instance id.
    standoff : float32 (sites,)
        How far [m] along each ray the exposure starts looking, so that a lumped site (crown, car) does not see the
        geometry it stands for. A few millimetres for ordinary facets.
    """

    position: Float32[np.ndarray, "sites 3"]
    normal: Float32[np.ndarray, "sites 3"]
    area: Float32[np.ndarray, "sites"]
    surface: UInt16[np.ndarray, "sites"]
    object: UInt32[np.ndarray, "sites"]
    standoff: Float32[np.ndarray, "sites"]


@dataclass(frozen=True, eq=False)
class HeightField:
    """Ground height on a regular grid, for flights and for placing things; the mesh itself is the truth.

    Attributes
    ----------
    origin_m : (float, float)
        East and north of sample [0, 0].
    cell_m : float
    height_m : float32 (rows, columns)
        Rows run north, columns east.
    """

    origin_m: tuple[float, float]
    cell_m: float
    height_m: Float32[np.ndarray, "rows columns"]

    def at(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Ground height [m] at points, bilinear; outside the grid the border value."""
        rows, columns = self.height_m.shape
        grid = (xy - np.asarray(self.origin_m)) / self.cell_m
        column = np.clip(grid[:, 0], 0.0, columns - 1.000001)
        row = np.clip(grid[:, 1], 0.0, rows - 1.000001)
        i, j = row.astype(np.int64), column.astype(np.int64)
        a, b = row - i, column - j
        h = self.height_m.astype(np.float64)
        south = (1 - b) * h[i, j] + b * h[i, j + 1]
        north = (1 - b) * h[i + 1, j] + b * h[i + 1, j + 1]
        return np.asarray((1 - a) * south + a * north)


@dataclass(frozen=True, eq=False)
class World:
    """Everything that stands in one world. Immutable; a pure function of map, knobs and generator.

    Attributes
    ----------
    map : str
        Name of the map family.
    mesh : TriangleMesh
    face_surface : uint16 (faces,)
        Palette index.
    face_semantic : uint8 (faces,)
        `scenegen.classes.Semantic`.
    face_object : uint32 (faces,)
        Instance id, unique per object in the world; 0 is reserved for "nothing" (sky).
    corner_site : uint32 (faces, 3)
        Site of each corner of each face.
    sites : Sites
    palette : tuple of Surface
        At most four variants per material, so that the heat balance has few classes.
    ground : HeightField
    flight_box_m : ((float, float, float), (float, float, float))
        Lower and upper corner of the airspace flights may use.
    counts : tuple of (str, int)
        What was built, for listings: ("buildings", 231), ("trees", 410), ...
    movers : tuple of Mover
        What moves through it. Not part of the mesh; their surfaces are entries of the palette, their ids go on where
        those of the mesh end or lie among them.
    """

    map: str
    mesh: TriangleMesh
    face_surface: UInt16[np.ndarray, "faces"]
    face_semantic: UInt8[np.ndarray, "faces"]
    face_object: UInt32[np.ndarray, "faces"]
    corner_site: UInt32[np.ndarray, "faces 3"]
    sites: Sites
    palette: tuple[Surface, ...]
    ground: HeightField
    flight_box_m: tuple[tuple[float, float, float], tuple[float, float, float]]
    counts: tuple[tuple[str, int], ...]
    movers: tuple[Mover, ...] = ()
