"""Waves of the sea: a wind sea with a JONSWAP spectrum and an old swell, as a sum of plane waves.

Hasselmann et al. 1973, Measurements of wind-wave growth and swell decay during the Joint North Sea Wave Project:
growth with fetch, and the peaked spectrum; dispersion of deep water; spreading as cos^2s of half the angle (Longuet-
Higgins et al. 1963).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

GRAVITY_mps2 = 9.81
_PEAK_ENHANCEMENT = 3.3
_WAVES, _SWELL_WAVES = 56, 7
_SWELL_LENGTH_M = (55.0, 120.0)
_BLOCK = 65_536


@dataclass(frozen=True, eq=False)
class Waves:
    """A frozen sea.

    Attributes
    ----------
    wave_vector : float64 (waves, 2)
        [rad/m].
    phase, amplitude_m : float64 (waves,)
    """

    wave_vector: Float64[np.ndarray, "waves 2"]
    phase: Float64[np.ndarray, "waves"]
    amplitude_m: Float64[np.ndarray, "waves"]

    @property
    def significant_m(self) -> float:
        """Four times the standard deviation of the surface [m]."""
        return float(4.0 * np.sqrt((self.amplitude_m**2).sum() / 2.0))

    def elevation(
        self, xy: Float64[np.ndarray, "points 2"], cell_m: Float64[np.ndarray, "points"]
    ) -> Float64[np.ndarray, "points"]:
        """Height of the surface [m] on deep water, without the waves a mesh of the given cells could not carry."""
        length = 2 * np.pi / np.linalg.norm(self.wave_vector, axis=1)
        height = np.zeros(len(xy))
        for start in range(0, len(xy), _BLOCK):
            part = slice(start, start + _BLOCK)
            carried = (length[:, None] > 3.0 * cell_m[part].min()).ravel()
            angle = self.wave_vector[carried] @ xy[part].T + self.phase[carried, None]
            keep = np.clip(length[carried, None] / (3.0 * cell_m[part]) - 1.0, 0.0, 1.0)
            height[part] = np.einsum("wp,wp,w->p", np.sin(angle), keep, self.amplitude_m[carried])
        return height


def jonswap(
    omega: Float64[np.ndarray, "frequencies"], wind_mps: float, fetch_m: float
) -> Float64[np.ndarray, "frequencies"]:
    """Spectral density [m^2 s] of the elevation over the angular frequency [rad/s]."""
    alpha = 0.076 * (wind_mps**2 / (fetch_m * GRAVITY_mps2)) ** 0.22
    peak = peak_frequency(wind_mps, fetch_m)
    sigma = np.where(omega <= peak, 0.07, 0.09)
    bump = np.exp(-((omega - peak) ** 2) / (2 * (sigma * peak) ** 2))
    tail = alpha * GRAVITY_mps2**2 / omega**5 * np.exp(-1.25 * (peak / omega) ** 4)
    return np.asarray(tail * _PEAK_ENHANCEMENT**bump)


def peak_frequency(wind_mps: float, fetch_m: float) -> float:
    """Angular frequency [rad/s] of the highest waves; not below that of a fully grown sea (Pierson and Moskowitz)."""
    growing = 22.0 * (GRAVITY_mps2**2 / (wind_mps * fetch_m)) ** (1 / 3)
    return float(max(growing, 0.855 * GRAVITY_mps2 / wind_mps))


def draw_waves(
    wind_mps: float, fetch_m: float, swell_m: float, towards_rad: float, rng: np.random.Generator
) -> Waves:
    """Draw a sea.

    Parameters
    ----------
    wind_mps, fetch_m : float
    swell_m : float
        Significant height of the swell [m].
    towards_rad : float
        Where the wind blows to, counter-clockwise from east; the swell comes from up to 40 degrees beside.
    rng : numpy.random.Generator
    """
    peak = peak_frequency(wind_mps, fetch_m)
    edges = peak * np.geomspace(0.6, 4.5, _WAVES + 1)
    omega = np.sqrt(edges[1:] * edges[:-1])
    amplitude = np.sqrt(2 * jonswap(omega, wind_mps, fetch_m) * np.diff(edges))
    spread = np.clip(rng.normal(0.0, 0.5, _WAVES), -1.3, 1.3) * (0.6 + 0.4 * np.minimum(omega / peak, 2.0))
    short, long = _SWELL_LENGTH_M
    length = short * (long / short) ** rng.uniform(0.0, 1.0, _SWELL_WAVES)
    beside = rng.uniform(-0.7, 0.7) + rng.normal(0.0, 0.12, _SWELL_WAVES)
    low = np.full(_SWELL_WAVES, swell_m / 4.0 * np.sqrt(2.0 / _SWELL_WAVES))
    number = np.concatenate([omega**2 / GRAVITY_mps2, 2 * np.pi / length])
    heading = towards_rad + np.concatenate([spread, beside])
    vector = number[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    phase = rng.uniform(0.0, 2 * np.pi, len(number))
    return Waves(vector, phase, np.concatenate([amplitude, low]))
