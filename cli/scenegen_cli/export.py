"""``scenegen export``: write a dataset in a format that somebody else's tools read."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.words import counted, size
from scenegen_cli.console import say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.parse import parse
from scenegen_datasets.exports.options import Options
from scenegen_datasets.exports.registry import FORMATS

_DEFAULT = Options()


@dataclass(frozen=True)
class Export:
    """Export a dataset. Run again to go on after an interruption, or when the dataset has grown."""

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of a finished dataset."""
    to: str
    """Format; the list stands below."""
    out: Path | None = None
    """Directory of the export; by default DATASET-FORMAT beside the dataset."""
    split: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = ()
    """Only this split; may be repeated."""
    map: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = ()
    """Only this map; may be repeated."""
    jobs: int = 0
    """Processes; 0 is one per CPU. Does not change the files."""
    gain: str = _DEFAULT.gain
    """Thermal to 8 bits: clip (percentiles of the clip), ground (the same without sky), fixed (see --gain-K)."""
    gain_K: tuple[float, float] = _DEFAULT.gain_K
    """With --gain fixed: brightness temperatures of black and white [K]."""
    depth_cap_m: float = _DEFAULT.depth_cap_m
    """pix2pix: depth that is white [m]."""
    depth_unit_m: float = _DEFAULT.depth_unit_m
    """tum: what one step of a depth picture is worth [m]."""
    encoding: str = _DEFAULT.encoding
    """ms2: 16-bit thermal as counts, or as those of a FLIR A65C (a65c)."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Export, "export", arguments, _formats())
    from scenegen_cli.making import processes
    from scenegen_cli.progress import Meter
    from scenegen_datasets.exports.engine import export
    from scenegen_datasets.exports.plan import Request

    dataset = command.dataset
    out = command.out or _beside(dataset, command.to)
    options = Options(
        gain=command.gain,
        gain_K=command.gain_K,
        depth_cap_m=command.depth_cap_m,
        depth_unit_m=command.depth_unit_m,
        encoding=command.encoding,
    )
    request = Request(dataset, out, command.to, options, command.split, command.map)
    with (
        resumable("whole clips are kept", ["scenegen", "export", *arguments]),
        Meter(quiet=command.json) as meter,
    ):
        outcome = export(request, processes(command.jobs), meter.exported)
    if command.json:
        say_json({**asdict(outcome), "root": str(outcome.root)})
        return 0
    for words in outcome.words:
        say(words)
    there = outcome.clips - outcome.made
    say(
        f"{outcome.root}: {outcome.frames:,} frames of {counted(outcome.clips, 'clip')} as {outcome.to}, "
        f"{size(outcome.bytes)}" + (f"; {counted(there, 'clip')} had been there" if there else "")
    )
    return 0


def _beside(dataset: Path, to: str) -> Path:
    """Where an export goes if nobody says; by the dataset's name as it was given, be that a link."""
    whole = Path(os.path.abspath(dataset))  # noqa: PTH100  resolve() follows links
    return whole.parent / f"{whole.name}-{to}"


def _formats() -> str:
    width = max(map(len, FORMATS))
    lines = "\n".join(f"  {name:<{width}}  for {each.readers}" for name, each in FORMATS.items())
    return f"\n\nformats (docs/exports.md has range, step and loss of each):\n{lines}"
