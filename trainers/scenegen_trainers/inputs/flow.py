"""Dense optical flow between two grey frames."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

from scenegen.foundation.errors import InputError
from scenegen_trainers.inputs.knobs import InputKnobs

FARNEBACK = {
    "pyr_scale": 0.5,
    "levels": 3,
    "winsize": 15,
    "iterations": 3,
    "poly_n": 5,
    "poly_sigma": 1.2,
    "flags": 0,
}
"""Parameters of both OpenCV samples of dense flow; the paper names the method (Farneback, SCIA 2003) and none."""

DIS_SMALLEST_PX = 24
"""Below this side the coarsest level of DIS (Kroeger et al., ECCV 2016) holds no patch."""


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
        # OpenCV's stub wants the output array that its own documentation leaves out.
        flow = cv2.calcOpticalFlowFarneback(first, second, None, **FARNEBACK)  # type: ignore[call-overload]
        return np.asarray(flow, np.float32)
    if min(now.shape) < DIS_SMALLEST_PX:
        raise InputError(
            f"DIS flow needs frames of {DIS_SMALLEST_PX} px and more, these are {now.shape[1]}x{now.shape[0]}; "
            "take --inputs.flow farneback"
        )
    method = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    return np.asarray(method.calc(first, second, None), np.float32)
