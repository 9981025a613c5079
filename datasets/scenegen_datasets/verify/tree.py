"""Check what binds the clips together: manifest, index, clip list, description, and what does not belong."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.content import content_id
from scenegen_datasets.description import read_description
from scenegen_datasets.index import ROW, open_index
from scenegen_datasets.inside import sha256_inside
from scenegen_datasets.lock import fingerprint_id, recipe_id
from scenegen_datasets.manifest import read_manifest
from scenegen_datasets.seal import read_bounded
from scenegen_datasets.splits.faults import split_faults
from scenegen_datasets.store import CLIPS, DATASET, INDEX, LOCK, MANIFEST, read_lock
from scenegen_datasets.verify.clip import ClipCheck
from scenegen_datasets.verify.report import Finding
from scenegen_datasets.verify.strays import find_strays

_MAX_CLIPS_BYTES = 256 << 20
_MAX_BYTES = 1 << 30
_MOST_LINES = 1000
"""Lines of the list of clips that are named one by one."""


def check_tree(root: Path, checks: Sequence[ClipCheck]) -> Iterator[Finding]:
    """Check the whole against its clips; `checks` in any order."""
    sound = [c for _, c in sorted((c.job, c) for c in checks if c.job is not None)]
    yield from _leaks(sound)
    lock = read_lock(root)
    yield from _lock(lock, sound)
    manifest, unread = _manifest(root)
    mine = {path for c in sound for path in (c.receipt, c.job.shard if c.job else "")} | {
        c.receipt for c in checks
    }
    files, strays = find_strays(root, mine | manifest.keys())
    yield from (Finding(stray.path, stray.reason) for stray in strays)
    if DATASET not in files:
        yield Finding(DATASET, "missing: the dataset still grows; finish it with the same render command")
        return
    description: dict[str, Any] = {}
    try:
        description = read_description(root / DATASET)
        yield from _description(lock, description, sound)
    except DatasetError as error:
        yield Finding(DATASET, _bare(error))
    yield from (Finding(*fault) for fault in split_faults(lock, description, _records(sound)))
    if unread:
        yield Finding(MANIFEST, unread)
    yield from _sums(root, files, sound, description, None if unread else manifest)
    yield from _clips(root, sound)
    yield from _index(root, sound)


def _lock(lock: Mapping[str, Any], checks: Sequence[ClipCheck]) -> Iterator[Finding]:
    """The lock must be true to itself, and every clip made by software it names."""
    if recipe_id(lock["recipe"], lock.get("scene_semantics", 0)) != lock["recipe_id"]:
        yield Finding(LOCK, "recipe_id is not that of the recipe in it")
    known = {fingerprint_id(print_) for print_ in [lock["fingerprint"], *lock["mixed_with"]]}
    for check in checks:
        if check.fingerprint not in known:
            yield Finding(check.receipt, f"made by software ({check.fingerprint}) that {LOCK} does not name")


def _leaks(checks: Sequence[ClipCheck]) -> Iterator[Finding]:
    splits: dict[tuple[str, int], str] = {}
    names: dict[str, str] = {}
    ordinals: dict[int, str] = {}
    for check in checks:
        job = check.job
        assert job is not None
        if splits.setdefault((job.map, job.world), job.split) != job.split:
            yield Finding(check.receipt, f"world {job.map}-{job.world:05d} is in two splits")
        if names.setdefault(job.name, check.receipt) != check.receipt:
            yield Finding(check.receipt, f"clip {job.name} is there twice")
        if ordinals.setdefault(job.ordinal, check.receipt) != check.receipt:
            yield Finding(check.receipt, f"has the place in the plan of {ordinals[job.ordinal]}")


def _records(checks: Sequence[ClipCheck]) -> Iterator[ClipRecord]:
    return (check.clip for check in checks if check.clip is not None)


def _manifest(root: Path) -> tuple[dict[str, str], str]:
    """The manifest, or nothing and why."""
    try:
        return read_manifest(root / MANIFEST), ""
    except DatasetError as error:
        return {}, _bare(error)


def _sums(
    root: Path,
    files: set[str],
    checks: Sequence[ClipCheck],
    description: Mapping[str, Any],
    manifest: Mapping[str, str] | None,
) -> Iterator[Finding]:
    """Compare files and manifest; what proves itself (receipts, description) tells which of the two is wrong."""
    listed = manifest or {}
    largest = max(_MAX_BYTES, sum(c.frames for c in checks) * ROW.itemsize + 4096)
    proven = _proven(root, checks, description)
    for path in sorted(proven.keys() | listed.keys()):
        expected = proven.get(path, listed.get(path))
        if path not in files:
            yield Finding(path, "missing")
        elif not path.startswith("shards/"):
            yield from _sum(root, path, expected, largest)
        if manifest is not None and listed.get(path) != expected:
            yield Finding(MANIFEST, f"{'disagrees on' if path in listed else 'does not list'} {path}")


def _sum(root: Path, path: str, expected: str | None, largest: int) -> Iterator[Finding]:
    try:
        if sha256_inside(root, path, largest) != expected:
            yield Finding(path, "SHA-256 differs from what was written")
    except DatasetError as error:
        yield Finding(path, str(error).removeprefix(f"{path}: "))


def _proven(root: Path, checks: Sequence[ClipCheck], description: Mapping[str, Any]) -> dict[str, str]:
    """SHA-256 by path, from files that carry their own checksum."""
    sums = dict(description.get("sums", {}))
    if description:
        sums[DATASET] = sha256_inside(root, DATASET)
    for check in checks:
        assert check.job is not None
        sums |= {check.job.shard: check.sha256, check.receipt: sha256_inside(root, check.receipt)}
    return sums


def _description(
    lock: Mapping[str, Any], told: Mapping[str, Any], checks: Sequence[ClipCheck]
) -> Iterator[Finding]:
    jobs = [c.job for c in checks if c.job is not None]
    facts: dict[str, Any] = {
        "content_id": content_id(c.digest for c in checks),
        "recipe_id": lock["recipe_id"],
        "counts": {
            "pairs": sum(j.pairs for j in jobs),
            "frames": sum(j.frames for j in jobs),
            "clips": len(jobs),
            "worlds": len({(j.map, j.world) for j in jobs}),
            "shard_bytes": sum(c.size for c in checks),
        },
    }
    for name, value in facts.items():
        if told.get(name) != value:
            yield Finding(DATASET, f"{name} is {_short(told.get(name))}, the receipts give {_short(value)}")
    for name in _strings(told.get("missing")):
        yield Finding(DATASET, f"clip {name} of the plan was not made; run the same render command again")


def _clips(root: Path, checks: Sequence[ClipCheck]) -> Iterator[Finding]:
    try:
        told = io.BytesIO(read_bounded(root / CLIPS, _MAX_CLIPS_BYTES))
    except DatasetError as error:
        yield Finding(CLIPS, _bare(error))
        return
    have = {c.line for c in checks}
    number = strange = 0
    for number, line in enumerate(told, 1):  # line by line: a list of them could be far larger than the file
        if line.removesuffix(b"\n") in have:
            continue
        strange += 1
        if strange > _MOST_LINES:
            yield Finding(CLIPS, f"more than {_MOST_LINES} lines agree with no receipt")
            return
        yield Finding(CLIPS, f"line {number} agrees with no receipt")
    if number != len(checks):
        yield Finding(CLIPS, f"{number} clips, there are {len(checks)} sound receipts")


def _index(root: Path, checks: Sequence[ClipCheck]) -> Iterator[Finding]:
    total = sum(c.frames for c in checks)
    try:
        rows = open_index(root / INDEX, total)
    except DatasetError as error:
        yield Finding(INDEX, _bare(error))
        return
    at = 0
    for check in checks:
        told = rows[at : at + check.frames].tobytes()
        if told != check.rows:
            assert check.job is not None
            size = ROW.itemsize
            keys = (
                k for k in range(check.frames) if told[k * size :][:size] != check.rows[k * size :][:size]
            )
            first = next(keys)
            more = f" and {count} more" if (count := sum(1 for _ in keys)) else ""
            yield Finding(
                INDEX, f"row {at + first} ({check.job.key(first)}){more} differs from {check.receipt}"
            )
        at += check.frames
    assert at * ROW.itemsize == sum(len(c.rows) for c in checks)


def _strings(value: Any) -> list[str]:
    return [str(v) for v in value] if isinstance(value, list) else []


def _bare(error: DatasetError) -> str:
    """Drop the absolute path in front of a reason; the finding names the file."""
    return str(error).partition(": ")[2] or str(error)


def _short(value: Any) -> str:
    return repr(value) if not isinstance(value, Mapping) else ", ".join(f"{k} {v}" for k, v in value.items())
