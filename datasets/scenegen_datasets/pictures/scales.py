"""The colour scales of a set of shots: the same for all of them, so that pictures can be compared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import UInt8

from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.shot import Shot

TILE_PX = 256
"""Width of one picture on a sheet."""


@dataclass(frozen=True)
class Scales:
    """What black, white and full colour mean.

    Attributes
    ----------
    depth_m : (float, float)
        Brightest and darkest distance.
    flow_px : float
        Length at full colour.
    """

    depth_m: tuple[float, float]
    flow_px: float

    @classmethod
    def of(cls, shots: Sequence[Shot]) -> Scales:
        """Ranges that show all shots well."""
        flows = [shot.flow for shot in shots if shot.flow is not None]
        return cls(colour.depth_range([s.depth for s in shots]), colour.flow_range(flows) if flows else 1.0)

    def tile(self, shot: Shot, column: str, thermal_K: tuple[float, float]) -> colour.Picture:
        """One layer of one shot as a picture of tile size; `thermal_K` becomes black and white."""
        if column == "thermal":
            return resized(colour.grey(shot.thermal_K, *thermal_K), smooth=True)
        if column == "depth":
            return resized(colour.depth(shot.depth, *self.depth_m), smooth=False)
        if column == "semantic" and shot.semantic is not None:
            return resized(colour.semantic(shot.semantic), smooth=False)
        if column == "instance" and shot.instance is not None:
            return resized(colour.instance(shot.instance), smooth=False)
        assert column == "flow" and shot.flow is not None, column
        return resized(colour.flow(shot.flow, self.flow_px), smooth=True)


def thermal_range(shot: Shot) -> tuple[float, float]:
    """Percentiles [K] that become black and white: a linear gain control, so that a scale bar is true."""
    low, high = np.percentile(shot.thermal_K, (0.5, 99.5))
    return float(low), max(float(high), float(low) + 1.0)


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
