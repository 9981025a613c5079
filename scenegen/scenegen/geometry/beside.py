"""Ground sites that a bin, a trunk, a hedge or a shrub stands on: moved beside it.

The lattice of the ground does not know what will stand on it. A site under a bin sees the bin alone, and interpolation
would carry that metres far into the lawn; beside it, it sees what the lawn around sees.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float64, Int64
from scipy.spatial import cKDTree

from scenegen.classes import SOLID_GROUND, Semantic
from scenegen.geometry.part import Part

_STANDING = (
    Semantic.TREE,
    Semantic.SHRUB,
    Semantic.PERSON,
    Semantic.POLE,
    Semantic.TRAFFIC_LIGHT,
    Semantic.SIGN,
    Semantic.FENCE,
    Semantic.BARRIER,
    Semantic.STREET_FURNITURE,
    Semantic.GOAL,
    Semantic.OTHER,
)
"""Along walls, kerbs and cars the ground has lines and rows of its own."""
_FOOT_M = 1.2
"""What of a thing counts as its foot: what begins no higher than this above its lowest point."""
_COVERED_M, _BESIDE_M = 0.5, 0.6
"""A site nearer to a foot than the first is moved until it is as far off as the second."""
_STEPS_M = (0.5, 0.8, 1.1, 1.5, 1.9, 2.4)
_TURNS = 12


def beside_things(part: Part) -> Part:
    """Move sites of the ground to the nearest place beside what stands on them.

    Only where rays start changes; vertices stay. A step follows the site's own plane; a site that finds no free
    place within 2.4 m stays.

    Parameters
    ----------
    part : Part
        A whole world.
    """
    site = _open_sites(part)
    foot = _foot_points(part, np.isin(part.semantic, _STANDING))
    if not len(foot) or not len(site):
        return part
    feet = cKDTree(foot)
    covered = np.isfinite(feet.query(part.site_position[site, :2], distance_upper_bound=_COVERED_M)[0])
    site = site[covered]
    step = _shortest_step(part.site_position[site, :2], feet)
    normal, position = part.site_normal[site], part.site_position.copy()
    position[site, :2] += step
    position[site, 2] -= (step * normal[:, :2]).sum(axis=1) / normal[:, 2]
    return replace(part, site_position=position)


def _open_sites(part: Part) -> Int64[np.ndarray, "sites"]:
    """Sites of the ground, but not those of lumps, which stand for what lies below a car."""
    site = np.unique(part.corner_site[np.isin(part.semantic, SOLID_GROUND)])
    return np.asarray(site[(part.site_normal[site, 2] > 0.5) & (part.site_standoff[site] < 0.05)])


def _foot_points(part: Part, standing: Bool[np.ndarray, "faces"]) -> Float64[np.ndarray, "points 2"]:
    """Middles of the lowest faces of things and corners of the larger ones, in the plan [m]."""
    owner, faces = part.object[standing], part.faces[standing]
    bottom = part.vertices[faces, 2].min(axis=1)
    lowest = np.full(int(part.object.max(initial=-1)) + 1, np.inf)
    np.minimum.at(lowest, owner, bottom)
    corners = part.vertices[faces[bottom < lowest[owner] + _FOOT_M], :2]
    middle = (corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0
    large = np.abs(corners[:, 0] - middle).max(axis=1) > 0.5 * _COVERED_M
    return np.concatenate([middle, corners[large].reshape(-1, 2)])


def _shortest_step(here: Float64[np.ndarray, "sites 2"], feet: cKDTree) -> Float64[np.ndarray, "sites 2"]:
    """The shortest step of each site to a place beside everything; zero where there is none."""
    angle = 2.0 * np.pi * np.arange(_TURNS) / _TURNS
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    step, left = np.zeros_like(here), np.arange(len(here))
    for reach in _STEPS_M:
        tried = here[left, None] + reach * ring
        away = feet.query(tried, distance_upper_bound=2.0 * _BESIDE_M)[0]
        best = np.argmax(away, axis=1)
        free = away[np.arange(len(left)), best] > _BESIDE_M
        step[left[free]] = reach * ring[best[free]]
        left = left[~free]
    return step
