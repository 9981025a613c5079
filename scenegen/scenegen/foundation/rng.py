"""Randomness is passed in. A generator is a pure function of a path of names and numbers below one root seed.

``stream(seed, "city", 3, "weather", 5)`` is the same generator on every machine, in every process and in any order of
calls, and is independent of every other path. Nothing in this project touches numpy's global generator.
"""

from __future__ import annotations

import hashlib

import numpy as np


def stream(seed: int, *path: str | int) -> np.random.Generator:
    """Return the generator that belongs to `path` below `seed`.

    Parameters
    ----------
    seed : int
        Root seed of the dataset, >= 0.
    *path : str or int
        Names and indices from the general to the particular.

    Returns
    -------
    numpy.random.Generator
        PCG64, seeded with the SHA-256 of the path. Hashing (instead of ``spawn`` counters) keeps a child independent
        of how many siblings were made before it.
    """
    text = "/".join([f"{int(seed)}", *(f"{type(p).__name__}:{p}" for p in path)])
    return np.random.Generator(
        np.random.PCG64(int.from_bytes(hashlib.sha256(text.encode()).digest(), "little"))
    )
