"""What PNG and TIFF share: the last step of decoding, after each format has checked its own header."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from scenegen.foundation.errors import CorruptFrameError


def decoded(data: bytes, shape: tuple[int, int], dtype: DTypeLike, kind: str) -> NDArray[Any]:
    """Decode a one-channel picture by OpenCV.

    Parameters
    ----------
    data : bytes
        A file whose declared size was checked already.
    shape : (int, int)
        Rows and columns it must have.
    dtype : numpy dtype
        Type of its pixels.
    kind : str
        Name of the format, for the error.

    Raises
    ------
    CorruptFrameError
        If OpenCV cannot decode it, or to something else.
    """
    import cv2

    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        image = None
    if image is None or image.dtype != dtype or image.shape != shape:
        raise CorruptFrameError(f"{kind} does not decode")
    return np.asarray(image)
