"""From layers to colours. Every function takes one layer and returns an RGB picture of the same size."""

from __future__ import annotations

import math
from functools import cache

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32, Integer, UInt8

from scenegen.classes import CLASSES

SKY_COLOUR = (38, 50, 66)
"""Of pixels without a surface, in pictures of distances and ids: a blue-grey no colormap below contains."""

Picture = UInt8[np.ndarray, "rows columns 3"]

# Sectors of the Middlebury flow wheel (Baker et al., IJCV 92, 2011): how many hues lie between two primaries.
_WHEEL = (
    ((255, 0, 0), 15),
    ((255, 255, 0), 6),
    ((0, 255, 0), 4),
    ((0, 255, 255), 11),
    ((0, 0, 255), 13),
    ((255, 0, 255), 6),
)
_WHEEL_SIZE = sum(count for _, count in _WHEEL)


def depth_range(depths: list[Float32[np.ndarray, "rows columns"]]) -> tuple[float, float]:
    """Range [m] that shows a set of depth layers well: 1st to 99th percentile, rounded outwards to 1-2-5 steps."""
    finite = np.concatenate([d[np.isfinite(d)] for d in depths])
    if finite.size == 0:
        return 1.0, 100.0
    low, high = np.percentile(finite, (1.0, 99.0))
    low, high = _step(float(low), down=True), _step(float(high), down=False)
    return (low, high) if high > low else (low, 2.0 * low)


def depth(
    depth_m: Float32[np.ndarray, "rows columns"], low_m: float, high_m: float
) -> UInt8[np.ndarray, "rows columns 3"]:
    """Distance on a logarithmic scale in a perceptually uniform colormap: near bright, far dark, sky apart."""
    finite = np.isfinite(depth_m)
    share = np.log(np.where(finite, depth_m, 1.0) / low_m) / math.log(high_m / low_m)
    index = np.rint(255 * (1.0 - np.clip(share, 0.0, 1.0))).astype(np.uint8)
    return _with_sky(colormap()[index], ~finite)


def semantic(ids: Integer[np.ndarray, "rows columns"]) -> Picture:
    """Class colours of `scenegen.classes`."""
    table = np.array([row.colour for row in CLASSES], np.uint8)
    table[0] = SKY_COLOUR
    return np.asarray(table[ids])


def instance(ids: Integer[np.ndarray, "rows columns"]) -> Picture:
    """One well-separated colour per object: hues by the golden ratio, so that neighbours in id differ most."""
    number = ids.astype(np.uint64)
    hue = (number * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(40)
    hsv = np.empty((*ids.shape, 3), np.uint8)
    hsv[..., 0] = hue % np.uint64(180)
    hsv[..., 1] = 110 + (hue >> np.uint64(8)) % np.uint64(110)
    hsv[..., 2] = 150 + (hue >> np.uint64(15)) % np.uint64(100)
    return _with_sky(np.asarray(cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB), np.uint8), ids == 0)


def flow_range(flows: list[Float32[np.ndarray, "rows columns 2"]]) -> float:
    """Length [px] at full colour that shows a set of flow layers well: the 90th percentile, rounded up."""
    length = np.concatenate([np.hypot(f[..., 0], f[..., 1]).ravel() for f in flows])
    length = length[np.isfinite(length)]
    return (
        _step(float(np.percentile(length, 90.0)), down=False, steps=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0))
        if length.size
        else 1.0
    )


def flow(uv: Float32[np.ndarray, "rows columns 2"], full_px: float) -> Picture:
    """Flow on the Middlebury colour wheel: direction as hue, length as saturation, no motion white."""
    u, v = np.nan_to_num(uv[..., 0]) / full_px, np.nan_to_num(uv[..., 1]) / full_px
    length = np.minimum(np.hypot(u, v), 1.0)[..., None]
    position = (np.arctan2(-v, -u) / math.pi + 1.0) / 2.0 * (_WHEEL_SIZE - 1)
    below = np.floor(position).astype(np.int64)
    part = (position - below)[..., None]
    wheel = _wheel()
    hue = (1.0 - part) * wheel[below] + part * wheel[(below + 1) % _WHEEL_SIZE]
    return np.asarray(np.rint(255.0 - length * (255.0 - hue)), np.uint8)


@cache
def colormap() -> UInt8[np.ndarray, "256 3"]:
    """The colormap of distances, dark to bright."""
    ramp = np.arange(256, dtype=np.uint8)[:, None]
    return np.ascontiguousarray(cv2.applyColorMap(ramp, cv2.COLORMAP_MAGMA)[:, 0, ::-1])


@cache
def _wheel() -> Float[np.ndarray, "hues 3"]:
    corners = [np.array(colour, float) for colour, _ in _WHEEL]
    return np.concatenate(
        [
            start + np.arange(count)[:, None] / count * (end - start)
            for start, end, (_, count) in zip(corners, corners[1:] + corners[:1], _WHEEL, strict=True)
        ]
    )


def _with_sky(picture: Picture, sky: Bool[np.ndarray, "rows columns"]) -> Picture:
    picture = picture.copy()
    picture[sky] = SKY_COLOUR
    return picture


def _step(value: float, *, down: bool, steps: tuple[float, ...] = (1.0, 2.0, 5.0, 10.0)) -> float:
    """Nearest round number below or above: one of `steps` times a power of ten."""
    power = 10.0 ** math.floor(math.log10(max(value, 1e-6)))
    known = [m * power for m in steps]
    below = [s for s in known if s <= value * (1 + 1e-9)]
    above = [s for s in known if s >= value * (1 - 1e-9)]
    return (below or known)[-1] if down else (above or known)[0]
