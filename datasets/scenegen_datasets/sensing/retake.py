"""While loading: counts of stored radiance through a camera with fresh noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, UInt16

from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream
from scenegen_datasets.description import read_description
from scenegen_datasets.resolve import Source, resolve
from scenegen_datasets.store import DATASET, read_lock
from scenegen_render.camera import Camera
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.sense import sense


@dataclass(frozen=True)
class Retake:
    """A camera on a dataset's grid and band, with noise and fixed pattern of its own for every pair and epoch.

    `PairDataset` takes one as `retake`; then ``thermal`` and ``previous_thermal`` are sensed from stored radiance.

    Attributes
    ----------
    sensor : SensorKnobs
    band_um : (float, float)
        Of the dataset.
    seed : int
    epoch : int
        Another one draws other noise.
    """

    sensor: SensorKnobs
    band_um: tuple[float, float]
    seed: int
    epoch: int = 0

    @classmethod
    def of(
        cls, root: Path, band_um: tuple[float, float] | None = None, seed: int = 0, **sensor: Any
    ) -> Retake:
        """The camera a dataset was made with, or another one.

        Parameters
        ----------
        root : Path
            The dataset's directory.
        band_um : (float, float), optional
            Of the dataset, if it is known already.
        seed : int
        **sensor
            Keys of `scenegen_render.sensor.knobs.SensorKnobs` that differ: ``netd_mk=30.0``.

        Raises
        ------
        InputError
            If there is no dataset, it was merged of parts with cameras of their own, or a key is unknown.
        """
        stored = read_lock(root)["recipe"].get("sensor")
        if stored is None:
            raise InputError(f"{root} was merged; sense its parts, which name their cameras")
        knobs = resolve(SensorKnobs, [Source(str(root), stored), Source("sensor", sensor)])
        low_um, high_um = band_um or read_description(root / DATASET)["band_um"]
        return cls(knobs, (low_um, high_um), seed)

    def at(self, epoch: int) -> Retake:
        """The same camera with the noise of another epoch."""
        return replace(self, epoch=epoch)

    def counts(
        self,
        radiance: Float32[np.ndarray, "frames rows columns"],
        time_s: Float64[np.ndarray, "frames"],
        matrix: Float64[np.ndarray, "3 3"],
        key: str,
    ) -> list[UInt16[np.ndarray, "rows columns"]]:
        """Counts of successive frames of a flight, ending with the frame `key`.

        Parameters
        ----------
        radiance : float32 (frames, rows, columns)
            Noise-free, as stored [W m^-2 sr^-1]; the pixels have settled on the first frame.
        time_s : float64 (frames,)
            Rising [s].
        matrix : float64 (3, 3)
            Intrinsic matrix [px].
        key : str
            Of the last frame; names the noise.
        """
        rows, columns = radiance.shape[-2:]
        centre = float(matrix[0, 2]), float(matrix[1, 2])
        camera = Camera(columns, rows, float(matrix[0, 0]), centre, self.band_um)
        rng = stream(self.seed, "redraw", self.epoch, key)
        return [reading.counts for reading in sense(radiance, time_s, camera, self.sensor, rng)]

    def sense(self, sample: Mapping[str, Any], epoch: int) -> list[UInt16[np.ndarray, "rows columns"]]:
        """Counts of both frames of a sample of `PairDataset` with layer radiance and ``seq_length`` 2."""
        times = np.asarray(sample["time_s"], np.float64)
        return self.at(epoch).counts(sample["radiance"], times, sample["K"][0], sample["key"][1])
