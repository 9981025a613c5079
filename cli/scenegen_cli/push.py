"""``scenegen push``: copy a dataset to a Hub or any storage, and check what arrived."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen.foundation.words import size
from scenegen_cli.console import say, say_json
from scenegen_cli.leaving import resumable
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class Push:
    """Copy a finished dataset to a URL; run again to resume. A reader there never sees half of it as the whole.

    The URL is hf://datasets/USER/NAME (log in with 'hf auth login'), or anything fsspec can write: s3://BUCKET/NAME,
    gs://BUCKET/NAME, file:///mnt/NAME. Buckets must exist; end points and keys come from the environment
    (AWS_ENDPOINT_URL, AWS_ACCESS_KEY_ID, GOOGLE_APPLICATION_CREDENTIALS, HF_TOKEN, ...).
    """

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset."""
    url: Annotated[str, tyro.conf.Positional]
    """Where to, such as hf://datasets/USER/NAME."""
    private: bool = False
    """Make a new repository on the Hub private."""
    quick: bool = False
    """Compare sizes only, where contents would have to be read back."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Push, "push", arguments)
    from scenegen_cli.progress import Meter
    from scenegen_datasets.push import push

    own_bars = command.url.startswith("hf://")  # of the Hub's client
    with (
        resumable("what was sent is kept", ["scenegen", "push", *arguments]),
        Meter(quiet=command.json or own_bars) as meter,
    ):
        done = push(
            command.dataset, command.url, private=command.private, quick=command.quick, told=meter.pushed
        )
    if command.json:
        say_json(asdict(done))
        return 0
    sent = f"sent {done.sent:,} ({size(done.sent_bytes)})" if done.sent else "all of it was there"
    gone = f", removed {done.removed:,} that do not belong" if done.removed else ""
    say(f"{done.url}: {done.files:,} files, {size(done.bytes)}; {sent}{gone}; checked")
    return 0
