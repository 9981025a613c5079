"""``releases.json``: the releases of a dataset, and the state of the last one, to compare the next with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.errors import DatasetError
from scenegen_datasets.documents import HISTORY
from scenegen_datasets.seal import check_seal, read_bounded, with_seal
from scenegen_datasets.shape import misshapen
from scenegen_datasets.store import RELEASES
from scenegen_datasets.versions.rule import compare, needed
from scenegen_datasets.versions.semver import FIRST, Bump, Version
from scenegen_datasets.versions.state import State

_MAX_BYTES = 256 << 20
_SCHEMA = 1


@dataclass(frozen=True)
class Release:
    """One release.

    Attributes
    ----------
    version : str
    recipe_id, content_id : str
    counts : mapping of str to int
        Pairs, frames, clips, worlds, shard_bytes.
    changes : tuple of str
        What changed since the release before, in words; empty for the first.
    """

    version: str
    recipe_id: str
    content_id: str
    counts: Mapping[str, int]
    changes: tuple[str, ...]


@dataclass(frozen=True)
class History:
    """All releases of a dataset, oldest first.

    Attributes
    ----------
    releases : tuple of Release
        At least one.
    state : State
        Of the last release.
    missing : tuple of str
        Clips of the plan that the last release went without.
    """

    releases: tuple[Release, ...]
    state: State
    missing: tuple[str, ...]

    @property
    def version(self) -> Version:
        """Of the last release."""
        return Version.parse(self.releases[-1].version)

    def to_bytes(self) -> bytes:
        """Return the file."""
        body = {
            "schema_version": _SCHEMA,
            "releases": [asdict(release) for release in self.releases],
            "last": self.state.to_dict(),
            "missing": list(self.missing),
        }
        return canonical.pretty(with_seal(body))


def read_history(root: Path) -> History | None:
    """Read the releases of a dataset; None if it was never released.

    Raises
    ------
    DatasetError
        If the file is damaged or of a newer version.
    """
    path = root / RELEASES
    if not path.exists() and not path.is_symlink():
        return None
    body = check_seal(canonical.parse(read_bounded(path, _MAX_BYTES), str(path)), str(path))
    if body.get("schema_version") != _SCHEMA:
        raise DatasetError(
            f"{path}: schema {body.get('schema_version')}, this version reads {_SCHEMA}; update scenegen"
        )
    wrong = misshapen(body, HISTORY) or (None if body["releases"] else "it names no release")
    if wrong:
        raise DatasetError(f"{path}: not a history of releases ({wrong})")
    releases = tuple(_release(entry) for entry in body["releases"])
    return History(releases, State.from_dict(body["last"]), tuple(body["missing"]))


def version_of(history: History | None, state: State) -> str:
    """Version of a dataset that is in this state.

    Before the first release it is 1.0.0; at a release, that of the release; afterwards, with changes that no release
    holds yet, the least version they need with ``-dev`` behind it.
    """
    if history is None:
        return FIRST
    bump = needed(compare(history.state, state))
    return str(history.version) if bump is Bump.NONE else f"{history.version.bumped(bump)}-dev"


def _release(entry: Mapping[str, Any]) -> Release:
    text = {name: entry[name] for name in ("version", "recipe_id", "content_id")}
    return Release(**text, counts=entry["counts"], changes=tuple(entry["changes"]))
