"""What receipts, ``dataset.json`` and ``recipe.lock.json`` must look like: names, types, ranges of all that is used."""

from __future__ import annotations

from typing import Any

from scenegen_datasets.layers import LAYERS
from scenegen_datasets.shape import Each, Maybe, Numbers, Text, Whole, mapping

_NUMBER = Numbers()
_SHA256 = Text(r"[0-9a-f]{64}")
_LINE = Text(r"[^\x00-\x1f\x7f]*")
_NAME = Text(r"[A-Za-z0-9_][A-Za-z0-9._-]{0,127}")  # stands in cards, pages and paths
_QUANTITY = r"[A-Za-z_][A-Za-z0-9_.]{0,63}"
_COUNT = Whole(0, 2**32 - 1)
_SIZE = Whole(0, 2**48)
_SIDE = Whole(1, 65_535)

_FRAME_STATISTICS = {
    "counts_min": Whole(0, 65_535),
    "counts_max": Whole(0, 65_535),
    "saturated": _COUNT,
    "sky_pixels": _COUNT,
    "depth_min_m": Maybe(_NUMBER),
    "depth_median_m": Maybe(_NUMBER),
    "temperature_min_K": Maybe(_NUMBER),
    "temperature_max_K": Maybe(_NUMBER),
}

CLIP: dict[str, Any] = {
    "job": mapping,  # `ClipJob` checks itself
    **dict.fromkeys(
        ("latitude_deg", "hour", "sun_elevation_deg", "speed_mps", "spacing_m", "clearance_m"), _NUMBER
    ),
    "month": Whole(1, 12),
    "day": Whole(1, 31),
    "weather": Each(_NUMBER, pattern=_QUANTITY),
    "width_px": _SIDE,
    "height_px": _SIDE,
    "K": Numbers(3, 3),
    "band_um": Numbers(2),
    "sensor": mapping,
    "rejected": _COUNT,
    "extra": mapping,
}

"""A clip record."""

RECEIPT: dict[str, Any] = {
    "clip": CLIP,
    "layers": [_LINE],
    "shard": {"path": _LINE, "sha256": _SHA256, "size": _SIZE},
    "fingerprint": _LINE,
    "frames": [
        {
            "key": _LINE,
            "time_s": _NUMBER,
            "world_from_camera": Numbers(4, 4),
            "K": Numbers(3, 3),
            "members": mapping,  # offsets are bounded by the receipt's own reader
            "digests": Each(_SHA256),
            "statistics": _FRAME_STATISTICS,
        }
    ],
    "statistics": mapping,
}
"""Body of a receipt."""

_SPLIT = {"pairs": _SIZE, "frames": _SIZE, "clips": _COUNT, "worlds": _COUNT}

DESCRIPTION: dict[str, Any] = {
    "name": _NAME,
    "version": Text(r"[0-9]{1,9}\.[0-9]{1,9}\.[0-9]{1,9}(-dev)?"),
    "recipe_id": _SHA256,
    "content_id": _SHA256,
    "fingerprints": [Each(_LINE)],
    "grid": {"width_px": _SIDE, "height_px": _SIDE},
    "band_um": Numbers(2),
    "sensor": mapping,
    "layers": [
        {
            "name": Text("|".join(LAYERS)),
            "member": _LINE,
            "channels": [_LINE],
            **dict.fromkeys(("dtype", "stored", "unit", "meaning"), _LINE),
        }
    ],
    "members": [_LINE],
    "counts": {**_SPLIT, "shard_bytes": _SIZE},
    "splits": {"train": _SPLIT, "val": _SPLIT, "test": _SPLIT},
    "maps": [_NAME],
    "ranges": Each(Numbers(2), pattern=_QUANTITY),
    "missing": [_LINE],
    "sums": Each(_SHA256, ("clips.jsonl", "index.npy")),
    "conventions": Each(_LINE),
    "classes": [{"id": Whole(0, 255), "name": _LINE}],
    "materials": [{"id": Whole(0, 65_535), "name": _LINE}],
}
"""Body of ``dataset.json``."""

LOCK: dict[str, Any] = {
    "name": _NAME,
    "recipe": mapping,
    "recipe_id": _SHA256,
    "scene_semantics": Whole(0, 10**6),
    "fingerprint": Each(_LINE),
    "fingerprint_id": Text(r"[0-9a-f]{16}"),
    "mixed_with": [Each(_LINE)],
}
"""``recipe.lock.json``."""

PARTS: list[Any] = [
    {
        "name": _NAME,
        "version": _LINE,
        "recipe_id": _SHA256,
        "content_id": _SHA256,
        "missing": [_LINE],
        "worlds": Each([Numbers(2)]),
        "recipe": mapping,
        "scene_semantics": Whole(0, 10**6),
    }
]
"""What the lock of a merged dataset says of its parts."""

HISTORY: dict[str, Any] = {
    "releases": [
        {
            "version": Text(r"[0-9]{1,9}\.[0-9]{1,9}\.[0-9]{1,9}"),
            "recipe_id": _SHA256,
            "content_id": _SHA256,
            "counts": Each(_SIZE),
            "changes": [_LINE],
        }
    ],
    "last": {
        "recipe_id": _SHA256,
        "scene_semantics": Whole(0, 10**6),
        "recipe": mapping,
        "meaning": {"layers": mapping},
        "names": Each(Each(_LINE)),
        "storage": {"schema_version": Whole(1, 10**6), "layers": mapping},
        "clips": Each({"split": _LINE, "facts": _LINE, "shard": _LINE, "layers": Each(_LINE)}),
    },
    "missing": [_LINE],
}
"""Body of ``releases.json``."""
