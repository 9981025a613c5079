"""Thermal shadows: what a surface remembers now of the flux it did or did not absorb earlier.

A change q(t) of the absorbed flux changes the temperature by ``irfft(rfft(q) / (H + Y))``, H the daily mean slope of
losses to sky and air, Y the conduction admittance. One kernel per class; one matrix product for all sites.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex128, Float64, Int64


def memory(
    loss_Wm2K: Float64[np.ndarray, "surfaces"],
    admittance: Complex128[np.ndarray, "surfaces harmonics"],
    samples: int,
) -> Float64[np.ndarray, "surfaces samples"]:
    """Temperature change now per flux absorbed at each sample of the day [K m^2/W].

    Sample 0 is now, sample n lies n steps ahead in the periodic day, that is ``samples - n`` steps in the past.
    """
    kernel = np.fft.irfft(1.0 / (loss_Wm2K[:, None] + admittance), n=samples)
    return np.asarray(kernel[:, (-np.arange(samples)) % samples])


def collect(
    weight: Float64[np.ndarray, "surfaces samples"], index: Int64[np.ndarray, "samples"], count: int
) -> Float64[np.ndarray, "surfaces count"]:
    """Sum weights of samples that share an index (the sun position nearest to them)."""
    chosen = (index[:, None] == np.arange(count)[None, :]).astype(np.float64)
    return np.asarray(np.einsum("cn,nk->ck", weight, chosen))
