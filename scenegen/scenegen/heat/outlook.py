"""The exposure of a world summed up for its thermal classes: mean sun visibility, sky and neighbours of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float16, Float32, Float64

from scenegen.exposure import Exposure
from scenegen.heat.classes import ThermalClasses
from scenegen.heat.emitters import EMITTER_GROUPS, group_classes
from scenegen.heat.forcing import Day
from scenegen.materials.material import Surface


@dataclass(frozen=True, eq=False)
class Outlook:
    """Area means over the sites of each class.

    Attributes
    ----------
    beam : float64 (classes, times)
        Visible sun times cosine of incidence at the exposure's sun times.
    sky : float64 (classes,)
        Share of open sky.
    neighbour : float64 (classes, groups)
        Share of each emitter group.
    membership : float64 (groups, classes)
        Share of each class in the area of a group; rows sum to one, or to zero where a group is absent.
    """

    beam: Float64[np.ndarray, "classes times"]
    sky: Float64[np.ndarray, "classes"]
    neighbour: Float64[np.ndarray, "classes groups"]
    membership: Float64[np.ndarray, "groups classes"]

    def beam_over(
        self, day: Day, sun_hour: Float64[np.ndarray, "times"]
    ) -> Float64[np.ndarray, "classes samples"]:
        """Mean beam at the samples of a day; zero in the night."""
        return np.asarray(np.einsum("ck,nk->cn", self.beam, day.spread(sun_hour)))

    @staticmethod
    def of(
        classes: ThermalClasses,
        palette: tuple[Surface, ...],
        exposure: Exposure,
        area: Float64[np.ndarray, "sites"],
    ) -> Outlook:
        """Means of an exposure; sums run in site order without threads, so they never vary."""
        count = classes.palette.size
        beam = np.zeros((count, exposure.sun_hour.size))
        sky = np.zeros(count)
        neighbour = np.zeros((count, EMITTER_GROUPS))
        for c in range(count):
            sites = classes.members(c)
            share = (area[sites] + 1e-9) / (area[sites] + 1e-9).sum()
            weight = share.astype(np.float32)
            beam[c] = np.einsum("s,st->t", weight, single(exposure.beam[sites]))
            neighbour[c] = np.einsum("s,sg->g", weight, exposure.neighbour_share[sites])
            sky[c] = np.einsum("s,s->", share, exposure.sky_view[sites].astype(np.float64))
        member = np.zeros((EMITTER_GROUPS, count))
        member[group_classes(palette, classes.palette, classes.orientation), np.arange(count)] = (
            classes.area_m2
        )
        total = member.sum(axis=1, keepdims=True)
        return Outlook(beam, sky, neighbour, member / np.where(total > 0.0, total, 1.0))


def single(half: Float16[np.ndarray, "*shape"]) -> Float32[np.ndarray, "*shape"]:
    """Finite halves >= 0 as float32, exactly; several times faster than numpy's own conversion.

    Exponent and mantissa move to their places in a float32, whose exponent counts from 127 instead of 15.
    """
    bits = half.view(np.uint16).astype(np.uint32)
    bits <<= np.uint32(13)
    values = bits.view(np.float32)
    values *= np.float32(2.0**112)
    return values
