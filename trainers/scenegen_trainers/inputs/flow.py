"""Dense optical flow between two grey frames."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float32, UInt8

from scenegen.foundation.errors import InputError
from scenegen_datasets.dense_flow import DIS_SMALLEST_PX, dis, farneback
from scenegen_trainers.inputs.knobs import InputKnobs


def pair_flow(
    now: UInt8[np.ndarray, "rows columns"], before: UInt8[np.ndarray, "rows columns"], knobs: InputKnobs
) -> Float32[np.ndarray, "rows columns 2"]:
    """Flow of a pair by image: u right, v down [px], on the grid `knobs.flow_grid` names.

    Parameters
    ----------
    now, before : uint8 (rows, columns)
        Grey frames under one gain.
    knobs : InputKnobs
        With `flow` farneback or dis.

    Raises
    ------
    InputError
        If the frames are too small for the method.
    """
    first, second = (now, before) if knobs.flow_grid == "current" else (before, now)
    if knobs.flow == "farneback":
        return farneback(first, second)
    if min(now.shape) < DIS_SMALLEST_PX:
        raise InputError(
            f"DIS flow needs frames of {DIS_SMALLEST_PX} px and more, these are {now.shape[1]}x{now.shape[0]}; "
            "take --inputs.flow farneback"
        )
    return dis(first, second)
