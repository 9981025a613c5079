"""Check one clip: its receipt, every byte of its shard, every decoded array.

The shard is walked from its first byte to its last against the layout that `scenegen_datasets.tar` writes for the
members in the receipt; links, devices, absolute names, gaps and trailing data all differ from it, and nothing is
allocated that the receipt, the file's real size and the image size do not allow.
"""

from __future__ import annotations

import hashlib
import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation import canonical
from scenegen.foundation.errors import CorruptFrameError, DatasetError
from scenegen_datasets import tar
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.content import clip_digest
from scenegen_datasets.finish import clip_line
from scenegen_datasets.index import rows_of
from scenegen_datasets.inside import open_inside
from scenegen_datasets.invariants import violations
from scenegen_datasets.job import ClipJob
from scenegen_datasets.layers import LAYERS, MEMBERS
from scenegen_datasets.pixels import array_digest, decode_member
from scenegen_datasets.receipt import FrameEntry, Receipt, read_receipt
from scenegen_datasets.statistics import frame_statistics
from scenegen_datasets.verify.report import Finding

_POSE_TOLERANCE = 1e-6


@dataclass(frozen=True)
class ClipCheck:
    """What one clip gave: its findings, and what the dataset's own files must say of it."""

    receipt: str
    findings: tuple[Finding, ...]
    job: ClipJob | None = None
    clip: ClipRecord | None = None
    frames: int = 0
    size: int = 0
    sha256: str = ""
    digest: str = ""
    line: bytes = b""
    rows: bytes = b""
    fingerprint: str = ""


def check_clip(root: Path, path: str, quick: bool) -> ClipCheck:
    """Check the clip whose receipt lies at `path` below `root`; `quick` stops at the size of the shard."""
    try:
        receipt = read_receipt(root, path)
    except DatasetError as error:
        return ClipCheck(path, (Finding(path, str(error).removeprefix(f"{path}: ")),))
    job = receipt.clip.job
    findings = [*_receipt_findings(receipt, path)]
    try:
        findings += _shard_findings(root, receipt, quick)
    except OSError as error:
        findings.append(Finding(job.shard, f"cannot be read: {error.strerror or error}"))
    digest = clip_digest(receipt)
    return ClipCheck(
        receipt=path,
        findings=tuple(findings),
        job=job,
        clip=receipt.clip,
        frames=job.frames,
        size=receipt.size,
        sha256=receipt.sha256,
        digest=digest,
        line=canonical.canonical(clip_line(receipt, digest)),
        rows=rows_of(receipt).tobytes(),
        fingerprint=receipt.fingerprint,
    )


def _receipt_findings(receipt: Receipt, path: str) -> Iterator[Finding]:
    """Facts that need no pixels: poses, times, members."""
    wanted = [m for m in MEMBERS if m == "json" or any(LAYERS[x].member == m for x in receipt.layers)]
    digests = {*receipt.layers, "json"}
    times = [f.time_s for f in receipt.frames]
    if times[0] != 0 or any(a >= b for a, b in pairwise(times)):
        yield Finding(path, "times do not rise from 0")
    for frame in receipt.frames:
        if list(frame.members) != wanted or set(frame.digests) != digests:
            yield Finding(path, f"{frame.key} has other members than the layers of the clip need")
        if not _is_pose(np.array(frame.world_from_camera, np.float64)):
            yield Finding(path, f"{frame.key}: the pose is not a rotation and a translation")
        if frame.K != receipt.clip.K:
            yield Finding(path, f"{frame.key}: K differs from that of the clip")


def _is_pose(pose: NDArray[np.float64]) -> bool:
    if pose.shape != (4, 4) or not np.isfinite(pose).all() or pose[3].tolist() != [0, 0, 0, 1]:
        return False
    rotation = pose[:3, :3]
    return bool(
        np.abs(rotation @ rotation.T - np.eye(3)).max() < _POSE_TOLERANCE and np.linalg.det(rotation) > 0
    )


def _shard_findings(root: Path, receipt: Receipt, quick: bool) -> list[Finding]:
    job = receipt.clip.job
    try:
        descriptor = open_inside(root, job.shard)
    except DatasetError as error:
        return [Finding(job.shard, str(error).removeprefix(f"{job.shard}: "))]
    with os.fdopen(descriptor, "rb") as stream:
        size = os.fstat(descriptor).st_size
        if size != receipt.size:
            return [Finding(job.shard, f"{size} bytes, the receipt says {receipt.size}")]
        return [] if quick else _Walk(stream, receipt).findings()


class _Walk:
    """One pass over a shard that hashes every byte and checks every member on the way."""

    def __init__(self, stream: BinaryIO, receipt: Receipt) -> None:
        self._stream = stream
        self._receipt = receipt
        self._hash = hashlib.sha256()
        self._at = 0
        self._shape = (receipt.clip.height_px, receipt.clip.width_px)

    def findings(self) -> list[Finding]:
        shard = self._receipt.clip.job.shard
        found: list[Finding] = []
        for frame in self._receipt.frames:
            found += [Finding(f"{shard}: {name}", reason) for name, reason in self._frame(frame)]
        if self._rest() != tar.trailer(self._at):
            found.append(Finding(shard, "does not end as a tar of ours ends"))
        if self._hash.hexdigest() != self._receipt.sha256:
            found.append(Finding(shard, "SHA-256 differs from the receipt"))
        return found

    def _frame(self, frame: FrameEntry) -> Iterator[tuple[str, str]]:
        arrays: dict[str, NDArray[Any]] = {}
        for suffix in frame.members:
            name = f"{frame.key}.{suffix}"
            try:
                arrays |= self._member(frame, suffix)
            except CorruptFrameError as error:
                yield name, str(error)
        for text in violations(arrays):
            yield frame.key, text
        if _statistics_differ(frame, arrays):
            yield frame.key, "statistics in the receipt differ from the pixels"

    def _member(self, frame: FrameEntry, suffix: str) -> dict[str, NDArray[Any]]:
        span = frame.members[suffix]
        header = tar.header(f"{frame.key}.{suffix}", span.size)
        sound = self._take(len(header)) == header and span.offset == self._at
        data = self._take(span.size)
        sound &= not any(self._take(-span.size % tar.BLOCK))
        if not sound:
            raise CorruptFrameError("does not stand in the tar as the receipt says")
        if zlib.crc32(data) != span.crc32:
            raise CorruptFrameError("CRC-32 of the stored bytes differs from the receipt")
        if suffix == "json":
            _check_json(frame, data)
            return {}
        layers = tuple(LAYERS[x] for x in self._receipt.layers if LAYERS[x].member == suffix)
        arrays = decode_member(suffix, layers, data, self._shape)
        wrong = [name for name, array in arrays.items() if array_digest(array) != frame.digests.get(name)]
        if wrong:
            raise CorruptFrameError(f"decoded {', '.join(wrong)} differs from the digest in the receipt")
        return arrays

    def _take(self, size: int) -> bytes:
        data = self._stream.read(size)
        self._hash.update(data)
        self._at += len(data)
        return data

    def _rest(self) -> bytes:
        """What follows the last member; position stays at its start, a long tail is hashed in pieces."""
        head = self._stream.read(len(tar.trailer(self._at)))
        self._hash.update(head)
        tail = self._stream.read(1)
        self._hash.update(tail)
        while block := self._stream.read(1 << 20):
            self._hash.update(block)
        return head + tail


def _check_json(frame: FrameEntry, data: bytes) -> None:
    try:
        content = canonical.parse(data, "JSON member")
    except DatasetError as error:
        raise CorruptFrameError(str(error)) from None
    if canonical.canonical(content) != data or canonical.digest(content) != frame.digests.get("json"):
        raise CorruptFrameError("differs from the digest in the receipt")
    told = (content.get("key"), content.get("time_s"), content.get("world_from_camera"), content.get("K"))
    if told != (
        frame.key,
        frame.time_s,
        [list(r) for r in frame.world_from_camera],
        [list(r) for r in frame.K],
    ):
        raise CorruptFrameError("key, time, pose or K differ from the receipt")


def _statistics_differ(frame: FrameEntry, arrays: dict[str, NDArray[Any]]) -> bool:
    if not {"thermal", "depth", "temperature"} <= set(arrays):
        return False
    saturated = frame.statistics.get("saturated", 0)
    told = frame_statistics(arrays["thermal"], arrays["depth"], arrays["temperature"], saturated)
    return told != dict(frame.statistics)
