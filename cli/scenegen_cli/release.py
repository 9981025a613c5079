"""``scenegen release``: give the present state of a dataset a version."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from scenegen_cli.console import say, say_json
from scenegen_cli.parse import parse

if TYPE_CHECKING:
    from scenegen_datasets.versions.release import Released


@dataclass(frozen=True)
class Release:
    """Verify a dataset and release it under a version.

    Above the last release, the version must rise by at least what changed: MAJOR when existing samples change, MINOR
    when clips or layers are added, PATCH when only their bytes change.
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    version: Annotated[str, tyro.conf.Positional]
    """MAJOR.MINOR.PATCH, such as 1.1.0."""
    jobs: int = 0
    """Processes that verify; 0 is one per CPU."""
    allow_missing: bool = False
    """Release it without the clips that could not be made."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Release, "release", arguments)
    from scenegen_cli.making import processes
    from scenegen_cli.progress import Meter
    from scenegen_datasets.versions.release import release

    with Meter(quiet=command.json) as meter:
        released = release(
            command.dataset,
            command.version,
            jobs=processes(command.jobs),
            allow_missing=command.allow_missing,
            progress=meter.verified,
        )
    if command.json:
        say_json({**asdict(released), "changes": [str(change) for change in released.changes]})
    else:
        say(_words(command.dataset, released))
    return 0


def _words(root: Path, released: Released) -> str:
    if released.again:
        return f"{root} is released as {released.version} already; nothing was written"
    lines = [f"{root} is released as {released.version}, content {released.content_id[:16]}"]
    if released.before:
        lines.append(
            f"since {released.before}:" if released.changes else f"nothing changed since {released.before}"
        )
    lines += [f"  {change.bump.name:5}  {change}" for change in released.changes]
    return "\n".join(lines)
