"""What a finished clip holds, to be checked against its shard."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.documents import RECEIPT
from scenegen_datasets.inside import read_inside, walk
from scenegen_datasets.job import SPLITS
from scenegen_datasets.layers import LAYERS, MEMBERS, max_member_bytes
from scenegen_datasets.seal import sealed, sealed_body, unsealed
from scenegen_datasets.shape import misshapen

SCHEMA = 1
"""Version of receipts, index and ``dataset.json``; a reader refuses what is newer than itself."""

_MAX_BYTES = 64 << 20
_RECEIPT = re.compile(r"(?s)receipts/[a-z]+/[^/]+/[^/.][^/]*\.json")
_SHARD = re.compile(rb'"shard":\{"path":"([^"]+)","sha256":"[0-9a-f]{64}","size":([0-9]{1,15})\}')


@dataclass(frozen=True)
class Span:
    """Where a member's bytes lie in the shard, and their CRC-32."""

    offset: int
    size: int
    crc32: int


@dataclass(frozen=True)
class FrameEntry:
    """One frame of a receipt.

    Attributes
    ----------
    key : str
    time_s : float
    world_from_camera, K : tuple of tuple of float
    members : mapping of str to Span
        By suffix, in the order they stand in the shard.
    digests : mapping of str to str
        Layer to SHA-256 of the decoded array; ``json`` to that of the member's canonical content.
    statistics : mapping
    """

    key: str
    time_s: float
    world_from_camera: tuple[tuple[float, ...], ...]
    K: tuple[tuple[float, ...], ...]
    members: Mapping[str, Span]
    digests: Mapping[str, str]
    statistics: Mapping[str, Any]


@dataclass(frozen=True)
class Receipt:
    """Proof of one committed clip.

    Attributes
    ----------
    clip : ClipRecord
    layers : tuple of str
    size : int
        Bytes of the shard.
    sha256 : str
        Of the shard.
    fingerprint : str
        Id of the render fingerprint the pixels were made with.
    frames : tuple of FrameEntry
    statistics : mapping
        Of the clip (`scenegen_datasets.statistics.clip_statistics`).
    """

    clip: ClipRecord
    layers: tuple[str, ...]
    size: int
    sha256: str
    fingerprint: str
    frames: tuple[FrameEntry, ...]
    statistics: Mapping[str, Any]

    def to_bytes(self) -> bytes:
        """Return the file."""
        return sealed("receipt", self._to_dict())

    def _to_dict(self) -> dict[str, Any]:
        frames = [
            {
                "key": f.key,
                "time_s": f.time_s,
                "world_from_camera": f.world_from_camera,
                "K": f.K,
                "members": {suffix: [s.offset, s.size, s.crc32] for suffix, s in f.members.items()},
                "digests": dict(f.digests),
                "statistics": dict(f.statistics),
            }
            for f in self.frames
        ]
        return {
            "schema_version": SCHEMA,
            "clip": self.clip.to_dict(),
            "layers": list(self.layers),
            "shard": {"path": self.clip.job.shard, "sha256": self.sha256, "size": self.size},
            "fingerprint": self.fingerprint,
            "frames": frames,
            "statistics": dict(self.statistics),
        }


def read_receipt(root: Path, path: str) -> Receipt:
    """Read one receipt by its path below the dataset.

    Raises
    ------
    DatasetError
        If it is missing, damaged, of a newer schema, or does not say what a receipt at this place must say.
    """
    data = unsealed("receipt", read_inside(root, path, _MAX_BYTES), path)
    if data.get("schema_version") != SCHEMA:
        raise DatasetError(
            f"{path}: schema {data.get('schema_version')}, this version reads {SCHEMA}; update scenegen"
        )
    wrong = misshapen(data, RECEIPT)
    if wrong:
        raise DatasetError(f"{path}: not a receipt ({wrong})")
    try:
        receipt = _receipt(data)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise DatasetError(f"{path}: not a receipt ({type(error).__name__}: {error})") from None
    problem = _inconsistency(receipt, path)
    if problem:
        raise DatasetError(f"{path}: {problem}")
    return receipt


def promised_size(root: Path, path: str) -> int:
    """Size of the shard that a sound receipt promises, without parsing the rest: 0.1 ms instead of 2.

    Raises
    ------
    DatasetError
        If the receipt is missing, damaged, or of another clip.
    """
    body = sealed_body("receipt", read_inside(root, path, _MAX_BYTES), path)
    match = _SHARD.search(body)
    if match is None or match[1].decode() != shard_of(path):
        raise DatasetError(f"{path}: speaks of another clip")
    return int(match[2])


def shard_of(path: str) -> str:
    """Path of the shard that belongs to the receipt at `path`."""
    return path.replace("receipts/", "shards/", 1).removesuffix(".json") + ".tar"


def _receipt(data: Mapping[str, Any]) -> Receipt:
    return Receipt(
        clip=ClipRecord.from_dict(data["clip"]),
        layers=tuple(data["layers"]),
        size=data["shard"]["size"],
        sha256=data["shard"]["sha256"],
        fingerprint=data["fingerprint"],
        frames=tuple(_frame(f) for f in data["frames"]),
        statistics=data["statistics"],
    )


def _frame(data: Mapping[str, Any]) -> FrameEntry:
    return FrameEntry(
        key=data["key"],
        time_s=float(data["time_s"]),
        world_from_camera=tuple(tuple(row) for row in data["world_from_camera"]),
        K=tuple(tuple(row) for row in data["K"]),
        members={m: Span(*data["members"][m]) for m in MEMBERS if m in data["members"]},
        digests=data["digests"],
        statistics=data["statistics"],
    )


def _inconsistency(receipt: Receipt, path: str) -> str | None:
    """Return what contradicts itself, or None. Offsets are bounded here, once, for every reader."""
    job = receipt.clip.job
    if job.receipt != path or job.split not in SPLITS:
        return f"speaks of {job.receipt}"
    if not set(receipt.layers) <= set(LAYERS):
        return "names unknown layers"
    if [f.key for f in receipt.frames] != [job.key(k) for k in range(job.frames)]:
        return f"holds {len(receipt.frames)} frames where the {job.frames} of {job.name} belong"
    limit = max_member_bytes((receipt.clip.height_px, receipt.clip.width_px))
    for frame in receipt.frames:
        for suffix, span in frame.members.items():
            if not (type(span.offset) is type(span.size) is type(span.crc32) is int):
                return f"{frame.key}.{suffix}: offset and size are not whole numbers"
            if not (512 <= span.offset <= receipt.size - span.size and 0 <= span.size <= limit):
                return f"{frame.key}.{suffix} lies outside the shard"
    return None


def receipt_paths(root: Path) -> list[str]:
    """Paths of all receipts below a dataset, sorted; links are not followed."""
    found: list[str] = []
    for split in SPLITS:
        with contextlib.suppress(DatasetError):  # no clip of this split yet
            found += [e.path for e in walk(root, f"receipts/{split}") if _RECEIPT.fullmatch(e.path)]
    return sorted(found)
