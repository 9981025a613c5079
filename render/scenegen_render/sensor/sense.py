"""The microbolometer: radiance frames in order become 14-bit readings. Numpy only, seeded.

The lens softens the scene (`lens.py`). A pixel is a first-order low-pass of it; its signal carries temporal noise
(NETD) and a fixed pattern, in radiance, because the detector's noise does not depend on the scene: the noise-equivalent
temperature difference grows towards cold scenes by itself. Noise components follow the 3-D noise model (D'Agostino and
Webb, 1991).
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from jaxtyping import Float32, Float64

from scenegen.radiometry.planck import band_radiance_slope
from scenegen_render.camera import Camera
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.lens import blurred
from scenegen_render.sensor.reading import Reading
from scenegen_render.sensor.scale import MAX_COUNT, CountScale, radiance_to_counts
from scenegen_render.sensor.unit import CameraUnit, draw_unit

NETD_REFERENCE_K = 300.0
"""Blackbody temperature the NETD is quoted at [K]."""


def noise_radiance(netd_mk: float, band_um: tuple[float, float]) -> float:
    """Radiance noise [W m^-2 sr^-1] of a NETD [mK] quoted at 300 K: NETD dL/dT."""
    slope = band_radiance_slope(np.array([NETD_REFERENCE_K]), band_um)
    return netd_mk * 1e-3 * float(slope[0])


def sense(
    radiance: Iterable[Float32[np.ndarray, "rows columns"]],
    time_s: Float64[np.ndarray, "frames"],
    camera: Camera,
    knobs: SensorKnobs,
    rng: np.random.Generator,
) -> list[Reading]:
    """Sense one clip.

    Parameters
    ----------
    radiance : iterable of float32 (rows, columns)
        Noise-free band radiance at the sensor, in flight order [W m^-2 sr^-1].
    time_s : float64 (frames,)
        Time stamps, increasing [s].
    camera : Camera
        Its grid and band; the radiance must have been rendered with both.
    knobs : SensorKnobs
    rng : numpy.random.Generator
        The clip's generator. Reading k depends on it and on frames 0..k only.

    Returns
    -------
    list of Reading
    """
    detector = Microbolometer(camera, knobs, rng)
    return [detector.read(frame, float(t)) for frame, t in zip(radiance, time_s, strict=True)]


class Microbolometer:
    """One camera unit at work: holds the pixel state between frames.

    Parameters
    ----------
    camera : Camera
    knobs : SensorKnobs
    rng : numpy.random.Generator
        The clip's generator; the fixed pattern and the temporal noise have their own children.
    """

    def __init__(self, camera: Camera, knobs: SensorKnobs, rng: np.random.Generator) -> None:
        unit_rng, self._rng = rng.spawn(2)
        self._shape = (camera.height_px, camera.width_px)
        self._knobs = knobs
        self._sigma = noise_radiance(knobs.netd_mk, camera.band_um)
        self.scale = CountScale.of(knobs, camera.band_um)
        self.unit: CameraUnit = draw_unit(self._shape, self._sigma, knobs, unit_rng)
        self._pattern = self.unit.offset()
        self._state: Float32[np.ndarray, "rows columns"] | None = None
        self._time_s = -math.inf

    def read(self, radiance: Float32[np.ndarray, "rows columns"], time_s: float) -> Reading:
        """Read the next frame out.

        Parameters
        ----------
        radiance : float32 (rows, columns)
            Band radiance [W m^-2 sr^-1], finite.
        time_s : float
            Later than the previous call's [s].

        Raises
        ------
        ValueError
            If the frame is not on the camera's grid, not finite, or not later than the one before.
        """
        self._check(radiance, time_s)
        focused = blurred(radiance, self._knobs.lens_mtf_nyquist)
        signal = self._follow(focused, time_s).copy()
        if self._knobs.noise:
            self._add_temporal_noise(signal)
        if self._knobs.pattern:
            signal += self._pattern
        counts = radiance_to_counts(signal, self.scale)
        return Reading(counts, int(np.count_nonzero((counts == 0) | (counts == MAX_COUNT))))

    def _check(self, radiance: Float32[np.ndarray, "rows columns"], time_s: float) -> None:
        if radiance.shape != self._shape:
            raise ValueError(f"frame is {radiance.shape}, the camera has {self._shape} (rows, columns)")
        if not time_s > self._time_s:
            raise ValueError(f"frame at {time_s} s does not follow the one at {self._time_s} s")
        if not np.isfinite(radiance).all():
            raise ValueError(f"radiance of the frame at {time_s} s is not finite")

    def _follow(
        self, radiance: Float32[np.ndarray, "rows columns"], time_s: float
    ) -> Float32[np.ndarray, "rows columns"]:
        """First-order lag; the pixels have settled on the first frame before the clip begins."""
        if self._state is None or not self._knobs.lag:
            self._state = radiance
        else:
            stay = math.exp((self._time_s - time_s) / (1e-3 * self._knobs.time_constant_ms))
            self._state = radiance + np.float32(stay) * (self._state - radiance)
        self._time_s = time_s
        return self._state

    def _add_temporal_noise(self, signal: Float32[np.ndarray, "rows columns"]) -> None:
        """Add the parts that change from frame to frame, in place. Draws the same numbers whatever the amplitudes."""
        rows, columns = self._shape
        knobs, sigma = self._knobs, self._sigma
        pixel = self._rng.standard_normal((rows, columns), dtype=np.float32)
        row = self._rng.standard_normal((rows, 1), dtype=np.float32)
        column = self._rng.standard_normal(columns, dtype=np.float32)
        frame = self._rng.standard_normal(dtype=np.float32)
        row *= np.float32(knobs.flickering_rows)
        column *= np.float32(knobs.flickering_columns)
        column += np.float32(knobs.flickering_frame * float(frame))
        pixel += row
        pixel += column
        pixel *= np.float32(sigma)
        signal += pixel
