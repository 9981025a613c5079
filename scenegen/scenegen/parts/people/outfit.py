"""What people wear: bare arms and legs in summer, coats in winter, pale and dark cloth."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int64

from scenegen.climate.climatology import normals
from scenegen.parts.workshop import Workshop

_SHADES = (("pale", 0.35), ("middle", 0.6), ("dark", 0.85))
"""Solar absorptance of cloth."""
_COATS_BELOW_C, _SHORTS_ABOVE_C = 9.0, 17.0


def outfits(count: int, shop: Workshop, rng: np.random.Generator) -> Int64[np.ndarray, "people slots"]:
    """Palette indices for the slots of `scenegen.parts.people.body`, one row per person.

    Parameters
    ----------
    count : int
    shop : Workshop
        Its season decides: below 9 degrees Celsius of mean air temperature nearly everyone wears a coat, above 17
        most arms and many legs are bare.
    rng : numpy.random.Generator
    """
    palette, mean_C = shop.palette, normals(shop.season).expected_C
    cloth = np.array([palette.special("clothing", key, solar_absorptance=a) for key, a in _SHADES])
    coat = np.array([palette.special("clothing_winter", key, solar_absorptance=a) for key, a in _SHADES])
    bare = np.array(palette.variants("human_skin", 2))
    skin = bare[rng.integers(2, size=count)]
    cold = rng.uniform(size=count) < np.clip(0.5 + (_COATS_BELOW_C - mean_C) / 8.0, 0.0, 1.0)
    warm = np.clip(0.5 + (mean_C - _SHORTS_ABOVE_C) / 10.0, 0.0, 1.0)
    top = np.where(cold, coat[rng.integers(3, size=count)], cloth[rng.integers(3, size=count)])
    bottom = cloth[rng.choice(3, count, p=[0.2, 0.35, 0.45])]
    short_sleeve = ~cold & (rng.uniform(size=count) < 0.95 * warm)
    short_leg = ~cold & (rng.uniform(size=count) < 0.6 * warm)
    hair = np.full(count, palette.only("hair"))
    shoe = np.full(count, coat[2])
    sleeve, shin = np.where(short_sleeve, skin, top), np.where(short_leg, skin, bottom)
    return np.column_stack([skin, hair, top, sleeve, bottom, shin, shoe]).astype(np.int64)
