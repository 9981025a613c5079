"""Geometry meets sun and sky: what every site of a world sees, computed once per world by the renderer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float16, Float32, Float64, Int64, UInt32
from scipy import sparse

from scenegen.climate.season import Season

SKY_BINS = 1024
"""Sky entries of the gather list: equal steps of sqrt(sin(elevation)), bin 0 at and below the horizon."""


@dataclass(frozen=True, eq=False)
class CloserList:
    """A gather list of some sites only, with more rays than all others have.

    Attributes
    ----------
    site : int64 (some,)
        Which sites, each at most once.
    gather : uint32 (directions, some)
        As in `Exposure`: site indices, or the number of all sites plus a sky bin.
    """

    site: Int64[np.ndarray, "some"]
    gather: UInt32[np.ndarray, "directions some"]


@dataclass(frozen=True, eq=False)
class Exposure:
    """What the sites of one world see.

    Attributes
    ----------
    season : Season
        Latitude and date the sun belongs to.
    sun_hour : float64 (times,)
        Local mean solar time [h] of each sun position (only those above the horizon), increasing.
    sun_direction : float64 (times, 3)
        Unit vectors towards the sun, ENU.
    beam : float16 (sites, times)
        Visible share of the sun times max(0, cos incidence), 0..1. Constant half a step around each time.
    sky_view : float32 (sites,)
        Cosine-weighted share of the hemisphere that is open sky.
    gather : uint32 (directions, sites)
        What each cosine-distributed ray meets: a site index, or ``sites + bin`` for sky (see `SKY_BINS`). All
        directions weigh the same.
    neighbour_share : float32 (sites, groups)
        Cosine-weighted share of the hemisphere taken by each emitter group of `scenegen.heat.emitters`.
    smoother : scipy.sparse.csr_array (sites, sites) or None
        Averages what was summed over the gather list along facets; rows sum to one. `sky_view` and `neighbour_share`
        have been through it.
    closer : tuple of CloserList
        Sites that one flight shows, looked at with more rays: `sky_view` and `neighbour_share` of these come from
        there, unsmoothed, and so does their irradiance. No site is in two of them.
    """

    season: Season
    sun_hour: Float64[np.ndarray, "times"]
    sun_direction: Float64[np.ndarray, "times 3"]
    beam: Float16[np.ndarray, "sites times"]
    sky_view: Float32[np.ndarray, "sites"]
    gather: UInt32[np.ndarray, "directions sites"]
    neighbour_share: Float32[np.ndarray, "sites groups"]
    smoother: sparse.csr_array | None = None
    closer: tuple[CloserList, ...] = ()


def sky_bin_sin_elevation() -> Float64[np.ndarray, "bins"]:
    """Sine of the elevation at the middle of each sky bin."""
    return np.asarray(((np.arange(SKY_BINS) + 0.5) / SKY_BINS) ** 2)
