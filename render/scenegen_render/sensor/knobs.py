"""What a user can set about the camera: its lens and its electronics."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenegen.foundation.section import Number, Section, Span

Ratio = Annotated[Number, Field(ge=0.0, le=10.0)]
"""A noise amplitude relative to the NETD."""


class SensorKnobs(Section):
    """Lens and microbolometer read-out: blur, lag, noise, digitisation.

    The seven components of the 3-D noise model are given relative to the temporal pixel noise, which is the quoted
    NETD. No vendor publishes the ratios; the defaults are those of a camera shortly after its shutter correction.
    """

    lens_mtf_nyquist: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.36
    """Modulation the lens leaves of stripes one pixel wide: 0.485 by diffraction at f/1.0 on 12 um pixels, times 0.735
    for a quarter of a pixel of defocus; 1 is a perfect lens."""
    netd_mk: Annotated[Number, Field(ge=0.0, le=10_000.0)] = 50.0
    """Temporal noise of one pixel, as a temperature difference of a 300 K blackbody at f/1 [mK]."""
    fixed_pattern: Ratio = 0.30
    """Pixel-to-pixel pattern that stays for the whole clip, relative to the NETD."""
    fixed_columns: Ratio = 0.15
    """Column offsets that stay for the whole clip, relative to the NETD."""
    fixed_rows: Ratio = 0.08
    """Row offsets that stay for the whole clip, relative to the NETD."""
    flickering_columns: Ratio = 0.05
    """Column offsets drawn anew in each frame, relative to the NETD."""
    flickering_rows: Ratio = 0.05
    """Row offsets drawn anew in each frame, relative to the NETD."""
    flickering_frame: Ratio = 0.02
    """Offset of the whole frame drawn anew in each frame, relative to the NETD."""
    time_constant_ms: Annotated[Number, Field(gt=0.0, le=1000.0)] = 10.0
    """Thermal time constant of a pixel [ms]."""
    scale_K: Span = (233.0, 423.0)
    """Blackbody temperatures of count 0 and count 16,383 [K]; fixed for a dataset."""
    linear_in: Literal["radiance", "temperature"] = "radiance"
    """What the counts are proportional to: band radiance, or brightness temperature ("TLinear")."""
    noise: bool = True
    """False switches all temporal noise off."""
    pattern: bool = True
    """False switches all fixed patterns off."""
    lag: bool = True
    """False lets every pixel follow the scene at once."""

    @model_validator(mode="after")
    def _scale_is_usable(self) -> SensorKnobs:
        low, high = self.scale_K
        if low < 150.0 or high > 1000.0 or high - low < 1.0:
            raise ValueError(f"scale_K [{low:g}, {high:g}] must lie in 150..1000 K and span at least 1 K")
        return self
