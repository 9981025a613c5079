"""Release a dataset: give its present state a version, if the version says enough and the state is proven."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from scenegen.foundation.atomic import remove, write_atomic
from scenegen.foundation.errors import DatasetError, InputError
from scenegen.foundation.lock import DirectoryLock
from scenegen_datasets.description import read_description
from scenegen_datasets.finish import derive
from scenegen_datasets.job import ClipJob
from scenegen_datasets.manifest import file_sha256
from scenegen_datasets.receipt import read_receipt, receipt_paths
from scenegen_datasets.store import DATASET, MANIFEST, RELEASES, clean, read_lock
from scenegen_datasets.verify import verify
from scenegen_datasets.versions.history import History, Release, read_history
from scenegen_datasets.versions.rule import Change, compare, needed
from scenegen_datasets.versions.semver import Bump, Version
from scenegen_datasets.versions.state import State, finished_description, state_of

_NAMED = 3
"""Changes or findings named in a refusal."""

Told = Callable[[int, int], None]


@dataclass(frozen=True)
class Released:
    """What a release came to.

    Attributes
    ----------
    version : str
    before : str
        The release before; empty for the first.
    content_id : str
    changes : tuple of Change
        Since the release before.
    again : bool
        Whether it was there already, and nothing was written.
    """

    version: str
    before: str
    content_id: str
    changes: tuple[Change, ...]
    again: bool = False


def release(
    root: Path,
    version: str,
    *,
    jobs: int = 1,
    allow_missing: bool = False,
    progress: Told | None = None,
) -> Released:
    """Release a dataset under a version, after verifying every byte of it.

    May be killed at any moment: what ``dataset.json`` says is then true of the samples, and the release is one when
    it stands there. The history is written first, so that the same call continues where it was killed.

    Parameters
    ----------
    root : Path
    version : str
        MAJOR.MINOR.PATCH, above that of the last release by at least what changed since then. The first is free.
    jobs : int
        Processes that verify.
    allow_missing : bool
        Release a dataset without the clips of its plan that could not be made.
    progress : callable, optional
        Hears of (clips verified, clips in all).

    Raises
    ------
    InputError
        If there is no dataset, it is not finished, somebody writes to it, or the version says too little: with what
        changed.
    DatasetError
        If it does not verify: with what was found.
    """
    asked = Version.parse(version)
    read_lock(root)
    with DirectoryLock(root):
        clean(root)
        history = read_history(root)
        if history is not None and history.version == asked and not _is_told(root):
            _complete(root, history)
        missing = _refuse_unproven(root, jobs, allow_missing, progress)
        state = state_of(root)
        changes = compare(history.state, state) if history is not None else ()
        content_id = str(finished_description(root)["content_id"])
        if history is not None and history.version == asked and not changes:
            before = history.releases[-2].version if len(history.releases) > 1 else ""
            return Released(version, before, content_id, (), again=True)
        if history is not None:
            _refuse_small_step(root, history.version, asked, changes)
        _write(root, history, state, version, changes, missing)
    return Released(version, str(history.version) if history else "", content_id, changes)


def _refuse_unproven(root: Path, jobs: int, allow_missing: bool, progress: Told | None) -> tuple[str, ...]:
    """Verify; returns the clips that are known to be missing."""
    missing = tuple(finished_description(root)["missing"])
    if missing and not allow_missing:
        raise InputError(
            f"{root} is finished without {len(missing)} of its clips ({', '.join(missing[:_NAMED])}); "
            "run the same render command again, or release it as it is with --allow-missing"
        )
    found = [
        finding
        for finding in verify(root, jobs, progress=progress).findings
        if not (finding.file == DATASET and any(f"clip {clip} " in finding.reason for clip in missing))
    ]
    if found:
        raise DatasetError(
            f"{root} is not released: verify found {len(found)} faults, such as {found[0]}; run 'scenegen repair'"
        )
    return missing


def _refuse_small_step(root: Path, last: Version, asked: Version, changes: tuple[Change, ...]) -> None:
    bump = needed(changes)
    least = last.bumped(max(bump, Bump.PATCH))
    if last.step_to(asked) >= max(bump, Bump.PATCH):
        return
    named = "; ".join(str(change) for change in changes if change.bump is bump)
    why = f"what changed asks for a {bump.name} step ({named})" if changes else "nothing changed"
    if asked <= last:
        raise InputError(
            f"{root}: {asked} is not above {last}, its last release; release it as {least} or above"
        )
    raise InputError(f"{root}: {asked} says too little after {last}: {why}; release it as {least} or above")


def _write(
    root: Path,
    history: History | None,
    state: State,
    version: str,
    changes: tuple[Change, ...],
    missing: tuple[str, ...],
) -> None:
    """Enter the release into the history, then derive everything that names the version; ``dataset.json`` last."""
    description = finished_description(root)
    entry = Release(
        version=version,
        recipe_id=description["recipe_id"],
        content_id=description["content_id"],
        counts=description["counts"],
        changes=tuple(str(change) for change in changes),
    )
    releases = (*(history.releases if history else ()), entry)
    new = History(releases, state, missing)
    write_atomic(root / RELEASES, new.to_bytes())
    _derive(root, missing)


def _derive(root: Path, missing: tuple[str, ...]) -> None:
    """From here until `derive` ends, nothing says that all is there."""
    remove(root / DATASET)
    remove(root / MANIFEST)
    derive(root, _made(root), missing)


def _is_told(root: Path) -> bool:
    """Whether ``dataset.json`` is there and knows this very history."""
    if not (root / DATASET).exists():
        return False
    return bool(read_description(root / DATASET)["sums"].get(RELEASES) == file_sha256(root / RELEASES))


def _complete(root: Path, history: History) -> None:
    """Go on where a release was killed, if the clips are still those that were to be released."""
    if {job.name for job in _made(root)} == history.state.clips.keys():
        _derive(root, history.missing)


def _made(root: Path) -> list[ClipJob]:
    return sorted(read_receipt(root, path).clip.job for path in receipt_paths(root))
