"""The scales behind the colours: what black, white and full colour mean, so that they can be written out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, UInt8, UInt16

from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.shot import Shot
from scenegen_render.sensor.agc import plateau_agc

TILE_PX = 256
"""Width of one picture on a sheet."""

MAX_GAIN = 2.5
"""Grey levels per count at most: flat night scenes show their structure, the noise stays small."""


@dataclass(frozen=True, eq=False)
class Tone:
    """How counts become grey: the gain control of one frame, applicable to others.

    Attributes
    ----------
    count, level : float64 (points,)
        Monotone curve from counts to grey levels 0..255.
    low_K, high_K : float
        Brightness temperatures of the darkest and brightest parts (0.5 and 99.5 %).
    low_count, high_count : float
        Their counts.
    """

    count: Float64[np.ndarray, "points"]
    level: Float64[np.ndarray, "points"]
    low_K: float
    high_K: float
    low_count: float
    high_count: float

    @classmethod
    def of(cls, shot: Shot) -> Tone:
        """Plateau equalisation, as thermal cameras show their video."""
        count, first = np.unique(shot.counts, return_index=True)
        level = plateau_agc(shot.counts, max_gain=MAX_GAIN).ravel()[first]
        low_K, high_K = np.percentile(shot.thermal_K, (0.5, 99.5))
        ends = np.percentile(shot.counts, (0.5, 99.5))
        return cls(count.astype(np.float64), level.astype(np.float64), *map(float, (low_K, high_K, *ends)))

    def picture(self, counts: UInt16[np.ndarray, "rows columns"]) -> UInt8[np.ndarray, "rows columns 3"]:
        """Grey picture of a frame."""
        return np.asarray(np.repeat(self._levels(counts)[..., None], 3, axis=2))

    def ramp(self, width_px: int) -> UInt8[np.ndarray, "width"]:
        """Grey levels between the two ends, evenly spaced in counts: the bar that explains the picture."""
        return self._levels(np.linspace(self.low_count, self.high_count, width_px))

    def _levels(self, counts: np.ndarray) -> np.ndarray:
        return np.asarray(np.rint(np.interp(counts, self.count, self.level)), np.uint8)


def flow_range(shot: Shot) -> float:
    """Length [px] at full colour."""
    return colour.flow_range([shot.flow]) if shot.flow is not None else 1.0


def depth_range(shots: Sequence[Shot]) -> tuple[float, float]:
    """Distances [m] at both ends of the colormap, common to all shots."""
    return colour.depth_range([shot.depth for shot in shots])


def tile(shot: Shot, column: str, tone: Tone, depth_m: tuple[float, float], flow_px: float) -> colour.Picture:
    """One layer of one shot as a picture of tile size."""
    if column == "thermal":
        return resized(tone.picture(shot.counts), smooth=True)
    if column == "depth":
        return resized(colour.depth(shot.depth, *depth_m), smooth=False)
    if column == "semantic" and shot.semantic is not None:
        return resized(colour.semantic(shot.semantic), smooth=False)
    if column == "instance" and shot.instance is not None:
        return resized(colour.instance(shot.instance), smooth=False)
    assert column == "flow" and shot.flow is not None, column
    return resized(colour.flow(shot.flow, flow_px), smooth=True)


def tile_size(shape: tuple[int, ...]) -> tuple[int, int]:
    """Width and height [px] of a tile for a layer of this shape."""
    return TILE_PX, max(1, round(TILE_PX * shape[0] / shape[1]))


def resized(picture: colour.Picture, *, smooth: bool) -> UInt8[np.ndarray, "tile_rows tile_columns 3"]:
    """Fit a picture to a tile; ids and edges keep their exact colours unless `smooth`."""
    size = tile_size(picture.shape)
    if (picture.shape[1], picture.shape[0]) == size:
        return picture
    shrink = picture.shape[1] > size[0]
    kind = (cv2.INTER_AREA if shrink else cv2.INTER_CUBIC) if smooth else cv2.INTER_NEAREST
    return np.asarray(cv2.resize(picture, size, interpolation=kind), np.uint8)
