"""The fixed scale between radiance and 14-bit counts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float32, Float64, UInt16

from scenegen.radiometry.planck import band_radiance, brightness_temperature
from scenegen_render.sensor.knobs import SensorKnobs

MAX_COUNT = 16_383
"""Largest value of a 14-bit converter."""

_TEMPERATURE_NODES = 8192


@dataclass(frozen=True)
class CountScale:
    """What a count means. One scale for a whole dataset.

    Attributes
    ----------
    low_K, high_K : float
        Blackbody temperatures of count 0 and of count 16,383 [K].
    band_um : (float, float)
        Spectral band [um].
    linear_in : "radiance" or "temperature"
        What the counts are proportional to.
    """

    low_K: float
    high_K: float
    band_um: tuple[float, float] = (8.0, 14.0)
    linear_in: Literal["radiance", "temperature"] = "radiance"

    @classmethod
    def of(cls, knobs: SensorKnobs, band_um: tuple[float, float]) -> CountScale:
        """Scale of a recipe's sensor on a camera's band."""
        return cls(*knobs.scale_K, band_um, knobs.linear_in)

    @property
    def ends(self) -> tuple[float, float]:
        """Band radiance of count 0 and of count 16,383 [W m^-2 sr^-1]."""
        return _ends(self.low_K, self.high_K, self.band_um)


def radiance_to_counts(
    radiance: Float32[np.ndarray, "*shape"], scale: CountScale
) -> UInt16[np.ndarray, "*shape"]:
    """Digitise: round to the nearest count, clip at both ends.

    Parameters
    ----------
    radiance : float32
        Band radiance [W m^-2 sr^-1], finite.
    """
    if scale.linear_in == "radiance":
        low, high = scale.ends
        levels = (radiance - np.float32(low)) * np.float32(MAX_COUNT / (high - low))
    else:
        nodes_L, nodes_count = _temperature_curve(scale)
        levels = np.interp(radiance, nodes_L, nodes_count).astype(np.float32)
    np.rint(levels, out=levels)
    np.clip(levels, 0.0, MAX_COUNT, out=levels)
    return levels.astype(np.uint16)


def counts_to_radiance(
    counts: UInt16[np.ndarray, "*shape"], scale: CountScale
) -> Float32[np.ndarray, "*shape"]:
    """Band radiance [W m^-2 sr^-1] at the middle of each count."""
    return np.asarray(_decoded(scale)[0][counts])


def counts_to_brightness_K(
    counts: UInt16[np.ndarray, "*shape"], scale: CountScale
) -> Float32[np.ndarray, "*shape"]:
    """Brightness temperature [K] at the middle of each count: of the blackbody that would read the same."""
    return np.asarray(_decoded(scale)[1][counts])


@lru_cache(maxsize=8)
def _ends(low_K: float, high_K: float, band_um: tuple[float, float]) -> tuple[float, float]:
    """Kept because every frame asks for them, and the integral over the band takes a tenth of a small frame's time."""
    low, high = band_radiance(np.array([low_K, high_K]), band_um)
    return float(low), float(high)


@lru_cache(maxsize=8)
def _temperature_curve(
    scale: CountScale,
) -> tuple[Float64[np.ndarray, "nodes"], Float64[np.ndarray, "nodes"]]:
    """Radiance and (real-valued) count of a temperature-linear scale, dense enough for 1e-3 count."""
    T = np.linspace(scale.low_K, scale.high_K, _TEMPERATURE_NODES)
    return band_radiance(T, scale.band_um), np.linspace(0.0, MAX_COUNT, _TEMPERATURE_NODES)


@lru_cache(maxsize=8)
def _decoded(scale: CountScale) -> tuple[Float32[np.ndarray, "counts"], Float32[np.ndarray, "counts"]]:
    """Radiance and brightness temperature of every count."""
    counts = np.arange(MAX_COUNT + 1) / MAX_COUNT
    if scale.linear_in == "radiance":
        low, high = scale.ends
        L = low + counts * (high - low)
        T = brightness_temperature(L, scale.band_um)
    else:
        T = scale.low_K + counts * (scale.high_K - scale.low_K)
        L = band_radiance(T, scale.band_um)
    tables = L.astype(np.float32), T.astype(np.float32)
    for table in tables:
        table.flags.writeable = False
    return tables
