"""A dataset directory: made, opened again, grown."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.atomic import remove, remove_partials, write_atomic
from scenegen.foundation.errors import DatasetError, InputError, NoSpaceError
from scenegen_datasets import documents
from scenegen_datasets.inside import walk
from scenegen_datasets.licence import KEY
from scenegen_datasets.lock import SOURCE, stable
from scenegen_datasets.receipt import promised_size, receipt_paths, shard_of
from scenegen_datasets.seal import read_bounded
from scenegen_datasets.shape import misshapen

RECIPE, LOCK, DATASET, MANIFEST = "recipe.yaml", "recipe.lock.json", "dataset.json", "MANIFEST.sha256"
INDEX, CLIPS, CARD, CROISSANT = "index.npy", "clips.jsonl", "README.md", "croissant.json"
RELEASES = "releases.json"
RUN_LOG, WRITER_LOCK = "run.log.jsonl", ".lock"
FOLDERS = ("shards", "receipts", "preview")

_DERIVED = (DATASET, MANIFEST, INDEX, CLIPS, CARD, CROISSANT)
OURS = (RECIPE, LOCK, *_DERIVED, RELEASES, RUN_LOG, WRITER_LOCK, *FOLDERS)
"""Names directly below a dataset."""

_MAX_LOCK_BYTES = 16 << 20


def create_or_open(
    root: Path, recipe_yaml: str, lock: Mapping[str, Any], *, allow_mixed: bool = False
) -> None:
    """Make a new dataset directory or open one to resume or to grow it. Call it with the `DirectoryLock` held.

    Parameters
    ----------
    root : Path
        Must exist (the lock lives in it).
    recipe_yaml : str
        What was asked, as text.
    lock : mapping
        `scenegen_datasets.lock.make_lock`.
    allow_mixed : bool
        Accept another render fingerprint; the lock then names both.

    Raises
    ------
    InputError
        If `root` holds something that is not a dataset, or a dataset of another recipe (the differing keys are named
        with both values), of more pairs, or of another render fingerprint (unless `allow_mixed`); if it or one of
        our names in it is a symbolic link, or cannot be written.
    """
    check_output(root)
    if not (root / LOCK).exists():
        write_atomic(root / RECIPE, recipe_yaml.encode())
        write_atomic(root / LOCK, canonical.pretty(dict(lock)))
        return
    old = read_lock(root)
    _refuse_other_recipe(root, old, lock)
    new = _joined(root, old, lock, allow_mixed)
    if new != old:
        # From here until `finish` the dataset grows: what proved the smaller one goes first.
        remove(root / DATASET)
        remove(root / MANIFEST)
        write_atomic(root / RECIPE, recipe_yaml.encode())
        write_atomic(root / LOCK, canonical.pretty(new))


def check_output(root: Path, names: Collection[str] = OURS, lock: str = LOCK, kind: str = "dataset") -> None:
    """Refuse a directory that is not empty and not one of ours, and symbolic links under our names.

    Parameters
    ----------
    root : Path
        An existing path.
    names : collection of str
        What we write directly below it.
    lock : str
        The file by which one of ours is known.
    kind : str
        What it would be, for the messages.

    Raises
    ------
    InputError
        With what stands in the way.
    """
    if root.is_symlink():
        raise InputError(f"{root} is a symbolic link; give the directory itself: {os.path.realpath(root)}")
    if not root.is_dir():
        raise InputError(f"{root} is not a directory")
    links = [name for name in names if (root / name).is_symlink()]
    if links:
        raise InputError(f"{root / links[0]} is a symbolic link; a {kind} is written into real files only")
    strangers = sorted(p.name for p in root.iterdir() if p.name not in names and not p.name.startswith("."))
    if strangers and not (root / lock).exists():
        raise InputError(
            f"{root} is not empty and not a {kind} (it holds {strangers[0]}); choose another --out"
        )


def read_lock(root: Path) -> dict[str, Any]:
    """Read ``recipe.lock.json``.

    Raises
    ------
    InputError
        If there is no dataset at `root`.
    DatasetError
        If the lock is damaged.
    """
    if not (root / LOCK).exists():
        raise InputError(f"no dataset at {root} (it has no {LOCK})")
    value = canonical.parse(read_bounded(root / LOCK, _MAX_LOCK_BYTES), str(root / LOCK))
    wrong = misshapen(value, documents.LOCK) or misshapen(value.get("parts", []), documents.PARTS, "parts")
    if wrong:
        raise DatasetError(f"{root / LOCK}: not a recipe lock ({wrong})")
    held: dict[str, Any] = value
    return held


def finished(root: Path) -> set[str]:
    """Names of the clips whose receipt is sound and whose shard has the right size; the rest is to be done."""
    names = set()
    for path in receipt_paths(root):
        file = root / shard_of(path)
        try:
            size = promised_size(root, path)
        except DatasetError:
            continue
        if file.is_file() and not file.is_symlink() and file.stat().st_size == size:
            names.add(f"{file.parent.name}-{file.stem}")
    return names


def clean(root: Path) -> None:
    """Remove what killed writers left anywhere in the dataset. Call it with the `DirectoryLock` held."""
    remove_partials(root)
    for folder in FOLDERS:
        if (root / folder).is_dir() and not (root / folder).is_symlink():
            for directory in [folder, *(e.path for e in walk(root, folder) if e.kind == "folder")]:
                remove_partials(root / directory)


def differing_keys(old: Any, new: Any, path: str = "") -> Iterator[str]:
    """Yield ``key.path: old -> new`` for every leaf that differs."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted(old.keys() | new.keys()):
            yield from differing_keys(old.get(key), new.get(key), f"{path}.{key}" if path else key)
    elif old != new:
        yield f"{path}: {_short(old)} -> {_short(new)}"


def _refuse_other_recipe(root: Path, old: Mapping[str, Any], new: Mapping[str, Any]) -> None:
    if old.get("parts"):
        raise InputError(
            f"{root} is merged from other datasets and does not grow; grow one of those and merge again"
        )
    asked = canonical.parse(canonical.canonical(stable(new["recipe"])), "recipe")
    found = list(differing_keys(stable(old["recipe"]), asked))
    if found:
        raise InputError(
            f"{root} holds another recipe ({'; '.join(found[:8])}); use the same one or another --out"
        )
    if old["recipe_id"] != new["recipe_id"]:
        versions = f"{old.get('scene_semantics')} -> {new['scene_semantics']}"
        raise InputError(
            f"{root} was made when this recipe meant other scenes (version {versions}); use another --out"
        )
    before, now = old["recipe"].get("pairs"), new["recipe"].get("pairs")
    if before is not None and now is not None and now < before:
        raise InputError(
            f"{root} is planned for {before} pairs and only grows; ask for --pairs {before} or more"
        )


def _joined(root: Path, old: Mapping[str, Any], new: Mapping[str, Any], allow_mixed: bool) -> dict[str, Any]:
    """Return the lock to keep: the old one with the new number of pairs, and with what else rendered into it.

    A sensed dataset takes over what its source, which may have grown, is made of now.
    """
    joined = {
        **old,
        "recipe": {
            **old["recipe"],
            **({"pairs": new["recipe"]["pairs"]} if "pairs" in new["recipe"] else {}),
        },
    }
    joined |= {key: new[key] for key in (KEY, SOURCE) if key in new}
    known = [old["fingerprint"], *old["mixed_with"]]
    if new["fingerprint"] not in known:
        if not allow_mixed:
            what = "; ".join(list(differing_keys(old["fingerprint"], new["fingerprint"]))[:6])
            raise InputError(
                f"{root} was rendered by other software ({what}); add --allow-mixed to accept that"
            )
        joined["mixed_with"] = [*old["mixed_with"], dict(new["fingerprint"])]
    return joined


def _short(value: Any) -> str:
    text = canonical.canonical(value).decode()
    return text if len(text) <= 60 else text[:57] + "..."


__all__ = [
    "NoSpaceError",
    "check_output",
    "clean",
    "create_or_open",
    "differing_keys",
    "finished",
    "read_lock",
]
