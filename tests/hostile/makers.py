"""Commands that make a dataset of the one they read: what they leave is whole and sound, or does not look whole."""

from __future__ import annotations

import contextlib
import json
import shutil
from pathlib import Path

from hostile.documents import agree
from hostile.typed import check_pages, typed
from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import ScenegenError
from scenegen_datasets.inside import read_inside, walk
from scenegen_datasets.lock import recipe_id
from scenegen_datasets.seal import with_seal
from scenegen_datasets.store import CARD, DATASET, LOCK, MANIFEST

_OTHER_SEED = 7
_MOST_BYTES = 1 << 24


class MadeError(Exception):
    """What was made looks whole and is not, or what it was made of has changed."""


def merge_linked(root: Path, scratch: Path) -> None:
    """Merge it with a sound dataset of another seed: its own worlds keep their numbers, its shards are linked."""
    other = shutil.copytree(root.parent / "sound", scratch / "other")
    _reseed(other, _OTHER_SEED)
    _make(root, scratch / "out", "merge", str(scratch / "out"), str(root), str(other), "--jobs", "1")


def merge_renumbered(root: Path, scratch: Path) -> None:
    """Merge it as the dataset of another seed: its worlds get other numbers, its shards are written anew."""
    sound = shutil.copytree(root.parent / "sound", scratch / "other")
    with contextlib.suppress(Exception):  # of documents that are beyond that, the seed does not matter either
        _reseed(root, _OTHER_SEED)
    _make(root, scratch / "out", "merge", str(scratch / "out"), str(sound), str(root), "--jobs", "1")


def sense(root: Path, scratch: Path) -> None:
    """Look at its radiance through a noisier camera."""
    out = scratch / "out"
    _make(root, out, "sense", str(root), "--out", str(out), "--sensor.netd-mk", "80", "--jobs", "1")


def _make(root: Path, out: Path, *words: str) -> None:
    before = _state(root)
    try:
        code = typed(*words)
    except ScenegenError:
        _check(not (out / DATASET).exists(), "refused, and what was made looks whole")
        raise
    finally:
        _check(_state(root) == before, "the dataset that was read has changed")
        check_pages(out / CARD)
    _check(
        (out / DATASET).is_file() == (code == 0), f"exit code {code} after verifying, and it looks otherwise"
    )


def _check(holds: bool, otherwise: str) -> None:
    if not holds:
        raise MadeError(otherwise)


def _state(root: Path) -> dict[str, tuple[int, int]]:
    """Sizes and times of all there is."""
    found = ((entry.path, (root / entry.path).lstat()) for entry in walk(root))
    return {path: (at.st_size, at.st_mtime_ns) for path, at in found}


def _reseed(root: Path, seed: int) -> None:
    """Let a dataset say that it was made from another seed, lock and description in agreement."""
    plain = [read_inside(root, name, _MOST_BYTES) for name in (LOCK, DATASET, MANIFEST)]
    lock, told = map(json.loads, plain[:2])
    lock["recipe"]["seed"] = seed
    lock["recipe_id"] = recipe_id(lock["recipe"], lock["scene_semantics"])
    told.pop("seal")
    told["recipe_id"] = lock["recipe_id"]
    (root / LOCK).write_bytes(pretty(lock))
    (root / DATASET).write_bytes(pretty(with_seal(told)))
    agree(root, (LOCK,))
