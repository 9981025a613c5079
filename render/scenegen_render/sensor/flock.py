"""The thermal cameras of many drones: a unit for each, with its own fixed pattern, lag and noise."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float32, Int64, UInt16

from scenegen_render.camera import Camera
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.sense import Microbolometer


class Flock:
    """Microbolometers by the ids of their drones; what one reads does not depend on the others.

    Parameters
    ----------
    camera : Camera
    knobs : SensorKnobs
    rngs : mapping of int to numpy.random.Generator
        The generator of each drone's unit, by its id.
    """

    def __init__(self, camera: Camera, knobs: SensorKnobs, rngs: Mapping[int, np.random.Generator]) -> None:
        self._shape = (camera.height_px, camera.width_px)
        self._units = {drone: Microbolometer(camera, knobs, rng) for drone, rng in rngs.items()}

    def read(
        self,
        drones: Int64[np.ndarray, "drones"],
        radiance: Float32[np.ndarray, "drones rows columns"],
        time_s: float,
    ) -> UInt16[np.ndarray, "drones rows columns"]:
        """Read the next frame of some drones out.

        Parameters
        ----------
        drones : int64 (drones,)
            Whose frames these are; drones may be missing, for a frame or for ever.
        radiance : float32 (drones, rows, columns)
            Band radiance [W m^-2 sr^-1], finite.
        time_s : float
            Later than the last frame of each of them [s].

        Returns
        -------
        uint16 (drones, rows, columns)
            14-bit counts, see `CountScale`.
        """
        counts = np.empty((len(drones), *self._shape), np.uint16)
        for k, (drone, frame) in enumerate(zip(drones.tolist(), radiance, strict=True)):
            counts[k] = self._units[drone].read(frame, time_s).counts
        return counts
