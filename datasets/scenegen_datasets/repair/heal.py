"""Small files that nothing else can be derived into: find the one bit that was flipped.

``recipe.yaml``, ``recipe.lock.json`` and ``releases.json`` say what people decided; no other file repeats it. But
``dataset.json`` and the manifest hold their SHA-256, and a file of some kilobytes has so few neighbours at a distance
of one bit that all can be tried. A match of 256 bits is proof.
"""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import DatasetError
from scenegen_datasets.description import read_description
from scenegen_datasets.inside import read_inside, sha256_inside
from scenegen_datasets.manifest import read_manifest
from scenegen_datasets.store import DATASET, LOCK, MANIFEST, RECIPE, RELEASES
from scenegen_datasets.versions.merge import merged_yaml

IRREPLACEABLE = (LOCK, RECIPE, RELEASES)

_MAX_BYTES = 1 << 16
"""Beyond this the search takes longer than ten seconds: it grows with the square of the size."""


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
    """Flip damaged bits of irreplaceable files back, one a file at most; returns the files that were healed."""
    healed = []
    sums = recorded_sums(root)
    for name in IRREPLACEABLE:
        try:
            data = read_inside(root, name, _MAX_BYTES)
        except DatasetError:
            continue
        if name not in sums or hashlib.sha256(data).hexdigest() == sums[name]:
            continue
        sound = unflipped(data, sums[name])
        if sound is not None:
            write_atomic(root / name, sound)
            healed.append(name)
    return tuple(healed)


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
