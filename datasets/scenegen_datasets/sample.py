"""What one index of a dataset gives: arrays by layer, where and when they were taken, and the facts of the clip."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

Sample = dict[str, Any]

_SAME = ("map", "world", "clip", "split")
"""What all frames of a sequence share."""


def stacked(frames: list[Sample]) -> Sample:
    """Join the frames of a sequence: arrays and numbers get a leading axis, what names the clip stays as it is."""
    joined: Sample = {}
    for name, value in frames[0].items():
        values = [frame[name] for frame in frames]
        if name in _SAME:
            joined[name] = value
        elif isinstance(value, str) or name == "imu":  # frames are unequally long apart: so are their tables
            joined[name] = values
        else:
            joined[name] = np.stack(values)
    return joined


def facts_of(clip: Mapping[str, Any]) -> dict[str, Any]:
    """Season, hour, sun, speed and weather of a clip from its record, as plain values."""
    names = ("latitude_deg", "month", "day", "hour", "sun_elevation_deg", "speed_mps")
    return {**{name: clip[name] for name in names}, **clip["weather"]}
