"""Thermal shadows: what a surface remembers now of the flux it did or did not absorb earlier.

A small change q(t) of the absorbed flux changes the temperature by x(t) with ``H(t) x + Y * x = q``: H the slope of
the losses to sky and air along the day, Y the conduction admittance. What is wanted is x at one instant for very many
q, so the adjoint equation is solved instead, once per class: its solution weighs the flux of every instant, and all
sites follow by one product.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex128, Float64

_STEPS = 80
_TOLERANCE = 5e-4


def memory(
    slope_Wm2K: Float64[np.ndarray, "surfaces samples"],
    admittance: Complex128[np.ndarray, "surfaces harmonics"],
) -> Float64[np.ndarray, "surfaces samples"]:
    """Temperature change at sample 0 per flux absorbed during each sample of the periodic day [K m^2/W].

    Parameters
    ----------
    slope_Wm2K : float64 (surfaces, samples)
        Derivative of the losses by surface temperature over the day, sample 0 now.
    admittance : complex128 (surfaces, samples // 2 + 1)

    Notes
    -----
    Sample n lies n steps ahead in the periodic day, that is ``samples - n`` steps in the past. Fixed-point iteration
    with the constant-slope inverse, which Fourier transforms diagonalise; the transpose of a convolution has the
    conjugate spectrum.
    """
    samples = slope_Wm2K.shape[1]
    backward = np.conj(admittance)
    middle = 0.5 * (slope_Wm2K.max(axis=1) + slope_Wm2K.min(axis=1))[:, None]  # converges fastest
    inverse = 1.0 / (middle + backward)
    rest = slope_Wm2K - middle
    spectrum = inverse.copy()  # of a unit pulse now, with the constant slope
    weight = np.fft.irfft(spectrum, n=samples)
    for _ in range(_STEPS):
        spectrum = inverse * (1.0 - np.fft.rfft(rest * weight))
        weight, before = np.fft.irfft(spectrum, n=samples), weight
        moved = np.abs(weight - before).sum(axis=1)
        if (moved < _TOLERANCE * np.abs(weight).sum(axis=1)).all():
            break
    return np.asarray(weight)
