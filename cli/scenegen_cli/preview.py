"""``scenegen preview``: contact sheet and animation of a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.errors import InputError
from scenegen_cli.console import say
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class Preview:
    """Draw a contact sheet (PNG) and a flight (animated WebP) of a dataset, finished or growing."""

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    out: Path | None = None
    """Folder for the pictures; by default DATASET/preview, where a finished dataset already has them."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Preview, "preview", arguments)
    from scenegen_datasets.info import info
    from scenegen_datasets.pictures.preview import FLIGHT, SHEET, draw_preview, write_preview

    paths = [command.dataset / SHEET, command.dataset / FLIGHT]
    finished = info(command.dataset).complete and all(path.is_file() for path in paths)
    if command.out is not None:
        paths = [command.out / path.name for path in paths]
        for path, content in zip(paths, draw_preview(command.dataset), strict=True):
            _write(path, content)
    elif not finished:  # those of a finished dataset are in its manifest
        write_preview(command.dataset)
    for path in paths:
        say(str(path))
    return 0


def _write(path: Path, content: bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
