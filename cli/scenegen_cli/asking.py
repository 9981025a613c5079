"""Where the recipe keys of a command line come from: a file, flags that stand for keys, and keys as flags."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.strict_yaml import read_mapping
from scenegen_cli.parse import parse_size
from scenegen_datasets.resolve import Source


def sources(
    file: Path | None, flags: Mapping[str, Any], size: str | None = None, short: Sequence[Source] = ()
) -> list[Source]:
    """What was asked for, from the weakest to the strongest.

    Parameters
    ----------
    file : Path or None
        Recipe file.
    flags : mapping
        Recipe keys from the command line, nested.
    size : str or None
        ``--size WIDTHxHEIGHT``; the horizontal field of view stays what it is.
    short : sequence of Source
        Other flags that stand for recipe keys.

    Raises
    ------
    InputError
        If the file cannot be read, or the size is none.
    """
    found = [] if file is None else [Source(str(file), read_mapping(file))]
    if size is not None:
        width, height = parse_size(size)
        found.append(Source(f"--size {size}", {"camera": {"width_px": width, "height_px": height}}))
    return [*found, *short, Source("", flags)]
