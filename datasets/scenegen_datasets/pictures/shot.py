"""One frame as the pictures need it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8, UInt16, UInt32

from scenegen_datasets.pictures.words import clip_words
from scenegen_render.sensor.scale import CountScale, counts_to_brightness_K


@dataclass(frozen=True, eq=False)
class Shot:
    """The layers of one frame and the words that belong to them.

    Attributes
    ----------
    name : str
        Of the clip and frame.
    facts : str
        Hour, date, latitude, weather in one line.
    counts : uint16 (rows, columns)
        What the camera reported.
    thermal_K : float32 (rows, columns)
        The same as brightness temperature [K].
    depth : float32 (rows, columns)
        Planar z [m], +inf for sky.
    semantic, instance, flow : arrays as in `scenegen_render.frame.Frame`, or None where the dataset has none
    """

    name: str
    facts: str
    counts: UInt16[np.ndarray, "rows columns"]
    thermal_K: Float32[np.ndarray, "rows columns"]
    depth: Float32[np.ndarray, "rows columns"]
    semantic: UInt8[np.ndarray, "rows columns"] | None = None
    instance: UInt32[np.ndarray, "rows columns"] | None = None
    flow: Float32[np.ndarray, "rows columns 2"] | None = None

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the layers that are there, in the order they are shown."""
        optional = {"semantic": self.semantic, "instance": self.instance, "flow": self.flow}
        return ("thermal", "depth", *(name for name, layer in optional.items() if layer is not None))


def shot_of(sample: Mapping[str, Any], scale: CountScale) -> Shot:
    """From a sample of `scenegen_datasets.PairDataset` with its layers to what the pictures need."""
    layers = {
        name: np.asarray(sample[name]) for name in ("depth", "semantic", "instance", "flow") if name in sample
    }
    counts = np.asarray(sample["thermal"], np.uint16)
    return Shot(
        sample["key"], clip_words(sample["facts"]), counts, counts_to_brightness_K(counts, scale), **layers
    )
