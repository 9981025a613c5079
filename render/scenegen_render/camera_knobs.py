"""What a user can set about the camera's optics, and cameras by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import Field, field_validator

from scenegen.foundation.errors import InputError, nearest
from scenegen.foundation.section import Count, Number, Section, Span
from scenegen_render.camera import Camera

Pixels = Annotated[Count, Field(ge=16, le=4096)]


class CameraKnobs(Section):
    """Pixel grid, lens and band of the camera."""

    preset: str = "drone256"
    """Camera whose values stand where nothing else is said; `scenegen sensors` lists them."""
    width_px: Pixels = 256
    """Columns [px]."""
    height_px: Pixels = 256
    """Rows [px]."""
    hfov_deg: Annotated[Number, Field(ge=2.0, le=140.0)] = 90.0
    """Horizontal field of view [deg]; pixels are square, the lens is a pinhole."""
    band_um: Span = (8.0, 14.0)
    """Spectral band [um]."""

    @field_validator("preset")
    @classmethod
    def _known(cls, value: str) -> str:
        if value not in PRESETS:
            raise ValueError(f"unknown camera '{value}'{nearest(value, PRESETS)}")
        return value

    @field_validator("band_um")
    @classmethod
    def _long_wave(cls, value: tuple[float, float]) -> tuple[float, float]:
        if not 7.0 <= value[0] < value[1] <= 15.0 or value[1] - value[0] < 0.5:
            raise ValueError(
                f"[{value[0]:g}, {value[1]:g}] is no long-wave band; 7 to 15 um, at least 0.5 um wide"
            )
        return value

    def camera(self) -> Camera:
        """The pinhole camera these knobs describe."""
        return Camera.from_fov(self.width_px, self.height_px, self.hfov_deg, self.band_um)


@dataclass(frozen=True)
class CameraPreset:
    """A camera by name: values for the recipe's `camera` and `sensor` sections.

    Attributes
    ----------
    name, description : str
    camera, sensor : mapping
        Keys of `CameraKnobs` and `scenegen_render.sensor.knobs.SensorKnobs`.
    """

    name: str
    description: str
    camera: Mapping[str, Any]
    sensor: Mapping[str, Any]


def _preset(
    name: str,
    description: str,
    size_px: tuple[int, int],
    hfov_deg: float,
    band_um: tuple[float, float],
    netd_mk: float,
    time_constant_ms: float,
) -> CameraPreset:
    camera = {"width_px": size_px[0], "height_px": size_px[1], "hfov_deg": hfov_deg, "band_um": band_um}
    return CameraPreset(name, description, camera, {"netd_mk": netd_mk, "time_constant_ms": time_constant_ms})


PRESETS: Mapping[str, CameraPreset] = MappingProxyType(
    {
        preset.name: preset
        for preset in (
            _preset(
                "drone256",
                "square wide-angle, as learned flight uses it",
                (256, 256),
                90.0,
                (8.0, 14.0),
                50.0,
                10.0,
            ),
            _preset(
                "boson640",
                "FLIR Boson 640, 9.1 mm lens, industrial grade",
                (640, 512),
                50.0,
                (7.5, 13.5),
                50.0,
                8.0,
            ),
            _preset("boson640wide", "FLIR Boson 640, 4.9 mm lens", (640, 512), 95.0, (7.5, 13.5), 50.0, 8.0),
            _preset("tau640", "FLIR Tau 2 640, 13 mm lens", (640, 512), 45.0, (7.5, 13.5), 50.0, 10.0),
            _preset("lepton35", "FLIR Lepton 3.5", (160, 120), 57.0, (8.0, 14.0), 50.0, 12.0),
        )
    }
)
"""All cameras by name. NETD and field of view from the makers' data sheets, time constants typical for VOx."""


def preset(name: str) -> CameraPreset:
    """Look a camera up.

    Raises
    ------
    InputError
        If there is none of this name; names the nearest one.
    """
    try:
        return PRESETS[name]
    except KeyError:
        raise InputError(f"unknown camera '{name}'{nearest(name, PRESETS)}") from None
