"""Render once, sense many: thermal frames of stored radiance through a camera with fresh noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt16

from scenegen.foundation.rng import stream
from scenegen_datasets.store import read_lock
from scenegen_render.camera import Camera
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.sense import sense


@dataclass(frozen=True)
class Redrawn:
    """The dataset's camera model, with noise and fixed pattern of its own for every pair and epoch.

    Attributes
    ----------
    sensor : SensorKnobs
        Of the dataset.
    band_um : (float, float)
    seed : int
    """

    sensor: SensorKnobs
    band_um: tuple[float, float]
    seed: int

    @classmethod
    def of(cls, root: Path, band_um: tuple[float, float], seed: int) -> Redrawn:
        """The camera a dataset was made with."""
        return cls(SensorKnobs.model_validate(read_lock(root)["recipe"]["sensor"]), band_um, seed)

    def sense(self, sample: Mapping[str, Any], epoch: int) -> list[UInt16[np.ndarray, "rows columns"]]:
        """Counts of both frames of a sequence of two.

        Parameters
        ----------
        sample : mapping
            Of a `PairDataset` with layer radiance and ``seq_length`` 2.
        epoch : int
        """
        radiance, matrix = sample["radiance"], sample["K"][0]
        rows, columns = radiance.shape[-2:]
        camera = Camera(
            columns,
            rows,
            float(matrix[0, 0]),
            (float(matrix[0, 2]), float(matrix[1, 2])),
            self.band_um,
        )
        rng = stream(self.seed, "redraw", epoch, sample["key"][1])
        readings = sense(radiance, np.asarray(sample["time_s"], np.float64), camera, self.sensor, rng)
        return [reading.counts for reading in readings]
