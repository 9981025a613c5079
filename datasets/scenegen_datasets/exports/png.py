"""PNG as the readers of other formats expect it."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import UInt8
from numpy.typing import NDArray


def png(array: NDArray[Any]) -> bytes:
    """PNG of 8 or 16 bits, one to four channels in OpenCV's order (blue first).

    Level 1 with run lengths and one filter: measured for counts in `scenegen_datasets.codecs.png`.
    """
    import cv2

    return _encoded(array, cv2.IMWRITE_PNG_STRATEGY_RLE, "IMWRITE_PNG_FILTER_SUB")


def colour_png(grey: UInt8[np.ndarray, "rows columns"]) -> bytes:
    """PNG of a grey picture in three equal channels.

    It stands where others have colour: loaders of ZoeDepth, BTS, gsplat and 3D Gaussian splatting index the third axis
    without asking, TUM's ``generate_pointcloud.py`` refuses anything but RGB. Matching repeated bytes makes the three
    channels cost 1.8 times one of them; run lengths, which `png` uses, would make it three.
    """
    import cv2

    return _encoded(np.dstack([grey] * 3), cv2.IMWRITE_PNG_STRATEGY_DEFAULT, "IMWRITE_PNG_FILTER_PAETH")


def _encoded(array: NDArray[Any], strategy: int, filter_name: str) -> bytes:
    import cv2

    options = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_STRATEGY, strategy]
    if hasattr(cv2, filter_name):  # since 4.12
        options += [cv2.IMWRITE_PNG_FILTER, getattr(cv2, filter_name)]
    _, data = cv2.imencode(".png", np.ascontiguousarray(array), options)
    return bytes(data)
