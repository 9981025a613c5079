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
_TOLERANCE = 1e-4


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
    stiffness = 0.5 * (slope_Wm2K.max(axis=1) + slope_Wm2K.mean(axis=1))[:, None]
    now = np.zeros_like(slope_Wm2K)
    now[:, 0] = 1.0
    weight = np.fft.irfft(np.fft.rfft(now) / (stiffness + backward), n=samples)
    for _ in range(_STEPS):
        left = now - slope_Wm2K * weight - np.fft.irfft(backward * np.fft.rfft(weight), n=samples)
        move = np.fft.irfft(np.fft.rfft(left) / (stiffness + backward), n=samples)
        weight += move
        if float(np.abs(move).sum(axis=1).max(initial=0.0)) < _TOLERANCE * float(
            np.abs(weight).sum(axis=1).max()
        ):
            break
    return np.asarray(weight)
