"""Sites that something else stands on: moved to where they see what the surface around them sees.

A lattice knows nothing of the chimney that pierces it. A site inside sees bricks alone, and interpolation would
spread that over all triangles around it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.geometry.part import Part

_UPRIGHT = 0.2
_UPHILL = -0.3
"""Sites are not moved against the horizontal part of their normal by more than this: beyond the ridge."""


def push_out(part: Part, plans: np.ndarray, margin_m: float) -> Part:
    """Move sites out of what stands on the surface, the shortest way along their own planes; upright faces keep theirs.

    Parameters
    ----------
    part : Part
    plans : array of shapely.Polygon
        Rectangles in the plan.
    margin_m : float
        Distance kept from them [m].
    """
    centre, along, size = _frames(plans)
    wide = shapely.buffer(plans, margin_m, join_style="mitre")
    here = np.flatnonzero(part.site_normal[:, 2] > _UPRIGHT)
    site, thing = shapely.STRtree(wide).query(
        shapely.points(part.site_position[here, :2]), predicate="within"
    )
    site = here[site]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    sides = np.stack([along, -along, across, -across], axis=1)[thing]
    out = part.site_position[site, :2] - centre[thing]
    way = np.repeat(size[thing] / 2 + margin_m, 2, axis=1) - np.einsum("pdk,pk->pd", sides, out)
    normal = part.site_normal[site]
    level = np.maximum(np.linalg.norm(normal[:, :2], axis=1), 0.05)
    uphill = np.einsum("pdk,pk->pd", sides, normal[:, :2]) < _UPHILL * level[:, None]
    pick, best = np.arange(len(site)), np.argmin(np.where(uphill, np.inf, way), axis=1)
    step = sides[pick, best] * way[pick, best][:, None]
    position = part.site_position.copy()
    position[site, :2] += step
    position[site, 2] -= (step * normal[:, :2]).sum(axis=1) / normal[:, 2]
    return replace(part, site_position=position)


def _frames(
    plans: np.ndarray,
) -> tuple[Float64[np.ndarray, "things 2"], Float64[np.ndarray, "things 2"], Float64[np.ndarray, "things 2"]]:
    """Middle, unit vector along one side, and size along and across it [m] of rectangles."""
    corners = shapely.get_coordinates(plans).reshape(len(plans), 5, 2)
    along, across = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1]
    size = np.stack([np.linalg.norm(along, axis=1), np.linalg.norm(across, axis=1)], axis=1)
    return corners[:, :4].mean(axis=1), along / size[:, :1], size
