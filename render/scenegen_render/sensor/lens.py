"""What the lens takes from fine detail before the pixels see it.

The renderer averages over the square pixel; diffraction and focus blur come on top. A kernel (w, 1 - 2w, w) along rows
and columns has the transfer function 1 - 2w (1 - cos 2 pi f): with the modulation m it leaves at the Nyquist frequency,
w = (1 - m) / 4. For an ideal f/1.0 lens on 12 um pixels at 10 um, m is 0.485, and at half that frequency the kernel
gives 0.743 where diffraction gives 0.737: three taps say all that a sampled image can tell.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float32


def blurred(
    radiance: Float32[np.ndarray, "rows columns"], mtf_at_nyquist: float
) -> Float32[np.ndarray, "rows columns"]:
    """Apply the modulation transfer of a lens; the border repeats its last pixel.

    Parameters
    ----------
    radiance : float32 (rows, columns)
        Averaged over pixels [W m^-2 sr^-1].
    mtf_at_nyquist : float
        Modulation left of stripes one pixel wide, along rows or columns; 1 for a perfect lens.
    """
    if mtf_at_nyquist == 1.0:
        return radiance
    side = np.float32(0.25 * (1.0 - mtf_at_nyquist))
    across = _three_taps(np.pad(radiance, ((0, 0), (1, 1)), mode="edge").T, side).T
    return _three_taps(np.pad(across, ((1, 1), (0, 0)), mode="edge"), side)


def _three_taps(
    padded: Float32[np.ndarray, "rows columns"], side: np.float32
) -> Float32[np.ndarray, "inner columns"]:
    """Weighted sum of each row with the rows before and after it, as a change of the middle one."""
    middle = padded[1:-1]
    change = padded[:-2] + padded[2:]
    change -= middle
    change -= middle
    change *= side
    change += middle
    return np.asarray(change)
