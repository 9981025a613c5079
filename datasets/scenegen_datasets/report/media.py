"""Tiles and animations as bytes, within a budget."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image

from scenegen_datasets.pictures.animation import Scales, animate, flight_frame, shown_layers
from scenegen_datasets.pictures.colour import Picture
from scenegen_datasets.pictures.ramp import Ramp, thermal_ramp
from scenegen_datasets.pictures.scales import Tone, depth_range, flow_range, tile
from scenegen_datasets.pictures.shot import Shot

FLIGHT_BYTES = 4_200_000
"""Of all animations together; with tiles, charts and base64 a page stays below 10 MB."""

_QUALITY = 82
_IDS = ("semantic", "instance")
_LEAST_FRAMES = 4


@dataclass(frozen=True, eq=False)
class Tile:
    """One layer of a moment: its picture as WebP, its size, the words below it, and the bar of its colours."""

    layer: str
    data: bytes
    width: int
    height: int
    words: str
    ramp: Ramp | None = None


@dataclass(frozen=True, eq=False)
class Film:
    """A flight as an animated WebP, its first frame for those who want no motion, and what its colours mean."""

    data: bytes
    still: bytes
    width: int
    height: int
    layers: tuple[str, ...]
    scales: Scales


def tiles(shot: Shot, span_m: tuple[float, float]) -> tuple[Tile, ...]:
    """All layers of a moment; depths on a common scale, heat and flow on their own."""
    tone, full_px = Tone.of(shot), flow_range(shot)
    words = {
        "thermal": "thermal",
        "depth": "depth",
        "semantic": "classes",
        "instance": "objects",
        "flow": f"flow, full colour {full_px:g}\u00a0px",
    }
    found = []
    for layer in shot.columns:
        image = tile(shot, layer, tone, span_m, full_px)
        data = webp(image, exact=layer in _IDS)
        ramp = thermal_ramp(tone) if layer == "thermal" else None
        found.append(Tile(layer, data, image.shape[1], image.shape[0], words[layer], ramp))
    return tuple(found)


def webp(image: Picture, *, exact: bool = False) -> bytes:
    """Encode a picture, without loss if it has to be exact."""
    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(image)).save(
        file, "WEBP", quality=_QUALITY, method=4, lossless=exact
    )
    return file.getvalue()


def flight_within(shots: Sequence[Shot], most_bytes: int) -> Film:
    """Animate a flight; the latter half is left out until what remains fits."""
    shown = list(shots)
    while True:
        data = animate(shown, words=False)
        if len(data) <= most_bytes or len(shown) <= _LEAST_FRAMES:
            break
        shown = shown[: max(len(shown) // 2, _LEAST_FRAMES)]
    scales = Scales.of(shown)
    first = flight_frame(shown[0], scales, words=False)
    still = webp(np.asarray(first))
    return Film(data, still, first.width, first.height, shown_layers(shown[0]), scales)


def common_range(shots: Sequence[Shot]) -> tuple[float, float]:
    """Depths [m] between which the colours of all tiles run."""
    return depth_range(shots)
