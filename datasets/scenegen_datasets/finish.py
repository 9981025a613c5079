"""From receipts to a finished dataset: index, clip list, manifest, card, and ``dataset.json`` last."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from scenegen.foundation import canonical
from scenegen.foundation.atomic import remove, write_atomic
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.card import card
from scenegen_datasets.clip import ClipRecord
from scenegen_datasets.content import clip_digest, content_id
from scenegen_datasets.croissant import croissant
from scenegen_datasets.description import describe, sealed_description
from scenegen_datasets.index import Rows, rows_of, write_index
from scenegen_datasets.info import DatasetInfo, info
from scenegen_datasets.inside import sha256_inside, walk
from scenegen_datasets.job import ClipJob
from scenegen_datasets.manifest import file_sha256, listable, manifest_bytes
from scenegen_datasets.receipt import Receipt, read_receipt
from scenegen_datasets.store import (
    CARD,
    CLIPS,
    CROISSANT,
    DATASET,
    INDEX,
    LOCK,
    MANIFEST,
    RECIPE,
    RELEASES,
    clean,
    finished,
    read_lock,
)
from scenegen_datasets.versions.history import read_history, version_of
from scenegen_datasets.versions.state import ClipMark, State

PREVIEW = "preview"


class _Tally:
    """Receipts pass through once; what is needed of each is kept, its frames are not."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self.records: list[ClipRecord] = []
        self.marks: dict[str, ClipMark] = {}
        self.digests: list[str] = []
        self.lines: list[bytes] = []
        self.sums: dict[str, str] = {}
        self.layers: tuple[str, ...] = ()
        self.shard_bytes = 0

    def rows(self, jobs: Sequence[ClipJob]) -> Iterator[Rows]:
        for job in jobs:
            receipt = read_receipt(self._root, job.receipt)
            if receipt.clip.job != job:
                raise DatasetError(f"{job.receipt}: made for {receipt.clip.job}, the plan says {job}")
            if self.layers not in ((), receipt.layers):
                raise DatasetError(f"{job.receipt}: holds other layers than the clips before it")
            self._keep(receipt)
            yield rows_of(receipt)

    def _keep(self, receipt: Receipt) -> None:
        job = receipt.clip.job
        digest = clip_digest(receipt)
        self.layers = receipt.layers
        self.records.append(receipt.clip)
        self.marks[job.name] = ClipMark.of(receipt)
        self.digests.append(digest)
        self.shard_bytes += receipt.size
        self.sums[job.shard] = receipt.sha256
        self.sums[job.receipt] = file_sha256(self._root / job.receipt)
        self.lines.append(canonical.canonical(clip_line(receipt, digest)))


def clip_line(receipt: Receipt, digest: str) -> dict[str, object]:
    """One line of ``clips.jsonl``."""
    return {
        **receipt.clip.to_dict(),
        "shard": {"path": receipt.clip.job.shard, "sha256": receipt.sha256, "size": receipt.size},
        "fingerprint": receipt.fingerprint,
        "content": digest,
        "statistics": dict(receipt.statistics),
    }


def finish(root: Path, jobs: Sequence[ClipJob]) -> DatasetInfo:
    """Write everything that is derived from the receipts. Idempotent; the same bytes whoever made the clips.

    Call it with the `DirectoryLock` held and no worker running.

    Parameters
    ----------
    root : Path
        Dataset with a lock (`create_or_open`) and receipts. Files under ``preview/`` are taken into the manifest.
    jobs : sequence of ClipJob
        The plan. Clips without a receipt (quarantined) are named in ``dataset.json`` as missing.

    Raises
    ------
    InputError
        If no clip at all was made.
    DatasetError
        If a receipt contradicts the plan or the other clips, or the history of releases is damaged.
    """
    done = finished(root)
    made = [job for job in sorted(jobs) if job.name in done]
    missing = [job.name for job in sorted(jobs) if job.name not in done]
    if not made:
        raise InputError(f"{root} holds no finished clip yet; run the same render command again")
    return derive(root, made, missing)


def derive(root: Path, made: Sequence[ClipJob], missing: Sequence[str]) -> DatasetInfo:
    """Write what follows from the receipts of the clips in `made`, in this order; `missing` are named as such.

    The version follows as well: from the history of releases, and what changed since the last. Call it as `finish`.
    """
    lock, history = read_lock(root), read_history(root)
    clean(root)
    remove(root / DATASET)
    tally = _Tally(root)
    write_index(root / INDEX, tally.rows(made), sum(job.frames for job in made))
    write_atomic(root / CLIPS, b"".join(line + b"\n" for line in tally.lines))
    description = describe(
        lock,
        tally.records,
        tally.layers,
        version="",
        content_id=content_id(tally.digests),
        missing=missing,
        shard_bytes=tally.shard_bytes,
    )
    description["version"] = version_of(history, State.of(lock, description, tally.marks))
    write_atomic(root / CARD, card(description))
    write_atomic(root / CROISSANT, canonical.pretty(croissant(description, tally.sums)))
    names = (RECIPE, LOCK, CLIPS, INDEX, CARD, CROISSANT, *((RELEASES,) if history else ()))
    derived = {name: file_sha256(root / name) for name in names}
    last = sealed_description(description, derived)
    sums = tally.sums | derived | {DATASET: hashlib.sha256(last).hexdigest()} | _preview_sums(root)
    write_atomic(root / MANIFEST, manifest_bytes(sums))
    write_atomic(root / DATASET, last)
    return info(root)


def _preview_sums(root: Path) -> dict[str, str]:
    if not (root / PREVIEW).is_dir() or (root / PREVIEW).is_symlink():
        return {}
    files = [e.path for e in walk(root, PREVIEW) if e.kind == "file" and listable(e.path)]
    alone = {
        path.casefold(): path for path in reversed(files)
    }  # of names that are one file elsewhere, the first
    return {path: sha256_inside(root, path) for path in sorted(alone.values())}
