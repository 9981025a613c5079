"""Temperatures of single sites, expanded in what each of them sees around two solutions of their class."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int64

from scenegen.exposure import Exposure
from scenegen.heat.balance import DaySolution
from scenegen.heat.class_days import ClassDays
from scenegen.heat.forcing import Day
from scenegen.heat.outlook import Outlook, single


@dataclass(frozen=True, eq=False)
class Expansion:
    """``T = base + beam @ per_beam + sky * per_sky + neighbour_share @ per_neighbour`` [K], one row per class.

    Attributes
    ----------
    base : float32 (classes,)
    per_beam : float32 (classes, times)
        For the exposure's beam at its sun times.
    per_sky : float32 (classes,)
        Open sky instead of ground at air temperature.
    per_neighbour : float32 (classes, groups)
        Each emitter group instead of ground at air temperature.
    full_sun : float32 (classes,)
        What ``beam @ per_beam`` is for an unobstructed site.
    """

    base: Float32[np.ndarray, "classes"]
    per_beam: Float32[np.ndarray, "classes times"]
    per_sky: Float32[np.ndarray, "classes"]
    per_neighbour: Float32[np.ndarray, "classes groups"]
    full_sun: Float32[np.ndarray, "classes"]

    @staticmethod
    def of(
        solution: DaySolution,
        felt: Float64[np.ndarray, "classes samples"],
        cos_sun: Float64[np.ndarray, "classes samples"],
        days: ClassDays,
        day: Day,
        outlook: Outlook,
        sun_hour: Float64[np.ndarray, "times"],
    ) -> Expansion:
        """Expand around class solutions that were made with the beam ``direct * cos_sun``; `felt` is their memory."""
        traits, near = days.traits, days.neighbours
        short, long = traits.absorptance[:, None] * felt, traits.skins.emissivity[:, None] * felt
        beam = short * traits.direct_factor[:, None] * day.direct_Wm2
        ground = _felt(short, day.ground_short_Wm2[None]) + _felt(long, day.ground_long_Wm2[None])
        sky = (_felt(short, day.diffuse_Wm2[None]) + _felt(long, day.sky_Wm2[None]) - ground)[:, 0]
        neighbour = _felt(short, near.short_Wm2) + _felt(long, near.long_Wm2) - ground
        usual = np.einsum("cn,cn->c", beam, cos_sun) + sky * outlook.sky
        usual = usual + np.einsum("cg,cg->c", neighbour, outlook.neighbour)
        return Expansion(
            base=_single(solution.temperature_K[:, 0] - usual),
            per_beam=_single(np.einsum("cn,nk->ck", beam, day.spread(sun_hour))),
            per_sky=_single(sky),
            per_neighbour=_single(neighbour),
            full_sun=_single(np.einsum("cn,cn->c", beam, days.cos_sun)),
        )

    def sun_K(self, c: int, beam: Float32[np.ndarray, "members times"]) -> Float32[np.ndarray, "members"]:
        """Part of the temperature that the visible sun is responsible for [K]."""
        return np.asarray(np.einsum("st,t->s", beam, self.per_beam[c]))

    def rest_K(
        self, c: int, sky: Float32[np.ndarray, "members"], share: Float32[np.ndarray, "members groups"]
    ) -> Float32[np.ndarray, "members"]:
        """Everything but the sun [K]."""
        return np.asarray(
            self.base[c] + sky * self.per_sky[c] + np.einsum("sg,g->s", share, self.per_neighbour[c])
        )


def site_temperatures(
    lit: Expansion, shaded: Expansion, c: int, exposure: Exposure, sites: Int64[np.ndarray, "members"]
) -> Float32[np.ndarray, "members"]:
    """Temperatures [K] of sites of class `c`: two expansions, blended by how much of the full sun a site has had.

    Rows are summed by `einsum`, in a fixed order and without a threaded linear algebra library, so the bytes do not
    depend on how many threads there are.
    """
    beam = single(exposure.beam[sites])
    sky, share = exposure.sky_view[sites], exposure.neighbour_share[sites]
    warm, cool = lit.sun_K(c, beam), shaded.sun_K(c, beam)
    warmest, coolest = lit.full_sun[c], shaded.full_sun[c]
    a, b = lit.rest_K(c, sky, share) + warmest, shaded.rest_K(c, sky, share)
    if min(warmest, coolest) < _LEAST_SUN_K:
        return np.asarray(b + cool, dtype=np.float32)
    s = np.clip(0.5 * (warm / warmest + cool / coolest), 0.0, 1.0)
    # Cubic through both ends with both slopes, plus what the timing of a site's sun differs from s times the full sun.
    bend = coolest * (1.0 - s) - warmest * s + (a - b) * (2.0 * s - 1.0)
    timing = s * (warm - s * warmest) + (1.0 - s) * (cool - s * coolest)
    return np.asarray(b + s * (a - b) + s * (1.0 - s) * bend + timing, dtype=np.float32)


_LEAST_SUN_K = np.float32(1e-3)
"""With less than that from the sun both expansions are the same."""


def _felt(
    weight: Float64[np.ndarray, "classes samples"], flux_Wm2: Float64[np.ndarray, "fluxes samples"]
) -> Float64[np.ndarray, "classes fluxes"]:
    return np.asarray(np.einsum("cn,fn->cf", weight, flux_Wm2))


def _single(values: Float64[np.ndarray, "*shape"]) -> Float32[np.ndarray, "*shape"]:
    return np.asarray(values, dtype=np.float32)
