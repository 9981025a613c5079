"""Templates and their copies: a car, a tree, a lamp is modelled once and baked into the world many times.

Copies are plain triangles: renderers trace merged meshes far faster than instances.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import Part


@dataclass(frozen=True, eq=False)
class Template:
    """A small model around its own origin, standing on z = 0, facing +x.

    Attributes
    ----------
    vertices : float64 (vertices, 3)
    faces : int64 (faces, 3)
    slot : int64 (faces,)
        Which of the copy's surfaces a face wears (paint, glass, rubber ...).
    semantic : int64 (faces,)
    corner_site : int64 (faces, 3)
    site_position, site_normal : float64 (sites, 3)
    site_standoff : float64 (sites,)
    """

    vertices: Float64[np.ndarray, "vertices 3"]
    faces: Int64[np.ndarray, "faces 3"]
    slot: Int64[np.ndarray, "faces"]
    semantic: Int64[np.ndarray, "faces"]
    corner_site: Int64[np.ndarray, "faces 3"]
    site_position: Float64[np.ndarray, "sites 3"]
    site_normal: Float64[np.ndarray, "sites 3"]
    site_standoff: Float64[np.ndarray, "sites"]


def place(
    template: Template,
    position: Float64[np.ndarray, "copies 3"],
    heading_rad: Float64[np.ndarray, "copies"],
    scale: Float64[np.ndarray, "copies 3"],
    surfaces: Int64[np.ndarray, "copies slots"],
    owner: Int64[np.ndarray, "copies"],
    slope: Float64[np.ndarray, "copies 2"] | None = None,
) -> Part:
    """Bake copies.

    Parameters
    ----------
    template : Template
    position : float64 (copies, 3)
        Of the template's origin [m].
    heading_rad : float64 (copies,)
        Counter-clockwise from east.
    scale : float64 (copies, 3)
        Along the template's own axes.
    surfaces : int64 (copies, slots)
        Palette index for each slot.
    owner : int64 (copies,)
        Instance ids.
    slope : float64 (copies, 2), optional
        Rise of the ground per metre east and north; the copy is sheared onto it, as a car stands on a hill.
    """
    copies = len(position)
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    zero, one = np.zeros(copies), np.ones(copies)
    turn = np.stack([np.stack([c, -s, zero]), np.stack([s, c, zero]), np.stack([zero, zero, one])])
    turn = turn.transpose(2, 0, 1)

    def moved(points: np.ndarray) -> np.ndarray:
        local = points[None] * scale[:, None, :]
        world = np.einsum("nij,nkj->nki", turn, local)
        if slope is not None:
            world[..., 2] += (world[..., :2] * slope[:, None, :]).sum(axis=2)
        return np.asarray(world + position[:, None, :])

    normal = np.einsum("nij,nkj->nki", turn, template.site_normal[None] / scale[:, None, :])
    normal /= np.linalg.norm(normal, axis=2)[..., None]
    faces, sites = len(template.faces), len(template.site_position)
    shift = np.arange(copies)[:, None, None]
    return Part(
        vertices=moved(template.vertices).reshape(-1, 3),
        faces=(template.faces[None] + shift * len(template.vertices)).reshape(-1, 3),
        surface=surfaces[:, template.slot].ravel(),
        semantic=np.tile(template.semantic, copies),
        object=np.repeat(owner, faces),
        corner_site=(template.corner_site[None] + shift * sites).reshape(-1, 3),
        site_position=moved(template.site_position).reshape(-1, 3),
        site_normal=normal.reshape(-1, 3),
        site_standoff=np.tile(template.site_standoff, copies),
    )
