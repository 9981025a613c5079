"""The simplified depth image S: near things move more, so how far a pixel moved stands for how near it is."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

from scenegen_trainers.inputs.knobs import InputKnobs


def simplified_depth(
    flow: Float32[np.ndarray, "rows columns 2"], knobs: InputKnobs
) -> UInt8[np.ndarray, "rows columns"]:
    """Luminance of the flow picture.

    Parameters
    ----------
    flow : float32 (rows, columns, 2)
        [px]; NaN (behind the other camera) counts as no displacement.
    knobs : InputKnobs

    Notes
    -----
    The flow picture is that of OpenCV's samples: hue is half the direction in degrees, saturation 255, value V the
    length. Fractions are cut off as there, so that very small displacements become 0 and are not embedded.
    """
    u, v = np.nan_to_num(flow[..., 0]), np.nan_to_num(flow[..., 1])
    length, angle = cv2.cartToPolar(u, v)
    value = _value(np.asarray(length, np.float32), knobs)
    if knobs.simplified == "value":
        return value
    hue = (np.rad2deg(angle) / 2.0).astype(np.uint8)
    hsv = np.stack([hue, np.full_like(value, 255), value], axis=-1)
    colours = cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)
    return np.asarray(cv2.cvtColor(colours, cv2.COLOR_BGR2GRAY), np.uint8)


def _value(
    length: Float32[np.ndarray, "rows columns"], knobs: InputKnobs
) -> UInt8[np.ndarray, "rows columns"]:
    if knobs.flow_scale == "minmax":
        least, most = float(length.min()), float(length.max())
        level = (
            (length - np.float32(least)) * np.float32(255.0 / (most - least)) if most > least else 0 * length
        )
    else:
        gain = 4.0 if knobs.flow_scale == "x4" else 255.0 / knobs.flow_full_px
        level = length * np.float32(gain)
    return np.asarray(np.clip(level, 0.0, 255.0), np.float32).astype(np.uint8)
