"""Counts in, metres out: what every depth network is given and what is made of its answer."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float32

from scenegen_flythrough.loop.pilot import Observation

NEAREST_M = 0.01
"""Answers below this are raised to it: a network may overshoot zero, a planner may divide."""

Frames = Float32[np.ndarray, "n rows columns"]


def frames(seen: Observation) -> tuple[Frames, Frames]:
    """The frame of this decision and that of the one before, in counts.

    Raises
    ------
    ValueError
        If the pilot was shown no thermal frames.
    """
    if seen.counts is None:
        raise ValueError("a depth network was shown no thermal frames")
    previous = seen.counts if seen.previous_counts is None else seen.previous_counts
    return seen.counts.astype(np.float32), previous.astype(np.float32)


def depth(answer: np.ndarray, like: Frames) -> Frames:
    """A network's answer as planar depth [m].

    Parameters
    ----------
    answer : array (n, rows, columns) or (n, 1, rows, columns)
    like : float32 (n, rows, columns)
        The frames it answers to.

    Raises
    ------
    ValueError
        If it has another shape, or is not a number anywhere. Infinite depth is a fine answer: sky.
    """
    flat = answer[:, 0] if answer.ndim == 4 and answer.shape[1] == 1 else answer
    if flat.shape != like.shape:
        raise ValueError(f"depth of shape {answer.shape} for frames of shape {like.shape}")
    if np.isnan(flat).any():
        raise ValueError("depth is not a number")
    return np.asarray(np.maximum(flat, NEAREST_M), np.float32)
