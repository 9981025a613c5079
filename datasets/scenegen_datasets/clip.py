"""What is known of a clip besides its pixels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from scenegen_datasets.job import ClipJob


@dataclass(frozen=True)
class ClipRecord:
    """Facts of one clip: plain data that becomes one line of ``clips.jsonl``.

    Attributes
    ----------
    job : ClipJob
    latitude_deg : float
        North positive; drawn per world.
    month, day : int
        Date, of a year without a leap day; drawn per world.
    hour : float
        Local mean solar time [h]; heat is frozen during a clip.
    sun_elevation_deg : float
        Above the horizon; negative at night.
    weather : mapping of str to float
        Fields of `scenegen.climate.weather.Weather`, units in the names.
    width_px, height_px : int
        Pixel grid of every layer.
    K : tuple of tuple of float
        Intrinsic matrix, 3x3, row by row [px].
    band_um : (float, float)
        Spectral band of `radiance` and `thermal` [um].
    sensor : mapping
        What turns counts into radiance and how the noise was drawn; must name ``low_radiance``, ``high_radiance``
        [W m^-2 sr^-1] and ``counts``, the same in all clips of a dataset.
    speed_mps, spacing_m, clearance_m : float
        Of the flight: mean speed, distance between frames along the way, smallest proven distance to the mesh.
    rejected : int
        Flights that were drawn and rejected before this one.
    extra : mapping
        Further plain facts (style of the flight and why others were rejected, objects in the world, ...).
    """

    job: ClipJob
    latitude_deg: float
    month: int
    day: int
    hour: float
    sun_elevation_deg: float
    weather: Mapping[str, float]
    width_px: int
    height_px: int
    K: tuple[tuple[float, float, float], ...]
    band_um: tuple[float, float]
    sensor: Mapping[str, float | int | str]
    speed_mps: float
    spacing_m: float
    clearance_m: float
    rejected: int
    extra: Mapping[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return plain data; `from_dict` reads it back exactly."""
        return asdict(self)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> ClipRecord:
        """Read what `to_dict` returned, lists in place of tuples allowed."""
        fields = dict(data)
        fields["job"] = ClipJob(**fields["job"])
        fields["K"] = tuple(tuple(row) for row in fields["K"])
        fields["band_um"] = tuple(fields["band_um"])
        return cls(**fields)
