"""Dense optical flow between two grey frames, as OpenCV estimates it: what a drone can have instead of the truth."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

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


def farneback(
    first: UInt8[np.ndarray, "rows columns"], second: UInt8[np.ndarray, "rows columns"]
) -> Float32[np.ndarray, "rows columns 2"]:
    """Flow of Farneback's method: a pixel of `first` is found at pixel + flow in `second`; u right, v down [px]."""
    # OpenCV's stub wants the output array that its own documentation leaves out.
    flow = cv2.calcOpticalFlowFarneback(first, second, None, **FARNEBACK)  # type: ignore[call-overload]
    return np.asarray(flow, np.float32)


def dis(
    first: UInt8[np.ndarray, "rows columns"], second: UInt8[np.ndarray, "rows columns"]
) -> Float32[np.ndarray, "rows columns 2"]:
    """The same by dense inverse search, preset medium; frames of `DIS_SMALLEST_PX` and more."""
    method = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    return np.asarray(method.calc(first, second, None), np.float32)
