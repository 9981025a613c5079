"""A cross-section swept along a line: girders, barriers, rails. Each facet of it has a row of sites."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import STANDOFF_M, Part
from scenegen.geometry.patch import quads_to_triangles

_UP = np.array([0.0, 0.0, 1.0])


def sweep(
    line: Float64[np.ndarray, "stations 3"],
    profile: Float64[np.ndarray, "corners 2"],
    surface: Int64[np.ndarray, "facets"],
    semantic: Int64[np.ndarray, "facets"],
    owner: Int64[np.ndarray, "facets"],
    standoff_m: float = STANDOFF_M,
    lumped: bool = False,
) -> Part:
    """Sweep an open or closed profile along a line.

    Parameters
    ----------
    line : float64 (stations, 3)
        [m]; its plan must not turn sharply, its ends stay open.
    profile : float64 (corners, 2)
        To the right of the line and above it [m]; counter-clockwise looking along the line, so that facets face
        outwards. Repeat the first corner to close it.
    surface, semantic, owner : int64 (facets,)
        Labels of the facets between successive corners: ``facets = corners - 1``.
    standoff_m : float
        Of the sites.
    lumped : bool
        One site per station for all facets, looking up from the highest of them: for what is thin.

    Returns
    -------
    Part
        One site per station and facet, in the middle of the facet, unless lumped.
    """
    stations, facets = len(line), len(profile) - 1
    right = _right(line)
    corner = line[:, None] + profile[None, :, :1] * right[:, None] + profile[None, :, 1:] * _UP
    # stations, facets, 2, 3: facets share no vertices
    ends = np.stack([corner[:, :-1], corner[:, 1:]], axis=2)
    s, f = (g.ravel() for g in np.meshgrid(np.arange(stations - 1), np.arange(facets), indexing="ij"))
    here = 2 * (s * facets + f)
    after = here + 2 * facets
    quads = np.stack([here, after, after + 1, here + 1], axis=1)
    if lumped:
        return _labelled(
            ends, quads, np.stack([s, s + 1], axis=1), _lumps(ends), (surface, semantic, owner), standoff_m
        )
    step = np.diff(profile, axis=0)
    outward = np.column_stack([step[:, 1], -step[:, 0]]) / np.linalg.norm(step, axis=1)[:, None]
    normal = outward[None, :, :1] * right[:, None] + outward[None, :, 1:] * _UP
    rows = np.stack([s * facets + f, (s + 1) * facets + f], axis=1)
    sites = _inward(ends.mean(axis=2)).reshape(-1, 3), normal.reshape(-1, 3)
    return _labelled(ends, quads, rows, sites, (surface, semantic, owner), standoff_m)


def _inward(middle: np.ndarray) -> np.ndarray:
    """Sites of the two ends a little along the line: whatever it ends at must not touch them."""
    moved = middle.copy()
    moved[0] = 0.98 * middle[0] + 0.02 * middle[1]
    moved[-1] = 0.98 * middle[-1] + 0.02 * middle[-2]
    return moved


def _lumps(ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """One site for each station, on top of all facets, and its normal."""
    corners = ends.reshape(len(ends), -1, 3)
    position = corners.mean(axis=1)
    position[:, 2] = corners[..., 2].max(axis=1)
    return _inward(position), np.tile(_UP, (len(ends), 1))


def _labelled(
    ends: np.ndarray,
    quads: np.ndarray,
    site: np.ndarray,
    sites: tuple[np.ndarray, np.ndarray],
    labels: tuple[np.ndarray, np.ndarray, np.ndarray],
    standoff_m: float,
) -> Part:
    """Part of quads, whose facets run fastest; `site` at the near and the far end of each."""
    facet = np.arange(len(quads)) % ends.shape[1]
    surface, semantic, owner = (np.repeat(np.asarray(v)[facet], 2) for v in labels)
    return Part(
        vertices=ends.reshape(-1, 3),
        faces=quads_to_triangles(quads),
        surface=surface,
        semantic=semantic,
        object=owner,
        corner_site=quads_to_triangles(site[:, [0, 1, 1, 0]]),
        site_position=sites[0],
        site_normal=sites[1],
        site_standoff=np.full(len(sites[0]), standoff_m),
    )


def _right(line: np.ndarray) -> np.ndarray:
    """Level unit vectors to the right of the line at its stations."""
    step = np.gradient(line[:, :2], axis=0)
    step /= np.linalg.norm(step, axis=1)[:, None]
    return np.column_stack([step[:, 1], -step[:, 0], np.zeros(len(step))])
