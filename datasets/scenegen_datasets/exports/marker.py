"""What proves an export: who it is, and which clips of it are whole."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.atomic import make_directories, remove_partials, write_atomic
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.exports.format import Written
from scenegen_datasets.seal import read_bounded, sealed, unsealed
from scenegen_datasets.store import check_output, differing_keys

FOLDER = ".export"
"""What is ours in an export; readers that list its directory pass over names with a dot."""

IDENTITY = f"{FOLDER}/identity.json"
SUMMARY = "export.json"
"""Written last: an export with it is complete."""

_CLIPS, _MAX_BYTES = f"{FOLDER}/clips", 64 << 20


@dataclass(frozen=True)
class Marker:
    """Proof of one clip.

    Attributes
    ----------
    files : mapping of str to int
        Size of every file by its path below the export.
    written : Written
    clip : str
        Sum of the clip it was made from, `scenegen_datasets.exports.clip.clip_sha256`.
    """

    files: Mapping[str, int]
    written: Written
    clip: str


def claim(root: Path, identity: Mapping[str, Any]) -> None:
    """Make `root` the home of the export of this identity, or prove that it is. Call it with the directory's lock held.

    Raises
    ------
    InputError
        If it holds something else, naming what differs.
    """
    check_output(root, (), IDENTITY, "export")
    path = root / IDENTITY
    if not path.exists():
        make_directories(root, _CLIPS)
        write_atomic(path, sealed("export", identity))
        return
    try:
        found = unsealed("export", read_bounded(path, _MAX_BYTES), str(path))
    except DatasetError as error:
        raise InputError(f"{error}; remove {root} and export again") from None
    asked = canonical.parse(canonical.canonical(dict(identity)), "export")
    differing = list(differing_keys(found, asked))
    if differing:
        raise InputError(f"{root} holds another export ({'; '.join(differing[:6])}); choose another --out")


def kept_clips(root: Path, sums: Mapping[str, str]) -> dict[str, Marker]:
    """Markers of the clips that are whole; refuses to go on beside one that the dataset holds no more, or otherwise.

    Parameters
    ----------
    root : Path
        Of the export.
    sums : mapping of str to str
        `clip_sha256` of every clip to export, by name.

    Raises
    ------
    InputError
        Naming such a clip.
    """
    kept = {}
    for path in sorted((root / _CLIPS).glob("[!.]*.json")):
        name, marker = path.stem, _proof(path)
        if name not in sums:
            raise InputError(
                f"{root} holds {name}, which is not asked for or not there; choose another --out"
            )
        if marker is None:
            continue
        if marker.clip != sums[name]:
            raise InputError(
                f"{root} holds {name} as it was before it changed in the dataset; remove {root} and export again, "
                "or choose another --out"
            )
        if _is_whole(root, marker):
            kept[name] = marker
    return kept


def write_marker(root: Path, clip: str, marker: Marker) -> None:
    """Declare a clip whole; its files are already where they belong."""
    make_directories(root, _CLIPS)
    body = {
        "clip": marker.clip,
        "files": dict(marker.files),
        "counts": dict(marker.written.counts),
        "facts": dict(marker.written.facts),
    }
    write_atomic(_path(root, clip), sealed("clip", body))


def read_marker(root: Path, clip: str) -> Marker | None:
    """Marker of a clip, or None if it has none, a damaged one, or one whose files are gone or of other sizes."""
    marker = _proof(_path(root, clip))
    return marker if marker is not None and _is_whole(root, marker) else None


def clean(root: Path) -> None:
    """Remove unfinished markers of killed writers. Call it with the directory's lock held."""
    for directory in (root, root / FOLDER, root / _CLIPS):
        remove_partials(directory)


def _proof(path: Path) -> Marker | None:
    """What a marker says, or None if it is not there or damaged; its files are not looked at."""
    if not path.is_file():
        return None
    try:
        body = unsealed("clip", read_bounded(path, _MAX_BYTES), str(path))
        return Marker(body["files"], Written(body["counts"], body["facts"]), body["clip"])
    except (DatasetError, KeyError, OSError):
        return None


def _is_whole(root: Path, marker: Marker) -> bool:
    """Whether its files are there, with the sizes it tells."""
    try:
        return all((root / name).lstat().st_size == size for name, size in marker.files.items())
    except OSError:
        return False


def _path(root: Path, clip: str) -> Path:
    return root / _CLIPS / f"{clip}.json"
