"""The ``preview`` folder of a dataset: a contact sheet and a short flight. The same bytes for the same data."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import make_directories, write_atomic
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.pictures.animation import animate
from scenegen_datasets.pictures.sheet import contact_sheet
from scenegen_datasets.pictures.shot import shot_of
from scenegen_datasets.source import open_source
from scenegen_datasets.store import LOCK, read_lock
from scenegen_render.camera_knobs import CameraKnobs
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.scale import CountScale

FOLDER = "preview"
SHEET = f"{FOLDER}/contact_sheet.png"
FLIGHT = f"{FOLDER}/flight.webp"

MAX_ROWS = 6
MAX_FRAMES = 48

_SHOWN = ("thermal", "depth", "flow", "semantic", "instance")


def write_preview(root: Path) -> tuple[Path, Path]:
    """Draw both pictures into a dataset, finished or growing.

    Returns
    -------
    (Path, Path)
        Contact sheet (PNG) and flight (animated WebP).

    Raises
    ------
    InputError
        If there is no dataset, or nothing in it yet.
    """
    sheet, flight = draw_preview(root)
    make_directories(root, FOLDER)
    write_atomic(root / SHEET, sheet)
    write_atomic(root / FLIGHT, flight)
    return root / SHEET, root / FLIGHT


def draw_preview(root: Path) -> tuple[bytes, bytes]:
    """Contact sheet (PNG) and flight (animated WebP) of a dataset."""
    lock = read_lock(root)
    scale, maps = _asked(root, lock["recipe"])
    stored = open_source(root, allow_partial=True).layers
    pairs = PairDataset(root, layers=[name for name in _SHOWN if name in stored], allow_partial=True)
    if len(pairs) == 0:
        raise InputError(f"{root} holds no pair yet; let a render finish its first clip")
    per_clip = int(pairs.clip_ends[0])
    clips = max(len(pairs) // per_clip, 1)
    rows = min(MAX_ROWS, max(clips, min(2, len(pairs))))
    chosen = [int((k + 0.5) * len(pairs) / rows) for k in range(rows)]
    shots = [shot_of(pairs[i], scale) for i in chosen]
    first = per_clip * (clips // 2)
    flight = [
        shot_of(pairs[i], scale) for i in range(first, min(first + min(per_clip, MAX_FRAMES), len(pairs)))
    ]
    height, width = shots[0].depth.shape
    subtitle = f"{len(pairs):,} pairs   {width} x {height} px   maps: {', '.join(maps)}"
    file = io.BytesIO()
    contact_sheet(shots, lock["name"], subtitle).save(file, "PNG", compress_level=9)
    return file.getvalue(), animate(flight)


def _asked(root: Path, recipe: Mapping[str, Any]) -> tuple[CountScale, tuple[str, ...]]:
    """Scale of the counts and names of the maps; a lock from elsewhere may hold anything."""
    try:
        scale = CountScale.of(
            SensorKnobs.model_validate(recipe["sensor"]), CameraKnobs.model_validate(recipe["camera"]).band_um
        )
        return scale, tuple(str(name)[:40] for name in recipe["map"])
    except (KeyError, TypeError, ValueError) as error:
        raise DatasetError(
            f"{root / LOCK}: not the recipe of a dataset ({str(error).splitlines()[0]}); restore it from a copy"
        ) from None
