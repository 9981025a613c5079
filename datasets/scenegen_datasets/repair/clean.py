"""Remove from a dataset what is no part of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.inside import walk
from scenegen_datasets.manifest import read_manifest
from scenegen_datasets.receipt import read_receipt, receipt_paths, shard_of
from scenegen_datasets.repair.remove import remove_inside
from scenegen_datasets.store import DATASET, FOLDERS, MANIFEST, check_output, read_lock
from scenegen_datasets.verify.strays import SCRATCH, Stray, find_strays


@dataclass(frozen=True)
class Cleaned:
    """What a cleaning came to.

    Attributes
    ----------
    strays : tuple of Stray
        What does not belong, sorted by path.
    removed : bool
        Whether it is gone.
    """

    strays: tuple[Stray, ...]
    removed: bool


def clean(
    root: Path, *, dry_run: bool = False, told: Callable[[tuple[Stray, ...]], None] = lambda _: None
) -> Cleaned:
    """Remove leftovers of killed writers, strange files and folders, links, pipes; nothing outside the directory.

    What is hidden at the top of the directory stays (version control, hubs), and so do pictures below ``preview/``.

    Parameters
    ----------
    root : Path
    dry_run : bool
        Only look.
    told : callable
        Hears of what is about to be removed, while nobody else writes.

    Raises
    ------
    InputError
        If there is no dataset, or somebody writes to it.
    DatasetError
        If its lock or, in a finished one, its manifest is damaged: then nobody knows what belongs.
    """
    if dry_run:
        return Cleaned(strays_of(root), removed=False)
    read_lock(root)
    _refuse_links(root)
    with DirectoryLock(root):
        strays = strays_of(root)
        told(strays)
        for stray in strays:
            remove_inside(root, stray.path)
    return Cleaned(strays, removed=True)


def strays_of(root: Path) -> tuple[Stray, ...]:
    """What `clean` removes; folders in which nothing belongs are named once, not file by file."""
    read_lock(root)
    _refuse_links(root)
    belongs = _belongs(root)
    _, strays = find_strays(root, belongs)
    folders = _empty_of(root, belongs)
    kept = [stray for stray in strays if not any(stray.path.startswith(f"{f.path}/") for f in folders)]
    scratch = [Stray(SCRATCH, "left behind by a killed repair")] if (root / SCRATCH).is_dir() else []
    known = {f.path for f in folders}
    return tuple(sorted([*(s for s in kept if s.path not in known), *folders, *scratch]))


def _refuse_links(root: Path) -> None:
    if root.is_symlink():
        check_output(root)


def _belongs(root: Path) -> set[str]:
    """Files of clips: those of the manifest and those with a receipt, sound or not: broken ones are for `repair`."""
    receipts = receipt_paths(root)
    if (root / DATASET).exists():
        listed = read_manifest(root / MANIFEST)
        planned = _planned(root)
        mine = receipts if planned is None else [path for path in receipts if path in planned]
        return {*listed, *mine, *map(shard_of, mine)}
    sound = {path for path in receipts if _is_sound(root, path)}
    return {*receipts, *map(shard_of, sound)}


def _planned(root: Path) -> set[str] | None:
    """Receipts of the plan, if it can be told: a manifest with a flipped bit must not cost a sound one."""
    from scenegen_datasets.repair.again import planned

    try:
        return {clip.receipt for clip in planned(root, read_lock(root))}
    except InputError:
        return None


def _is_sound(root: Path, path: str) -> bool:
    try:
        read_receipt(root, path)
    except DatasetError:
        return False
    return True


def _empty_of(root: Path, belongs: Iterable[str]) -> list[Stray]:
    """The outermost folders that hold nothing of the dataset."""
    needed = set(FOLDERS)
    for path in belongs:
        while "/" in path:
            path = path.rpartition("/")[0]
            needed.add(path)
    found: list[Stray] = []
    for entry in walk(root):
        inside = entry.path.startswith((".", f"{FOLDERS[2]}/"))
        if entry.kind != "folder" or inside or entry.path in needed:
            continue
        if not any(entry.path.startswith(f"{f.path}/") for f in found):
            found.append(Stray(entry.path, "a folder with nothing of the dataset in it"))
    return found
