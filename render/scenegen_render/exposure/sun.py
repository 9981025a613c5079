"""Which sites see the sun when: a ray test per site and step, and a search for the minute a shadow's edge passes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float16, Float32, Float64, Int64

from scenegen.climate.season import Season
from scenegen.climate.sun import daylight, sun_direction, sun_samples
from scenegen_render import backend
from scenegen_render.exposure.rays import SiteRays
from scenegen_render.scene import LoadedWorld

_HALVINGS = 3
_FINE = 2**_HALVINGS
"""Parts of a step among which the passage of a shadow's edge is told apart."""


@dataclass(frozen=True, eq=False)
class SunSteps:
    """The daylight of a date cut into equal steps.

    Attributes
    ----------
    hour : float64 (steps,)
        Middle of each step [h], local mean solar time.
    direction : float64 (steps, 3)
        Towards the sun at that hour.
    fine_direction : float64 (steps * 8 + 1, 3)
        Towards the sun at the ends of the eighths of the steps.
    """

    hour: Float64[np.ndarray, "steps"]
    direction: Float64[np.ndarray, "steps 3"]
    fine_direction: Float64[np.ndarray, "fine 3"]

    @staticmethod
    def of(season: Season, longest_min: float) -> SunSteps:
        """Steps of at most `longest_min` minutes; none in the polar night."""
        light = daylight(season)
        if light is None or light[1] - light[0] < 1e-6:
            return SunSteps(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)))
        count = int(np.ceil((light[1] - light[0]) * 60.0 / longest_min))
        hour, direction = sun_samples(season, count)
        if len(hour) != count:
            raise AssertionError("the sun is below the horizon within its own daylight")
        fine = np.linspace(light[0], light[1], count * _FINE + 1)
        return SunSteps(hour, direction, sun_direction(season, fine))


def sun_beam(loaded: LoadedWorld, rays: SiteRays, steps: SunSteps) -> Float16[np.ndarray, "sites steps"]:
    """Share of each step in which a site sees the sun, times the cosine of incidence while it does.

    The sun is asked for at the ends of the steps. Where the answers differ, the moment in between is found by halving,
    to a sixteenth of a step: shadow edges then move smoothly over the ground instead of jumping from step to step.
    """
    sites, count = len(rays.order), len(steps.hour)
    beam = np.zeros((count, sites), np.float16)
    normal = loaded.world.sites.normal[rays.order]
    caster = _SunCaster(loaded, rays, steps.fine_direction)
    before = caster.lit_all(0) if count else np.zeros(sites, bool)
    for k in range(count):
        after = caster.lit_all((k + 1) * _FINE)
        beam[k] = _cosine(normal, steps.direction[k]) * (before & after)
        changed = np.flatnonzero(before != after)
        start, stop = caster.lit_part(changed, k * _FINE, before[changed])
        middle = steps.fine_direction[np.rint(0.5 * (start + stop)).astype(np.int64)]
        share = ((stop - start) / _FINE).astype(np.float32)
        beam[k, changed] = share * _cosine(normal[changed], middle)
        before = after
    found = np.empty((sites, count), np.float16)
    found[rays.order] = beam.T
    return found


def _cosine(
    normal: Float32[np.ndarray, "some 3"], direction: Float64[np.ndarray, "*some 3"]
) -> Float32[np.ndarray, "some"]:
    """max(0, cos incidence), summed in a fixed order."""
    s = np.atleast_2d(direction).astype(np.float32)
    cosine = normal[:, 0] * s[:, 0] + normal[:, 1] * s[:, 1] + normal[:, 2] * s[:, 2]
    return np.asarray(np.maximum(cosine, np.float32(0.0)))


class _SunCaster:
    """Asks whether places of the spatial order see the sun at given ends of eighths."""

    def __init__(
        self, loaded: LoadedWorld, rays: SiteRays, directions: Float64[np.ndarray, "fine 3"]
    ) -> None:
        mi, dr = backend.modules()
        self.scene, self.rays = loaded.scene, rays
        self.directions = mi.Float(directions.astype(np.float32).reshape(-1))
        self.everywhere = dr.arange(mi.UInt, len(rays.order))
        dr.eval(self.everywhere)

    def lit_all(self, moment: int) -> Bool[np.ndarray, "sites"]:
        """Whether each place sees the sun at one moment."""
        mi, dr = backend.modules()
        return self._lit(self.everywhere, dr.opaque(mi.UInt, moment), coherent=True)

    def lit_part(
        self, place: Int64[np.ndarray, "changed"], first: int, lit_before: Bool[np.ndarray, "changed"]
    ) -> tuple[Float64[np.ndarray, "changed"], Float64[np.ndarray, "changed"]]:
        """First and last moment [eighths] of the lit part of the step that begins at `first`, where its ends differ.

        Parameters
        ----------
        place : int64 (changed,)
            Places whose sun appears or disappears within the step.
        first : int
            Beginning of the step [eighths].
        lit_before : bool (changed,)
            Whether they are lit at that beginning.
        """
        mi, _ = backend.modules()
        low = np.full(len(place), first, np.uint32)
        where = mi.UInt(place.astype(np.uint32))
        for halving in range(_HALVINGS if len(place) else 0):
            middle = low + np.uint32(_FINE >> (halving + 1))
            same = self._lit(where, mi.UInt(middle), coherent=False) == lit_before
            low = np.where(same, middle, low)
        edge = low.astype(np.float64) + 0.5
        return np.where(lit_before, first, edge), np.where(lit_before, edge, first + _FINE)

    def _lit(self, place: Any, moment: Any, coherent: bool) -> Bool[np.ndarray, "places"]:
        mi, dr = backend.modules()
        sun = dr.gather(mi.Vector3f, self.directions, moment)
        faces = (sun.z > 0.0) & (dr.dot(dr.gather(mi.Vector3f, self.rays.normal, place), sun) > 0.0)
        blocked = self.scene.ray_test(self.rays.start(place, sun, faces), coherent=coherent, active=faces)
        return np.asarray(faces & ~blocked)
