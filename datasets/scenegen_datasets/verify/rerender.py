"""Render random frames of a dataset again, from its lock alone, and compare them with what is stored."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.rng import stream
from scenegen_datasets.index import rows_of
from scenegen_datasets.layers import layers_by_member
from scenegen_datasets.lock import fingerprint_id
from scenegen_datasets.reader import ShardReader
from scenegen_datasets.receipt import Receipt, read_receipt, receipt_paths
from scenegen_datasets.run import Progress
from scenegen_datasets.store import read_lock
from scenegen_datasets.verify.bound import beyond_bound
from scenegen_datasets.verify.report import Finding


@dataclass(frozen=True)
class Rerendered:
    """What came of it.

    Attributes
    ----------
    findings : tuple of Finding
    frames : tuple of str
        Keys of the frames that were compared.
    identical : int
        How many of them came out with equal arrays.
    same_software : bool
        Whether everything that decides bytes is what made the dataset; then nothing but equality is accepted, of
        arrays and of stored bytes.
    """

    findings: tuple[Finding, ...]
    frames: tuple[str, ...]
    identical: int
    same_software: bool


def rerender(
    root: Path,
    count: int,
    processes: int,
    seed: int = 0,
    told: Callable[[Progress], None] = lambda _: None,
    own_files: Sequence[Path] = (),
) -> Rerendered:
    """Render `count` frames again and compare; their clips are made whole, for a frame's noise depends on those before.

    Parameters
    ----------
    root : Path
        Dataset, finished or growing; nothing is written into it.
    count : int
        Frames, drawn without repetition.
    processes : int
        Workers.
    seed : int
        Of the draw.
    told : callable
        Hears of progress.
    own_files : sequence of Path
        Scenes and recordings of the user's, where they do not lie any more as ``recipe.yaml`` says.

    Raises
    ------
    InputError
        If there is no frame, this scenegen would make other samples of the recipe, or files of the user are needed
        that cannot be found.
    """
    from scenegen_datasets.repair.again import Again
    from scenegen_datasets.repair.remake import fingerprint_here

    lock = read_lock(root)
    receipts = [read_receipt(root, path) for path in receipt_paths(root)]
    chosen = _draw(receipts, count, seed)
    if not chosen:
        raise InputError(f"{root} holds no frame to render again")
    here = fingerprint_id(fingerprint_here())
    findings: list[Finding] = []
    identical = 0
    with tempfile.TemporaryDirectory(prefix="scenegen-rerender-") as folder:
        scratch = Path(folder)
        again = Again(root, processes, here, scratch, told, tuple(own_files))
        failed = again.make(lock, [r.clip.job for r, _ in chosen], scratch)
        for old, frames in chosen:
            name = old.clip.job.name
            if name in failed:
                findings.append(Finding(old.clip.job.shard, f"could not be rendered again: {failed[name]}"))
                continue
            new = read_receipt(scratch, old.clip.job.receipt)
            identical += sum(old.frames[k].digests == new.frames[k].digests for k in frames)
            findings += _compared(root, scratch, old, new, frames)
    made_by = {r.fingerprint for r, _ in chosen}
    keys = tuple(r.frames[k].key for r, frames in chosen for k in frames)
    return Rerendered(tuple(sorted(findings)), keys, identical, made_by == {here})


def _draw(receipts: list[Receipt], count: int, seed: int) -> list[tuple[Receipt, list[int]]]:
    """Frames by clip, both in order."""
    ends = np.cumsum([len(r.frames) for r in receipts], dtype=np.int64)
    total = int(ends[-1]) if len(ends) else 0
    drawn: NDArray[np.int64] = np.sort(stream(seed, "rerender").permutation(total)[:count])
    found: dict[int, list[int]] = {}
    for at in drawn:
        clip = int(np.searchsorted(ends, at, side="right"))
        found.setdefault(clip, []).append(int(at - ends[clip]) + len(receipts[clip].frames))
    return [(receipts[clip], frames) for clip, frames in found.items()]


def _compared(root: Path, scratch: Path, old: Receipt, new: Receipt, frames: list[int]) -> Iterator[Finding]:
    shard = old.clip.job.shard
    strict = old.fingerprint == new.fingerprint
    if strict and old.sha256 != new.sha256:
        yield Finding(shard, "rendered again by the same software, its bytes differ")
    for k in frames:
        if old.frames[k].digests == new.frames[k].digests:
            continue
        where = f"{shard}: {old.frames[k].key}"
        if strict:
            names = [n for n, sum_ in old.frames[k].digests.items() if new.frames[k].digests.get(n) != sum_]
            yield Finding(where, f"rendered again by the same software, {', '.join(names)} differs")
            continue
        try:
            told, again = _arrays(root, old, k), _arrays(scratch, new, k)
        except DatasetError as error:
            yield Finding(where, f"cannot be compared: {error}")
            continue
        for name in told:
            wrong = beyond_bound(name, told[name], again[name]) if name in again else f"{name} is missing"
            if wrong:
                yield Finding(where, f"rendered again by other software, {wrong}")


def _arrays(root: Path, receipt: Receipt, frame: int) -> dict[str, NDArray[Any]]:
    reader = ShardReader(root)
    try:
        return reader.frame(rows_of(receipt)[frame], receipt.clip.job, layers_by_member(receipt.layers))
    finally:
        reader.close()
