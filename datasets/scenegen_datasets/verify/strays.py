"""What lies in a dataset and is no part of it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from scenegen.foundation.atomic import is_partial
from scenegen_datasets.inside import MAX_DEPTH, Entry, walk
from scenegen_datasets.store import FOLDERS, OURS, RUN_LOG

SCRATCH = ".repair"
"""Where clips are made again before they take their places."""


@dataclass(frozen=True, order=True)
class Stray:
    """One thing that does not belong.

    Attributes
    ----------
    path : str
        Below the dataset.
    reason : str
    """

    path: str
    reason: str


def find_strays(root: Path, belongs: Collection[str]) -> tuple[set[str], list[Stray]]:
    """Sort what lies below a dataset.

    Parameters
    ----------
    root : Path
    belongs : collection of str
        Files that are part of it, besides those with fixed names and the pictures under ``preview/``.

    Returns
    -------
    files : set of str
        All plain files, strays included.
    strays : list of Stray
        Links, pipes, devices, leftovers, strange files, and folders too deep to be ours; sorted. What is hidden at the
        top is none of our business: version control and hubs keep it there.
    """
    files: set[str] = set()
    strays: list[Stray] = []
    for entry in walk(root):
        top, _, rest = entry.path.partition("/")
        if top.startswith(".") and not (is_partial(top) and not rest):
            continue
        if entry.kind == "file":
            files.add(entry.path)
        reason = _reason(entry, belongs)
        if reason:
            strays.append(Stray(entry.path, reason))
    return files, sorted(strays)


def _reason(entry: Entry, belongs: Collection[str]) -> str:
    path = entry.path
    if is_partial(path.rpartition("/")[2]):
        return "left behind by a killed writer; the next render, or `scenegen clean`, removes it"
    if entry.kind == "link":
        return "a symbolic link; `scenegen clean` removes it"
    if entry.kind == "other":
        return "a pipe, a socket or a device; `scenegen clean` removes it"
    if entry.kind == "folder":
        deep = path.count("/") >= MAX_DEPTH - 1
        return "a folder deeper than any of a dataset; `scenegen clean` removes it" if deep else ""
    if path in belongs or path in OURS or path.startswith((*(f"{f}/" for f in FOLDERS[2:]), f"{RUN_LOG}.")):
        return ""
    return "does not belong to the dataset (not in the manifest)"
