"""Which cameras can look at radiance that was rendered for another one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.foundation.section import Section
from scenegen_datasets.resolve import Source, merge, resolve
from scenegen_render.camera_knobs import CameraKnobs, preset
from scenegen_render.sensor.knobs import SensorKnobs


class CameraKeys(Section):
    """The two sections of a recipe that make a camera."""

    camera: CameraKnobs = CameraKnobs()
    sensor: SensorKnobs = SensorKnobs()


@dataclass(frozen=True)
class NewCamera:
    """A camera that can look at stored radiance.

    Attributes
    ----------
    camera : CameraKnobs
    sensor : SensorKnobs
    side : int
        Stored pixels along the side of one of its pixels.
    """

    camera: CameraKnobs
    sensor: SensorKnobs
    side: int


def new_camera(where: str, recipe: Mapping[str, Any], asked: Mapping[str, Any]) -> NewCamera:
    """The camera that was asked for, on what a dataset stores.

    Parameters
    ----------
    where : str
        The dataset, for messages.
    recipe : mapping
        Of its lock.
    asked : mapping
        Keys of the sections `camera` and `sensor`; a preset goes below the other keys.

    Raises
    ------
    InputError
        If a key is wrong, or the camera sees what was not rendered.
    """
    if "camera" not in recipe or "sensor" not in recipe:
        raise InputError(
            f"{where} was merged of parts with cameras of their own; sense the parts, then merge them"
        )
    stored = {"camera": recipe["camera"], "sensor": recipe["sensor"]}
    before = resolve(CameraKeys, [Source(where, stored)]).camera
    sources = [Source(where, stored)]
    name = merge([asked]).get("camera", {}).get("preset")
    if isinstance(name, str):
        chosen = preset(name)
        sources.append(
            Source(f"camera preset {name}", {"camera": dict(chosen.camera), "sensor": dict(chosen.sensor)})
        )
    keys = resolve(CameraKeys, [*sources, Source("", asked)])
    return NewCamera(keys.camera, keys.sensor, _side(where, before, keys.camera))


def _side(where: str, before: CameraKnobs, after: CameraKnobs) -> int:
    """Pixels of the stored grid along a pixel of the new one; refuses what needs a new render."""
    if after.band_um != before.band_um:
        _refuse(where, "band", "{:g}-{:g} um".format(*before.band_um), "{:g}-{:g} um".format(*after.band_um))
    if after.hfov_deg != before.hfov_deg:
        _refuse(where, "horizontal field of view", f"{before.hfov_deg:g} deg", f"{after.hfov_deg:g} deg")
    side = before.width_px // after.width_px
    grids = [f"{c.width_px}x{c.height_px}" for c in (before, after)]
    if side < 1 or (after.width_px * side, after.height_px * side) != (before.width_px, before.height_px):
        _refuse(where, "image size", f"{grids[0]} (or whole fractions of it)", grids[1])
    return side


def _refuse(where: str, what: str, stored: str, asked: str) -> None:
    raise InputError(
        f"{where} was rendered with {what} {stored}; {asked} needs a new render: scenegen render with that camera"
    )
