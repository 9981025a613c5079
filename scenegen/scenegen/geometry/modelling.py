"""Building blocks for templates: boxes, tubes and quads with a slot, a class and a few sites each."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import LUMP_STANDOFF_M, STANDOFF_M, face_normals
from scenegen.geometry.rings import around
from scenegen.geometry.template import Template


class Modeller:
    """Collects pieces of a template."""

    def __init__(self) -> None:
        self._pieces: list[tuple[np.ndarray, np.ndarray, int, int, np.ndarray]] = []
        self._sites: list[tuple[np.ndarray, np.ndarray, float]] = []

    def site(self, position: np.ndarray, normal: np.ndarray, standoff_m: float = STANDOFF_M) -> int:
        """Add a thermal site; returns its index."""
        normal = np.asarray(normal, np.float64)
        self._sites.append((np.asarray(position, np.float64), normal / np.linalg.norm(normal), standoff_m))
        return len(self._sites) - 1

    def mesh(
        self,
        vertices: Float64[np.ndarray, "vertices 3"],
        faces: Int64[np.ndarray, "faces 3"],
        slot: int,
        semantic: int,
        corner_site: Int64[np.ndarray, "faces 3"],
    ) -> None:
        """Add triangles with given sites."""
        self._pieces.append((vertices, faces, slot, int(semantic), corner_site))

    def quads(
        self,
        corners: Float64[np.ndarray, "quads 4 3"],
        slot: int,
        semantic: int,
        standoff_m: float = STANDOFF_M,
    ) -> None:
        """Add flat quads, counter-clockwise from outside, one site each."""
        count = len(corners)
        faces = np.arange(4 * count).reshape(-1, 4)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
        normals, _ = face_normals(corners.reshape(-1, 3), faces)
        normals = normals[::2] + normals[1::2]
        sites = [self.site(c.mean(axis=0), n, standoff_m) for c, n in zip(corners, normals, strict=True)]
        corner_site = np.repeat(np.repeat(np.array(sites), 2)[:, None], 3, axis=1)
        self.mesh(corners.reshape(-1, 3), faces, slot, semantic, corner_site)

    def box(
        self,
        low: tuple[float, float, float],
        high: tuple[float, float, float],
        slot: int,
        semantic: int,
        standoff_m: float = STANDOFF_M,
        covered: bool = False,
    ) -> None:
        """Add an upright box without underside, one site per side; a covered one has no upper side either."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        p = np.array([[x0, y0, z0], [x1, y0, z0], [x1, y1, z0], [x0, y1, z0]], np.float64)
        corners = np.concatenate([p, p + np.array([0, 0, z1 - z0])])
        sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]]
        self.quads(corners[sides[:4] if covered else sides], slot, semantic, standoff_m)

    def tube(
        self,
        start: np.ndarray,
        end: np.ndarray,
        radius_start_m: float,
        radius_end_m: float,
        slot: int,
        semantic: int,
        sides: int = 6,
        sites: int = 1,
    ) -> None:
        """Add a tapered tube without lids; `sites` lumped sites around its middle."""
        start, end = np.asarray(start, np.float64), np.asarray(end, np.float64)
        axis = (end - start) / np.linalg.norm(end - start)
        ring = around(axis, sides)
        vertices = np.concatenate([start + radius_start_m * ring, end + radius_end_m * ring])
        k, after = np.arange(sides), (np.arange(sides) + 1) % sides
        quads = np.stack([k, after, after + sides, k + sides], axis=1)
        radius, middle = (radius_start_m + radius_end_m) / 2, (start + end) / 2
        first = len(self._sites)
        for out in around(axis, sites, turned=0.5):
            self.site(middle + radius * out, out, LUMP_STANDOFF_M)
        site = first + (k * sites) // sides
        self.mesh(
            vertices,
            quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3),
            slot,
            semantic,
            np.repeat(np.repeat(site, 2)[:, None], 3, axis=1),
        )

    def finish(self) -> Template:
        """The template."""
        start = np.cumsum([0, *(len(p[0]) for p in self._pieces)])
        return Template(
            vertices=np.concatenate([p[0] for p in self._pieces]).astype(np.float64),
            faces=np.concatenate([p[1] + s for p, s in zip(self._pieces, start[:-1], strict=True)]),
            slot=np.concatenate([np.full(len(p[1]), p[2]) for p in self._pieces]),
            semantic=np.concatenate([np.full(len(p[1]), p[3]) for p in self._pieces]),
            corner_site=np.concatenate([p[4] for p in self._pieces]),
            site_position=np.array([s[0] for s in self._sites]),
            site_normal=np.array([s[1] for s in self._sites]),
            site_standoff=np.array([s[2] for s in self._sites]),
        )
