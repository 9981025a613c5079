"""What of a dataset is sound, what is not, and what the broken parts must come out as."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.printable import printable
from scenegen_datasets.job import ClipJob
from scenegen_datasets.manifest import read_manifest
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.store import CARD, CLIPS, CROISSANT, DATASET, INDEX, MANIFEST
from scenegen_datasets.verify import ClipCheck

DERIVED = (CLIPS, INDEX, CARD, CROISSANT, MANIFEST, DATASET)

_RECEIPT = re.compile(r"receipts/(train|val|test)/([a-z][a-z0-9_]{0,23})-([0-9]{5})/([0-9]{3})\.json")


@dataclass(frozen=True)
class Survey:
    """A dataset, clip by clip.

    Attributes
    ----------
    planned : tuple of ClipJob
        All clips there should be, in plan order.
    broken : tuple of ClipJob
        Those that are missing or not what they were.
    expected : mapping of str to str
        Path of a broken clip's shard to the SHA-256 it had, where a sound receipt or the manifest tells.
    made_by : mapping of str to str
        Name of a broken clip to the id of the software that made it, where its receipt tells.
    derived : tuple of str
        Names of the files that follow from the receipts.
    """

    planned: tuple[ClipJob, ...]
    broken: tuple[ClipJob, ...]
    expected: Mapping[str, str]
    made_by: Mapping[str, str]
    derived: tuple[str, ...] = field(default=DERIVED)


def survey(root: Path, lock: Mapping[str, Any], checks: Sequence[ClipCheck]) -> Survey:
    """Sort the clips of a dataset into sound and broken.

    Parameters
    ----------
    root : Path
    lock : mapping
        Sound.
    checks : sequence of ClipCheck
        Of every receipt, fully decoded.

    Raises
    ------
    InputError
        If clips are broken or missing and the plan cannot be told, because its recipe is of another version.
    """
    manifest = _manifest(root)
    sound = {c.job: c for c in checks if c.job is not None and not c.findings}
    sound = {job: c for job, c in sound.items() if manifest.get(job.shard, c.sha256) == c.sha256}
    planned = _planned(root, lock, sound, checks, manifest)
    broken = tuple(job for job in planned if job not in sound)
    expected, made_by = {}, {}
    for job in broken:
        if job.shard in manifest:
            expected[job.shard] = manifest[job.shard]
        try:
            receipt = read_receipt(root, job.receipt)
        except DatasetError:
            continue
        made_by[job.name] = receipt.fingerprint
        expected.setdefault(job.shard, receipt.sha256)
    return Survey(planned, broken, expected, made_by)


def _planned(
    root: Path,
    lock: Mapping[str, Any],
    sound: Mapping[ClipJob, ClipCheck],
    checks: Sequence[ClipCheck],
    manifest: Mapping[str, str],
) -> tuple[ClipJob, ...]:
    """The plan; what is there, where nothing is broken and only the rest is to be derived."""
    from scenegen_datasets.repair.again import planned

    try:
        return planned(root, lock)
    except InputError as error:
        gone = sorted(p for p in manifest if _RECEIPT.fullmatch(p) and p not in {j.receipt for j in sound})
        bad = gone or sorted(c.receipt for c in checks if c.job not in sound)
        if bad:
            raise InputError(
                f"{printable(bad[0])} is broken or missing, and cannot be made again: {error}"
            ) from None
        return tuple(sorted(sound))


def _manifest(root: Path) -> dict[str, str]:
    try:
        return read_manifest(root / MANIFEST)
    except DatasetError:
        return {}
