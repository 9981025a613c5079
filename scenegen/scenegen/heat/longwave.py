"""Radiation between neighbours: what each emitter group sends out over the day, long-wave and reflected sun."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.heat.forcing import Day
from scenegen.radiometry.planck import STEFAN_BOLTZMANN


@dataclass(frozen=True, eq=False)
class Neighbours:
    """Radiosity of the emitter groups over the day; groups absent from the world are ground at air temperature.

    Attributes
    ----------
    short_Wm2, long_Wm2 : float64 (groups, samples)
    """

    short_Wm2: Float64[np.ndarray, "groups samples"]
    long_Wm2: Float64[np.ndarray, "groups samples"]

    @staticmethod
    def unknown(day: Day, groups: int) -> Neighbours:
        """Ground at air temperature in every direction: the start of the exchange."""
        shape = (groups, day.hour.size)
        return Neighbours(
            np.array(np.broadcast_to(day.ground_short_Wm2, shape)),
            np.array(np.broadcast_to(day.ground_long_Wm2, shape)),
        )

    @staticmethod
    def of(
        day: Day,
        membership: Float64[np.ndarray, "groups classes"],
        temperature_K: Float64[np.ndarray, "classes samples"],
        emissivity: Float64[np.ndarray, "classes"],
        absorptance: Float64[np.ndarray, "classes"],
        short_Wm2: Float64[np.ndarray, "classes samples"],
        long_Wm2: Float64[np.ndarray, "classes samples"],
    ) -> Neighbours:
        """Radiosity from class-mean temperatures and irradiances.

        Parameters
        ----------
        day : Day
        membership : float64 (groups, classes)
            Share of each class in a group's area; rows sum to one, or to zero for an absent group.
        temperature_K, emissivity, absorptance
            Of the classes.
        short_Wm2, long_Wm2 : float64 (classes, samples)
            Mean short-wave and long-wave irradiance on each class; the part not absorbed is reflected diffusely.
        """
        emitted = (
            emissivity[:, None] * STEFAN_BOLTZMANN * temperature_K**4 + (1.0 - emissivity)[:, None] * long_Wm2
        )
        reflected = (1.0 - absorptance)[:, None] * short_Wm2
        absent = (membership.sum(axis=1) == 0.0)[:, None]
        return Neighbours(
            np.where(absent, day.ground_short_Wm2, np.einsum("gc,cn->gn", membership, reflected)),
            np.where(absent, day.ground_long_Wm2, np.einsum("gc,cn->gn", membership, emitted)),
        )
