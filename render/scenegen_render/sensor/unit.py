"""One camera unit: the part of the noise that a shutter correction leaves behind and that stays for a clip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from scenegen_render.sensor.knobs import SensorKnobs


@dataclass(frozen=True, eq=False)
class CameraUnit:
    """Fixed pattern of one unit.

    Attributes
    ----------
    pixel : float32 (rows, columns)
        Offset of each pixel ("vh" of the 3-D noise model) [W m^-2 sr^-1].
    column : float32 (columns,)
        Offset shared by each column ("h") [W m^-2 sr^-1].
    row : float32 (rows,)
        Offset shared by each row ("v") [W m^-2 sr^-1].
    """

    pixel: Float32[np.ndarray, "rows columns"]
    column: Float32[np.ndarray, "columns"]
    row: Float32[np.ndarray, "rows"]

    def offset(self) -> Float32[np.ndarray, "rows columns"]:
        """Sum of the three parts [W m^-2 sr^-1]."""
        return np.asarray(self.pixel + self.column[None, :] + self.row[:, None])


def draw_unit(
    shape: tuple[int, int], sigma: float, knobs: SensorKnobs, rng: np.random.Generator
) -> CameraUnit:
    """Draw the fixed pattern of one unit.

    Parameters
    ----------
    shape : (int, int)
        Rows and columns.
    sigma : float
        Radiance noise that belongs to the NETD [W m^-2 sr^-1].
    knobs : SensorKnobs
    rng : numpy.random.Generator
        Each part has its own child, so that switching one off leaves the others as they are.
    """
    rows, columns = shape
    pixel_rng, column_rng, row_rng = rng.spawn(3)
    return CameraUnit(
        pixel=_normal(pixel_rng, (rows, columns), knobs.fixed_pattern * sigma),
        column=_normal(column_rng, (columns,), knobs.fixed_columns * sigma),
        row=_normal(row_rng, (rows,), knobs.fixed_rows * sigma),
    )


def _normal(rng: np.random.Generator, shape: tuple[int, ...], sigma: float) -> Float32[np.ndarray, "..."]:
    offset: Float32[np.ndarray, "..."] = rng.standard_normal(shape, dtype=np.float32)
    offset *= np.float32(sigma)
    return np.asarray(offset)
