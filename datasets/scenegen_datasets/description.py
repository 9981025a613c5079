"""``dataset.json``: what the whole dataset is. Written last; its presence says that everything else is there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.classes import CLASSES
from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError
from scenegen.materials.table import materials
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.documents import DESCRIPTION
from scenegen_datasets.job import SPLITS, ClipJob
from scenegen_datasets.layers import LAYERS, MEMBERS
from scenegen_datasets.licence import licence_of
from scenegen_datasets.lock import SOURCE
from scenegen_datasets.receipt import SCHEMA
from scenegen_datasets.seal import check_seal, read_bounded, with_seal
from scenegen_datasets.shape import misshapen
from scenegen_datasets.splits.faults import split_rule

CONVENTIONS = {
    "world": "right-handed ENU: x east, y north, z up [m]",
    "camera": "OpenCV: x right, y down, z forward",
    "pose": "world_from_camera, 4x4: maps camera points to world points",
    "pixel": "(0, 0) is the upper left pixel, its centre at (0.5, 0.5); u right, v down",
    "depth": "planar z of the surface through the pixel centre, not ray length; sky is +inf",
    "flow": "forward: a pixel of frame t is found at pixel + flow in frame t+1; NaN only behind the other camera",
    "pair": "thermal and depth of one frame that has a predecessor; frame 0 of a clip is stored but is no pair",
    "hour": "local mean solar time; heat is frozen during a clip",
}
"""The conventions a reader needs, repeated in every dataset."""

MAX_BYTES = 64 << 20
"""No sound ``dataset.json`` is larger."""

_LOCK_ONLY = ("recipe", "scene_semantics", "software", SOURCE)
"""What a merged dataset's lock says of each part, and ``dataset.json`` need not repeat."""

_RANGES = ("hour", "latitude_deg", "sun_elevation_deg", "speed_mps", "clearance_m")


def describe(
    lock: Mapping[str, Any],
    records: Sequence[ClipRecord],
    layers: Iterable[str],
    *,
    version: str,
    content_id: str,
    missing: Sequence[str],
    shard_bytes: int,
) -> dict[str, Any]:
    """Compose the content of ``dataset.json``; `sealed_description` makes it proof of the files beside it.

    Raises
    ------
    DatasetError
        If the clips disagree on image size, band or scale of the sensor.
    """
    jobs = [r.job for r in records]
    return {
        "name": lock["name"],
        "version": version,
        "schema_version": SCHEMA,
        "license": licence_of(lock),
        "recipe_id": lock["recipe_id"],
        "content_id": content_id,
        "fingerprints": [lock["fingerprint"], *lock["mixed_with"]],
        "conventions": CONVENTIONS,
        "grid": _common(records, lambda r: {"height_px": r.height_px, "width_px": r.width_px}, "image size"),
        "band_um": _common(records, lambda r: list(r.band_um), "band"),
        "sensor": _common(records, lambda r: dict(r.sensor), "sensor"),
        "layers": [_layer(name) for name in layers],
        "members": [m for m in MEMBERS if m == "json" or any(LAYERS[x].member == m for x in layers)],
        "counts": {
            "pairs": sum(j.pairs for j in jobs),
            "frames": sum(j.frames for j in jobs),
            "clips": len(jobs),
            "worlds": len({(j.map, j.world) for j in jobs}),
            "shard_bytes": shard_bytes,
        },
        "splits": {s: _split(s, jobs) for s in SPLITS},
        "split_rule": split_rule(lock),
        "maps": sorted({j.map for j in jobs}),
        "ranges": {name: list(span) for name, span in ranges_of(records).items()},
        "missing": list(missing),
        "parts": [{k: v for k, v in part.items() if k not in _LOCK_ONLY} for part in lock.get("parts", ())],
        "classes": [
            {"id": int(c.id), "name": c.name, "colour": list(c.colour), "thing": c.thing} for c in CLASSES
        ],
        "materials": [{"id": m.id, "name": m.name, "emissivity": m.emissivity} for m in materials().values()],
    }


def sealed_description(description: Mapping[str, Any], sums: Mapping[str, str]) -> bytes:
    """Return the file: `description`, the SHA-256 of every other derived file, and a seal over all of it."""
    return canonical.pretty(with_seal({**description, "sums": dict(sums)}))


def read_description(path: Path) -> dict[str, Any]:
    """Read ``dataset.json``.

    Raises
    ------
    DatasetError
        If it is missing, damaged, or of a newer schema.
    """
    return description_of(read_bounded(path, MAX_BYTES), str(path))


def description_of(data: bytes, path: str) -> dict[str, Any]:
    """Read the content of a ``dataset.json`` that lies at `path`; errors as `read_description`."""
    value = canonical.parse(data, path)
    if (
        isinstance(value, dict)
        and isinstance(value.get("schema_version"), int)
        and value["schema_version"] > SCHEMA
    ):
        raise DatasetError(
            f"{path}: schema {value['schema_version']}, this version reads {SCHEMA}; update scenegen"
        )
    body = check_seal(value, path)
    if canonical.pretty(value) != data:
        raise DatasetError(f"{path}: changed or damaged (not laid out as it was written)")
    wrong = misshapen(body, DESCRIPTION)
    if wrong:
        raise DatasetError(f"{path}: makes no sense: {wrong}; run `scenegen verify`")
    return body


def _layer(name: str) -> dict[str, Any]:
    layer = LAYERS[name]
    return {
        "name": name,
        "member": layer.member,
        "channels": list(layer.channels),
        "dtype": layer.dtype,
        "stored": layer.stored,
        "unit": layer.unit,
        "meaning": layer.meaning,
    }


def _split(split: str, jobs: Sequence[ClipJob]) -> dict[str, int]:
    mine = [j for j in jobs if j.split == split]
    return {
        "pairs": sum(j.pairs for j in mine),
        "frames": sum(j.frames for j in mine),
        "clips": len(mine),
        "worlds": len({(j.map, j.world) for j in mine}),
    }


def _common(records: Sequence[ClipRecord], get: Any, what: str) -> Any:
    found = {canonical.digest(get(r)): get(r) for r in records}
    if len(found) > 1:
        raise DatasetError(f"clips disagree on their {what}: {list(found.values())[:2]}")
    return next(iter(found.values()), None)


def ranges_of(records: Iterable[ClipRecord]) -> dict[str, tuple[float, float]]:
    """Smallest and largest value over the clips of what a reader may want to filter by."""
    values: dict[str, list[float]] = {}
    for record in records:
        for name in _RANGES:
            values.setdefault(name, []).append(float(getattr(record, name)))
        for name, value in record.weather.items():
            values.setdefault(f"weather.{name}", []).append(float(value))
    return {name: (min(found), max(found)) for name, found in sorted(values.items())}
