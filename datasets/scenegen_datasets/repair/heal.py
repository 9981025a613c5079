"""Small files that cannot be derived from clips: put them right if what they held can be proven.

``recipe.yaml``, ``recipe.lock.json`` and ``releases.json`` say what people decided. ``dataset.json`` and the manifest
hold their SHA-256, and a match of 256 bits is proof. A file of some kilobytes has so few neighbours at a distance of
one bit that all can be tried; and every run wrote down the lock it went by.
"""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.canonical import parse, pretty
from scenegen.foundation.errors import DatasetError
from scenegen_datasets.description import read_description
from scenegen_datasets.inside import read_inside, sha256_inside
from scenegen_datasets.manifest import read_manifest
from scenegen_datasets.run_log import OF_THE_RUN, START
from scenegen_datasets.store import DATASET, LOCK, MANIFEST, RECIPE, RELEASES, RUN_LOG
from scenegen_datasets.versions.merge import merged_yaml

IRREPLACEABLE = (LOCK, RECIPE, RELEASES)

_MAX_BYTES = 1 << 16
"""Beyond this the search takes longer than ten seconds: it grows with the square of the size."""

_MAX_LOG_BYTES = 1 << 26
"""A million pairs leave a log of about 10 MB."""


def refuse_lost_history(root: Path) -> None:
    """Stop where the releases of a dataset are gone or damaged: without them its version would begin anew.

    Raises
    ------
    DatasetError
    """
    told = recorded_sums(root).get(RELEASES)
    if told is None:
        return
    try:
        sound = sha256_inside(root, RELEASES) == told
    except DatasetError:
        sound = False
    if not sound:
        raise DatasetError(
            f"{root / RELEASES}: lost or damaged in more than one bit, and nothing else tells the releases of this "
            "dataset; restore it from a copy"
        )


def rewrite_recipe(root: Path, lock: Mapping[str, Any]) -> bool:
    """Where ``recipe.yaml`` is lost, write the resolved recipe in its place; returns whether that was needed."""
    told = recorded_sums(root).get(RECIPE)
    with contextlib.suppress(DatasetError):
        if sha256_inside(root, RECIPE) == told or told is None:
            return False
    if lock.get("parts"):  # of a merged dataset it follows from the lock: nothing is lost
        write_atomic(root / RECIPE, merged_yaml(lock))
        return False
    plain = yaml.safe_dump(dict(lock["recipe"]), sort_keys=True, allow_unicode=True)
    write_atomic(
        root / RECIPE, f"# What was asked is lost; this is the recipe with every default.\n{plain}".encode()
    )
    return True


def heal(root: Path) -> tuple[str, ...]:
    """Put irreplaceable files right: one flipped bit each, the lock whatever befell it; returns those that were."""
    healed = []
    sums = recorded_sums(root)
    for name in IRREPLACEABLE:
        if name not in sums or (root / name).is_symlink():
            continue
        data = None
        with contextlib.suppress(DatasetError):
            data = read_inside(root, name, _MAX_BYTES)
        if data is not None and hashlib.sha256(data).hexdigest() == sums[name]:
            continue
        sound = logged_lock(root, sums[name]) if name == LOCK else None
        if sound is None and data is not None:
            sound = unflipped(data, sums[name])
        if sound is not None:
            write_atomic(root / name, sound)
            healed.append(name)
    return tuple(healed)


def logged_lock(root: Path, sha256: str) -> bytes | None:
    """The lock with this SHA-256 out of the log of the runs that made the dataset, if it is there.

    Merged and sensed datasets have no such log. One that grew with other software has a lock that no single run knew.
    """
    try:
        lines = read_inside(root, RUN_LOG, _MAX_LOG_BYTES).splitlines()
    except DatasetError:
        return None
    for line in reversed(lines):
        with contextlib.suppress(DatasetError, ValueError):  # half a line, or one that somebody else wrote
            said = parse(line, RUN_LOG, max_bytes=_MAX_BYTES)
            if isinstance(said, dict) and said.get("event") == START:
                lock = pretty({key: value for key, value in said.items() if key not in OF_THE_RUN})
                if hashlib.sha256(lock).hexdigest() == sha256:
                    return lock
    return None


def recorded_sums(root: Path) -> dict[str, str]:
    """SHA-256 of files as ``dataset.json`` tells them, whose seal proves it, or else the manifest."""
    sums: dict[str, str] = {}
    with contextlib.suppress(DatasetError):
        sums |= read_manifest(root / MANIFEST)
    with contextlib.suppress(DatasetError):
        sums |= read_description(root / DATASET)["sums"]
    return sums


def unflipped(data: bytes, sha256: str) -> bytes | None:
    """The content with this SHA-256 that differs from `data` in one bit, if there is one."""
    wanted = bytes.fromhex(sha256)
    before = hashlib.sha256()
    for at in range(len(data)):
        rest = data[at + 1 :]
        for bit in range(8):
            attempt = before.copy()
            flipped = bytes((data[at] ^ (1 << bit),))
            attempt.update(flipped + rest)
            if attempt.digest() == wanted:
                return data[:at] + flipped + rest
        before.update(data[at : at + 1])
    return None
