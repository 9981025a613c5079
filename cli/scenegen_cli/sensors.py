"""``scenegen sensors``: the cameras known by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from scenegen_cli.listing import Listing, show

COLUMNS = ("name", "size_px", "hfov_deg", "band_um", "netd_mk", "time_constant_ms", "description")


@dataclass(frozen=True)
class Sensors(Listing):
    """List the cameras that --camera.preset knows."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    return show(Sensors, "sensors", arguments, _rows, COLUMNS)


def _rows() -> list[dict[str, Any]]:
    from scenegen_render.camera_knobs import PRESETS

    return [
        {
            "name": preset.name,
            "size_px": f"{preset.camera['width_px']}x{preset.camera['height_px']}",
            "hfov_deg": preset.camera["hfov_deg"],
            "band_um": "-".join(f"{end:g}" for end in preset.camera["band_um"]),
            **preset.sensor,
            "description": preset.description,
        }
        for preset in PRESETS.values()
    ]
