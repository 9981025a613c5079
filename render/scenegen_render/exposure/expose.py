"""Exposure of a world: sun visibility over a date, sky view, and what surrounds every site."""

from __future__ import annotations

import numpy as np

from scenegen.climate.season import Season
from scenegen.exposure import Exposure
from scenegen.heat.emitters import group_sites
from scenegen_render.exposure.facets import FacetAverage
from scenegen_render.exposure.hemisphere import gather_list
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.exposure.sun import SunSteps, sun_beam
from scenegen_render.exposure.views import shares
from scenegen_render.scene import LoadedWorld


def expose(
    loaded: LoadedWorld, season: Season, rng: np.random.Generator, knobs: ExposureKnobs | None = None
) -> Exposure:
    """Compute what every site of a world sees. Geometry only: weather, hour and band come later.

    Parameters
    ----------
    loaded : LoadedWorld
        Movers are not part of it; they neither shade nor warm the world.
    season : Season
        Decides where the sun stands.
    rng : numpy.random.Generator
        Turns the direction set of each site; two generators give exposures that differ by their random error only.
    knobs : ExposureKnobs, optional

    Returns
    -------
    Exposure
    """
    knobs = knobs or ExposureKnobs()
    world = loaded.world
    steps = SunSteps.of(season, knobs.sun_step_min)
    for_sun, for_hemisphere = SiteRays.of(world)
    beam = sun_beam(loaded, for_sun, steps)
    turn = rng.random(len(world.sites.area), dtype=np.float32)
    gather = gather_list(loaded, for_hemisphere, knobs.directions, turn)
    group, groups = group_sites(world)
    sky, share = shares(gather, group, groups)
    average = FacetAverage.of(world, gather) if knobs.smoothing else None
    if average is not None:
        sky, share = average(sky), average(share)
    return Exposure(
        season=season,
        sun_hour=steps.hour,
        sun_direction=steps.direction,
        beam=beam,
        sky_view=sky,
        gather=gather,
        neighbour_share=share,
        smoother=average.weights if average is not None else None,
    )
