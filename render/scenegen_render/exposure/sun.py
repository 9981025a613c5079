"""Which sites see the sun when: a ray test per site and step, and a search for the minute a shadow's edge passes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float16, Float32, Float64, Int64

from scenegen.climate.season import Season
from scenegen.climate.sun import daylight, sun_direction, sun_samples
from scenegen_render import backend
from scenegen_render.exposure.lanes import Together, launches
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
    if not count:
        return np.zeros((sites, 0), np.float16)
    caster = _SunCaster(loaded, rays, steps.fine_direction)
    lit = caster.at_step_ends(count + 1)
    normal = loaded.world.sites.normal[rays.order]
    beam = np.empty((sites, count), np.float16)
    for k in range(count):
        beam[:, k] = _cosine(normal, steps.direction[k]) * (lit[:, k] & lit[:, k + 1])
    place, step = np.nonzero(lit[:, :-1] != lit[:, 1:])
    start, stop = caster.lit_part(place, step * _FINE, lit[place, step])
    middle = steps.fine_direction[np.rint(0.5 * (start + stop)).astype(np.int64)]
    beam[place, step] = ((stop - start) / _FINE).astype(np.float32) * _cosine(normal[place], middle)
    found = np.empty_like(beam)
    found[rays.order] = beam
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
        self.scene, self.rays = loaded.scene, rays
        self.directions = backend.upload(directions.astype(np.float32))

    def at_step_ends(self, ends: int) -> Bool[np.ndarray, "sites ends"]:
        """Whether each place sees the sun at the beginning of the day, and at the end of each step."""
        mi, dr = backend.modules()
        sites = len(self.rays.order)
        lit = dr.empty(mi.Bool, sites * ends)
        width = dr.opaque(mi.UInt, ends)
        for lanes in launches(sites, ends, Together.PLACES_OF_A_ROW):
            seen = self._lit(lanes.place, lanes.row * _FINE, lanes.active)
            dr.scatter(lit, seen, lanes.place * width + lanes.row, lanes.active, mode=dr.ReduceMode.Permute)
            dr.eval(lit)
        return np.asarray(lit).reshape(sites, ends)

    def lit_part(
        self,
        place: Int64[np.ndarray, "changed"],
        first: Int64[np.ndarray, "changed"],
        lit_before: Bool[np.ndarray, "changed"],
    ) -> tuple[Float64[np.ndarray, "changed"], Float64[np.ndarray, "changed"]]:
        """First and last moment [eighths] of the lit part of steps at whose ends the answers differ.

        Parameters
        ----------
        place : int64 (changed,)
            Places whose sun appears or disappears.
        first : int64 (changed,)
            Beginning of the step [eighths].
        lit_before : bool (changed,)
            Whether they are lit at that beginning.
        """
        low = first.astype(np.uint32)
        where = backend.upload(place.astype(np.uint32))
        for halving in range(_HALVINGS if len(place) else 0):
            middle = low + np.uint32(_FINE >> (halving + 1))
            same = np.asarray(self._lit(where, backend.upload(middle), True)) == lit_before
            low = np.where(same, middle, low)
        edge = low.astype(np.float64) + 0.5
        begin = first.astype(np.float64)
        return np.where(lit_before, begin, edge), np.where(lit_before, edge, begin + _FINE)

    def _lit(self, place: Any, moment: Any, active: Any) -> Any:
        """Whether places (device) see the sun at moments [eighths, device]."""
        mi, dr = backend.modules()
        sun = dr.gather(mi.Vector3f, self.directions, moment, active)
        facing = dr.dot(dr.gather(mi.Vector3f, self.rays.normal, place, active), sun) > 0.0
        asked = facing & (sun.z > 0.0) & active
        blocked = self.scene.ray_test(self.rays.start(place, sun, asked), coherent=True, active=asked)
        return asked & ~blocked
