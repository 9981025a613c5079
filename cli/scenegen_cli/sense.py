"""``scenegen sense``: look at the stored radiance of a dataset through another camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.errors import InputError
from scenegen.foundation.words import counted, size
from scenegen_cli.console import say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.parse import parse, parse_size, split_recipe_flags
from scenegen_datasets.resolve import leaves


@dataclass(frozen=True)
class Sense:
    """Make a dataset of what another camera sees of the same flights, without rendering again.

    Flags are those of render's sections camera and sensor: --sensor.netd-mk 30, --camera.preset tau640. The camera must
    have the band and the field of view that were rendered, and the same grid or a whole fraction of it.
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of a finished dataset."""
    out: Path | None = None
    """Directory of the new dataset. Must be given."""
    size: str | None = None
    """Image size WIDTHxHEIGHT: blocks of stored pixels become one."""
    seed: int | None = None
    """Seed of the new noise; by default that of the dataset's recipe."""
    no_verify: bool = False
    """Do not verify the new dataset at the end."""
    jobs: int = 0
    """Worker processes; 0 is one per CPU."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    from scenegen_datasets.sensing.camera import CameraKeys

    keys = [key for key, _, _ in leaves(CameraKeys)]
    own, flags = split_recipe_flags(arguments, keys)
    command = parse(Sense, "sense", own)
    from scenegen_cli.making import processes
    from scenegen_cli.progress import Meter
    from scenegen_cli.proving import exit_code, facts, in_words, proven
    from scenegen_datasets.sensing.run import sense_dataset

    if command.out is None:
        raise InputError("--out is missing: name the directory of the new dataset")
    if command.seed is not None and command.seed < 0:
        raise InputError(f"--seed {command.seed}: a seed is 0 or more")
    if command.size is not None:
        width, height = parse_size(command.size)
        flags["camera"] = {**flags.get("camera", {}), "width_px": width, "height_px": height}
    workers = processes(command.jobs)
    with (
        resumable("finished clips are kept", ["scenegen", "sense", *arguments]),
        Meter(quiet=command.json) as meter,
    ):
        done = sense_dataset(
            command.dataset,
            command.out,
            flags,
            seed=command.seed,
            processes=workers,
            told=meter.sensed,
        )
        new = done.made > 0
        report = None if command.no_verify else proven(command.out, workers, meter, new=new)
    if command.json:
        more = {"root": str(command.out), "side_px": done.side, "made": done.made}
        say_json({**asdict(done.info), **more, **facts(report)})
    else:
        blocks = f", {done.side}x{done.side} stored pixels each" if done.side > 1 else ""
        say(
            f"{command.out}: {counted(done.info.pairs, 'pair')} in {counted(done.info.clips, 'clip')}{blocks}, "
            f"{size(done.info.bytes)}{in_words(report)}"
        )
    return exit_code(command.out, report, new=new)
