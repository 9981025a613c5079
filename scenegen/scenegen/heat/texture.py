"""How strong the small-scale temperature pattern of each material is at this moment.

The pattern comes from small differences of absorptance, thickness and moisture, so it grows with the sunshine the
surface has absorbed and still remembers. What is left at night comes from emissivity and stored heat.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float64

NIGHT_SHARE = 0.4
"""Of the amplitude in full sun, left without any sun. Real frames: 0.2 K at dusk, 0.4 K at midday."""
REFERENCE_Wm2 = 1000.0
"""Peak of the reference sun, a half sine from 6 to 18 h on a horizontal surface: the table's "full sun"."""


def solar_memory(
    memory: Float64[np.ndarray, "classes samples"], sunshine_Wm2: Float64[np.ndarray, "classes samples"]
) -> Float64[np.ndarray, "classes"]:
    """Solar heating still felt now, relative to the strongest moment of the reference day; 0 after a dark day.

    Parameters
    ----------
    memory : float64 (classes, samples)
        `scenegen.heat.shadow.memory`.
    sunshine_Wm2 : float64 (classes, samples)
        Short-wave irradiance of the actual day, sample 0 now.
    """
    samples = memory.shape[1]
    reference = REFERENCE_Wm2 * np.maximum(np.sin(2 * np.pi * np.arange(samples) / samples), 0.0)
    answer = np.fft.irfft(np.conj(np.fft.rfft(memory)) * np.fft.rfft(reference), n=samples)
    return np.asarray(np.einsum("cn,cn->c", memory, sunshine_Wm2) / np.maximum(answer.max(axis=1), 1e-9))


def amplitude_factor(solar: Float64[np.ndarray, "classes"]) -> Float64[np.ndarray, "classes"]:
    """Factor on a material's texture amplitude, `NIGHT_SHARE` in the dark, 1 in full sun."""
    return np.asarray(NIGHT_SHARE + (1.0 - NIGHT_SHARE) * np.clip(solar, 0.0, 1.5))
