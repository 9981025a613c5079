"""Depth as a picture in -1..1 that a network paints, and back to metres."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32

from scenegen.foundation.errors import InputError
from scenegen_trainers.inputs.knobs import TargetKnobs


def check_truth(depth_m: Float32[np.ndarray, "rows columns"]) -> None:
    """Refuse what is no true depth.

    Raises
    ------
    InputError
        If depth is NaN or not positive anywhere; sky is +inf.
    """
    wrong = int((~(depth_m > 0.0)).sum())
    if wrong:
        raise InputError(
            f"true depth is NaN or not positive in {wrong} pixels; run `scenegen verify` on the dataset"
        )


def encode(
    depth_m: Float32[np.ndarray, "rows columns"], knobs: TargetKnobs
) -> tuple[Float32[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"]]:
    """Paint depth.

    Parameters
    ----------
    depth_m : float32 (rows, columns)
        Planar depth [m], sky +inf.

    Returns
    -------
    code : float32 (rows, columns)
        -1 near, 1 at `cap_m` and beyond.
    judged : bool (rows, columns)
        Pixels a loss may look at.

    Raises
    ------
    InputError
        If depth is NaN or not positive anywhere.
    """
    check_truth(depth_m)
    capped = np.minimum(depth_m, np.float32(knobs.cap_m))
    if knobs.scale == "log":
        octaves = math.log(knobs.cap_m / knobs.near_m)
        share = np.log(np.maximum(capped, np.float32(knobs.near_m)) / np.float32(knobs.near_m)) / octaves
    else:
        share = capped / np.float32(knobs.cap_m)
    judged = depth_m < knobs.cap_m if knobs.sky == "ignore" else np.ones(depth_m.shape, np.bool_)
    return np.asarray(2.0 * share - 1.0, np.float32), judged


def decode(code: Any, knobs: TargetKnobs) -> Any:
    """Metres of a painted depth; a numpy array or a torch tensor of any shape, in kind."""
    share = (code + 1.0) * 0.5
    if knobs.scale == "log":
        return knobs.near_m * (knobs.cap_m / knobs.near_m) ** share
    return share * knobs.cap_m
