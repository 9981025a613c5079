"""A network flies with the camera it was trained on, or not at all."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_render.camera import Camera

HFOV_TOLERANCE_DEG = 0.5
"""Fields of view that differ by less are one."""


def frames_of(width_px: int, height_px: int, focal_px: float) -> dict[str, Any]:
    """Size and field of view of a camera's frames, as files of networks name them."""
    hfov_deg = 2.0 * math.degrees(math.atan(0.5 * width_px / focal_px))
    return {"width_px": width_px, "height_px": height_px, "hfov_deg": round(hfov_deg, 6)}


def check_camera(path: Path, trained: Mapping[str, Any] | None, camera: Camera) -> None:
    """Compare what a network was trained on with the camera of a campaign.

    Parameters
    ----------
    path : Path
        Of the network, for the message.
    trained : mapping or None
        ``width_px``, ``height_px``, ``hfov_deg`` as far as they are known.
    camera : Camera

    Raises
    ------
    InputError
        If they differ; says which flag makes them agree.
    """
    if trained is None:
        return
    size = trained.get("width_px", camera.width_px), trained.get("height_px", camera.height_px)
    if size != (camera.width_px, camera.height_px):
        raise InputError(
            f"{path}: was trained on {size[0]}x{size[1]} pixels, the campaign's camera has "
            f"{camera.width_px}x{camera.height_px}; add --size {size[0]}x{size[1]}"
        )
    hfov = frames_of(camera.width_px, camera.height_px, camera.focal_px)["hfov_deg"]
    asked = trained.get("hfov_deg", hfov)
    if not isinstance(asked, int | float) or abs(asked - hfov) > HFOV_TOLERANCE_DEG:
        raise InputError(
            f"{path}: was trained with a field of view of {asked} deg, the campaign's camera has {hfov:.1f}; "
            f"add --camera.hfov-deg {asked}"
        )
