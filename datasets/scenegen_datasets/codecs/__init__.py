"""Bytes of one member to arrays and back, exactly. Every decoder checks the declared size before it allocates."""

from __future__ import annotations

__all__ = ["single_threaded"]


def single_threaded() -> None:
    """Keep cv2 and OpenEXR from starting threads of their own; worker processes call it once."""
    import cv2
    import OpenEXR

    cv2.setNumThreads(1)
    OpenEXR.set_global_thread_count(0)
