"""Make clips of any dataset again, from its lock alone: of a rendered one, a merged one, a sensed one.

A lock says how its clips came to be: by a recipe; from ``parts``, each of which has a lock of its own kind; or from the
radiance of a ``source``, which has one, too. So whatever was made of what, it ends with recipes, and from there the way
is gone again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import make_directories
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets.job import ClipJob
from scenegen_datasets.lock import SOURCE
from scenegen_datasets.receipt import read_receipt
from scenegen_datasets.repair.own_files import located
from scenegen_datasets.repair.remake import Told, job_of, remake
from scenegen_datasets.sensing.run import film_again
from scenegen_datasets.store import LOCK
from scenegen_datasets.versions.numbers import offset_of
from scenegen_datasets.versions.placing import place_clip

Entry = Mapping[str, Any]


@dataclass(frozen=True)
class Again:
    """Makes clips of one dataset again.

    Attributes
    ----------
    root : Path
        The dataset; nothing but its log of costs is written there.
    processes : int
    fingerprint : str
        Id of the software here, for the receipts.
    log_root : Path
        Directory of the log of costs.
    told : callable
        Hears of rendering.
    own_files : tuple of Path
        Scenes and recordings that the user named; they are told by content.
    """

    root: Path
    processes: int
    fingerprint: str
    log_root: Path
    told: Told
    own_files: tuple[Path, ...] = ()

    def make(self, lock: Entry, clips: Sequence[ClipJob], into: Path) -> dict[str, str]:
        """Make clips of the dataset with this lock; shards and receipts lie below `into` as they do there.

        Returns
        -------
        dict
            Clips that could not be made, and why.

        Raises
        ------
        InputError
            If this scenegen would make others, or needs files of the user that cannot be found.
        DatasetError
            If the lock makes no sense.
        """
        return self._make(lock, clips, into, own=True)

    def _make(self, entry: Entry, clips: Sequence[ClipJob], into: Path, own: bool) -> dict[str, str]:
        if entry.get("parts"):
            return self._merge(entry, clips, into)
        if "sensed" in entry["recipe"]:
            return self._sense(entry, clips, into)
        job = located(job_of(self.root, entry, into, self.processes), clips, self.root, own, self.own_files)
        return remake(job, clips, self.fingerprint, self.log_root, self.told)

    def _merge(self, entry: Entry, clips: Sequence[ClipJob], into: Path) -> dict[str, str]:
        """Each part's clips by its own recipe and under their own names, then put into the whole."""
        failed: dict[str, str] = {}
        wanted = set(clips)
        places = _places(self.root, entry)
        for k, part in enumerate(entry["parts"]):
            mine = {
                place.own: place.whole for place in places if place.part is part and place.whole in wanted
            }
            if not mine:
                continue
            folder = make_directories(into, f"part-{k}")
            lost = self._make(part, sorted(mine), folder, own=False)
            for own, whole in mine.items():
                if own.name in lost:
                    failed[whole.name] = lost[own.name]
                else:
                    place_clip(folder, read_receipt(folder, own.receipt), into, whole, copy=False)
        return failed

    def _sense(self, entry: Entry, clips: Sequence[ClipJob], into: Path) -> dict[str, str]:
        """The source's clips first, then the camera looks at them again."""
        folder = make_directories(into, SOURCE)
        failed = self._make(_source(self.root, entry), clips, folder, own=False)
        made = [clip for clip in clips if clip.name not in failed]
        film_again(entry["recipe"], folder, into, made, self.fingerprint, self.processes)
        return failed


def planned(root: Path, lock: Entry) -> tuple[ClipJob, ...]:
    """All clips a dataset should have, in plan order.

    Raises
    ------
    InputError
        If this scenegen cannot tell, because the recipe is of another version.
    DatasetError
        If the lock makes no sense.
    """
    if lock.get("parts"):
        return tuple(place.whole for place in _places(root, lock))
    if "sensed" in lock["recipe"]:
        return planned(root, _source(root, lock))
    return job_of(root, lock).clips


@dataclass(frozen=True)
class _Place:
    """A clip of a merged dataset: its part's entry, its job there, and its job in the whole."""

    part: Entry
    own: ClipJob
    whole: ClipJob


def _places(root: Path, lock: Entry) -> list[_Place]:
    """All clips of a merged dataset in its order, which is by world, map and clip."""
    found = []
    for part in lock["parts"]:
        offset, missing = offset_of(part), set(part["missing"])
        for job in planned(root, part):
            if job.name not in missing:
                found.append((job.world + offset, job.map, job.clip, part, job))
    found.sort(key=lambda place: place[:3])
    try:
        return [
            _Place(part, job, replace(job, ordinal=k, world=world))
            for k, (world, _, _, part, job) in enumerate(found)
        ]
    except ValueError as error:
        raise DatasetError(f"{root / LOCK}: its parts make no sense: {error}") from None


def _source(root: Path, lock: Entry) -> Entry:
    """What the lock of a sensed dataset says of the one it was sensed from."""
    source = lock.get(SOURCE)
    if source is None:
        raise InputError(
            f"{root} was sensed by an older scenegen, which did not keep the recipe of the radiance; remove what is "
            "damaged, and run the same `scenegen sense` command again"
        )
    if not (isinstance(source, Mapping) and isinstance(source.get("recipe"), Mapping)):
        raise DatasetError(f"{root / LOCK}: what it says of its {SOURCE} makes no sense")
    return source
