"""From 14-bit counts to the 8-bit grey that flow and networks work on. The frames of a pair share one gain."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Float32, Real, UInt8

from scenegen.foundation.errors import InputError
from scenegen_trainers.inputs.knobs import InputKnobs

_CLAHE_CLIP, _CLAHE_TILES = 2.0, (8, 8)


def grey_pair(
    now: Real[np.ndarray, "rows columns"], before: Real[np.ndarray, "rows columns"], knobs: InputKnobs
) -> tuple[UInt8[np.ndarray, "rows columns"], UInt8[np.ndarray, "rows columns"]]:
    """Bring a frame and its predecessor to grey.

    Parameters
    ----------
    now, before : (rows, columns)
        Counts, as integers or floats; both give the same grey.
    knobs : InputKnobs

    Raises
    ------
    InputError
        If a count is NaN or infinite.
    """
    pair = np.stack([now, before]).astype(np.float32)
    if not np.isfinite(pair).all():
        raise InputError("a thermal frame has counts that are not finite; check what feeds the network")
    spans = [_span(pair, knobs)] * 2 if knobs.gain_shared else [_span(frame, knobs) for frame in pair]
    grey = [_stretched(frame, *span) for frame, span in zip(pair, spans, strict=True)]
    if knobs.gain == "clahe":
        equaliser = cv2.createCLAHE(_CLAHE_CLIP, _CLAHE_TILES)
        grey = [np.asarray(equaliser.apply(frame), np.uint8) for frame in grey]
    return grey[0], grey[1]


def _span(values: Float32[np.ndarray, "..."], knobs: InputKnobs) -> tuple[float, float]:
    """Counts that become black and white."""
    if knobs.gain == "percentile":
        low, high = np.quantile(values, knobs.gain_percent)
        return float(low), float(high)
    return float(values.min()), float(values.max())


def _stretched(
    frame: Float32[np.ndarray, "rows columns"], low: float, high: float
) -> UInt8[np.ndarray, "rows columns"]:
    scale = np.float32(255.0 / max(high - low, 1.0))
    return np.asarray(np.rint(np.clip((frame - np.float32(low)) * scale, 0.0, 255.0)), np.uint8)
