"""Put a damaged dataset right: small files by their sums, clips by rendering them again, the rest by deriving it."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import make_directories, sync_directory
from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.words import counted
from scenegen_datasets.finish import derive
from scenegen_datasets.inside import sha256_inside
from scenegen_datasets.job import ClipJob
from scenegen_datasets.lock import SOURCE, fingerprint_id
from scenegen_datasets.pictures.preview import FLIGHT, SHEET, write_preview
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.repair.heal import heal, recorded_sums, refuse_lost_history, rewrite_recipe
from scenegen_datasets.repair.remove import remove_inside
from scenegen_datasets.repair.survey import Survey, survey
from scenegen_datasets.run import Progress
from scenegen_datasets.store import DATASET, LOCK, MANIFEST, check_output, differing_keys, read_lock
from scenegen_datasets.verify import VerifyReport, examine
from scenegen_datasets.verify.strays import SCRATCH

Told = Callable[[Progress], None]
Verified = Callable[[int, int], None]


@dataclass(frozen=True)
class Repaired:
    """What a repair came to.

    Attributes
    ----------
    before, after : VerifyReport
        What was wrong, and what still is.
    healed : tuple of str
        Files in which one bit was flipped back.
    rewritten : bool
        Whether ``recipe.yaml`` was lost, and holds the resolved recipe now instead of what was asked.
    remade : tuple of str
        Clips that were rendered again and took their places.
    failed : tuple of (str, str)
        Clips that could not be made, or came out differently, and why; they were left as they were.
    shared : tuple of str
        Of the remade ones, those whose broken shard has other names still: other datasets are merged of it.
    """

    before: VerifyReport
    after: VerifyReport
    healed: tuple[str, ...]
    rewritten: bool
    remade: tuple[str, ...]
    failed: tuple[tuple[str, str], ...]
    shared: tuple[str, ...] = ()


def repair(
    root: Path,
    processes: int,
    told: Told = lambda _: None,
    verified: Verified | None = None,
    own_files: Sequence[Path] = (),
) -> Repaired:
    """Make a dataset what it was, byte for byte; what is sound is not touched. May be killed and run again.

    Parameters
    ----------
    root : Path
    processes : int
        Workers that verify and render.
    told : callable
        Hears of rendering.
    verified : callable, optional
        Hears of verification: (clips done, clips in all).
    own_files : sequence of Path
        Scenes and recordings of the user's, where they do not lie any more as ``recipe.yaml`` says.

    Raises
    ------
    InputError
        If there is no dataset, somebody writes to it, this machine would render other bytes (with what differs), or
        files of the user are needed that cannot be found.
    DatasetError
        If the lock itself is damaged, from which everything else follows.
    """
    check_output(root)
    with DirectoryLock(root):
        healed = heal(root)
        lock = _sound_lock(root)
        before, checks = examine(root, processes, progress=verified)
        if before.ok:
            return Repaired(before, before, healed, False, (), ())
        refuse_lost_history(root)
        found = survey(root, lock, checks)
        _refuse_growing(root, lock, found)
        rewritten = rewrite_recipe(root, lock)
        linked = {clip.name for clip in found.broken if _has_other_names(root / clip.shard)}
        remade, failed = (
            _remake(root, lock, found, processes, told, tuple(own_files)) if found.broken else ([], {})
        )
        _derive(root, found, failed, before)
        after = examine(root, processes, progress=verified)[0]
    shared = tuple(name for name in remade if name in linked)
    return Repaired(before, after, healed, rewritten, tuple(remade), tuple(sorted(failed.items())), shared)


def _sound_lock(root: Path) -> dict[str, Any]:
    """The lock, if it is what ``dataset.json`` or the manifest say it is."""
    remedy = "nothing can be rendered from it; restore it from a copy, or render again into another --out"
    try:
        lock = read_lock(root)
    except DatasetError as error:
        raise DatasetError(f"{error}; {remedy}") from None
    told = recorded_sums(root).get(LOCK)
    if told is not None and sha256_inside(root, LOCK) != told:
        raise DatasetError(f"{root / LOCK}: changed or damaged in more than one bit; {remedy}")
    return lock


def _refuse_growing(root: Path, lock: Mapping[str, Any], found: Survey) -> None:
    if found.broken and not (root / DATASET).exists() and not (root / MANIFEST).exists():
        maker = "merge" if lock.get("parts") else "sense" if SOURCE in lock else "render"
        raise InputError(
            f"{root} is not finished: {counted(len(found.broken), 'clip')} missing or broken; the same {maker} command "
            "goes on with it"
        )


def _remake(
    root: Path,
    lock: Mapping[str, Any],
    found: Survey,
    processes: int,
    told: Told,
    own_files: tuple[Path, ...],
) -> tuple[list[str], dict[str, str]]:
    """Render the broken clips beside the dataset, and let those that came out right take their places."""
    from scenegen_datasets.repair.again import Again
    from scenegen_datasets.repair.remake import fingerprint_here

    here = fingerprint_here()
    _refuse_other_software(root, lock, found, here)
    remove_inside(root, SCRATCH)
    scratch = make_directories(root, SCRATCH)
    try:
        again = Again(root, processes, fingerprint_id(here), root, told, own_files)
        failed = again.make(lock, found.broken, scratch)
        remade = []
        for clip in found.broken:
            if clip.name in failed:
                continue
            reason = _take_place(root, scratch, clip, found.expected.get(clip.shard))
            if reason:
                failed[clip.name] = reason
            else:
                remade.append(clip.name)
    finally:
        remove_inside(root, SCRATCH)
    return remade, failed


def _refuse_other_software(
    root: Path, lock: Mapping[str, Any], found: Survey, here: Mapping[str, str]
) -> None:
    """Bytes are promised for one fingerprint only: that with which the clips were made."""
    prints = {fingerprint_id(p): p for p in (lock["fingerprint"], *lock["mixed_with"])}
    wanted = {found.made_by.get(clip.name, fingerprint_id(lock["fingerprint"])) for clip in found.broken}
    for name in sorted(wanted - {fingerprint_id(here)}):
        what = "; ".join(list(differing_keys(prints.get(name, {}), dict(here)))[:6])
        made = "parts" in lock or SOURCE in lock
        otherwise = (
            "make it again from the datasets it was made of"
            if made
            else f"remove {found.broken[0].receipt} and its like, and run the same render command with --allow-mixed"
        )
        raise InputError(
            f"{root}: the broken clips were rendered by other software ({what}); repair it where that is installed, or "
            f"{otherwise}"
        )


def _take_place(root: Path, scratch: Path, clip: ClipJob, expected: str | None) -> str:
    """Move a clip that was made again over the broken one; returns why not, or ""."""
    made = read_receipt(scratch, clip.receipt)
    if expected not in (None, made.sha256):
        return f"came out with SHA-256 {made.sha256[:16]}..., where {str(expected)[:16]}... was written; left as it was"
    for path in (clip.shard, clip.receipt):  # in the order of a first commit: the receipt is the proof
        _make_way(root, path)
        place = root / path
        (scratch / path).replace(place)
        sync_directory(place.parent)
    return ""


def _has_other_names(path: Path) -> bool:
    """Whether a plain file is a hard link, as `scenegen_datasets.versions.merge` makes them."""
    try:
        found = path.lstat()
    except OSError:
        return False
    return stat.S_ISREG(found.st_mode) and found.st_nlink > 1


def _make_way(root: Path, path: str) -> None:
    """Remove links and folders where a file or a folder of ours belongs, then make the folders."""
    *folders, _ = path.split("/")
    for depth in range(1, len(folders) + 1):
        step = root / "/".join(folders[:depth])
        if step.is_symlink() or (os.path.lexists(step) and not step.is_dir()):
            remove_inside(root, "/".join(folders[:depth]))
            break
    make_directories(root, "/".join(folders))
    if (root / path).is_dir() and not (root / path).is_symlink():
        remove_inside(root, path)


def _derive(root: Path, found: Survey, failed: Mapping[str, str], before: VerifyReport) -> None:
    """Write all that follows from the receipts again, and draw pictures that are gone or damaged."""
    made = [clip for clip in found.planned if _counts(root, clip)]
    if not made:
        raise DatasetError(
            f"{root}: no sound clip is left ({next(iter(failed.values()), 'nothing was made')})"
        )
    missing = [clip.name for clip in found.planned if clip not in made]
    for name in found.derived:
        if (root / name).is_dir() and not (root / name).is_symlink():
            remove_inside(root, name)
    derive(root, made, missing)
    touched = {finding.file for finding in before.findings}
    if touched & {SHEET, FLIGHT}:
        for picture in touched & {SHEET, FLIGHT}:
            remove_inside(root, picture)
        write_preview(root)
        derive(root, made, missing)


def _counts(root: Path, clip: ClipJob) -> bool:
    try:
        return read_receipt(root, clip.receipt).clip.job == clip and (root / clip.shard).is_file()
    except DatasetError:
        return False
