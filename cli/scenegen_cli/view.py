"""``scenegen view``: a page on this machine that shows a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from scenegen_cli.console import say
from scenegen_cli.parse import parse


@dataclass(frozen=True)
class View:
    """Look at a dataset in a browser: frames, layers, numbers under the cursor, the flight in space. Ctrl-C ends it."""

    dataset: Annotated[Path, tyro.conf.Positional]
    """Directory of the dataset, finished or growing."""
    port: int = 0
    """Port on the loopback address; 0 takes a free one."""
    no_open: bool = False
    """Do not open a browser, only say where the page is."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(View, "view", arguments)
    from scenegen_datasets.view.serve import serve

    serve(command.dataset, port=command.port, show=not command.no_open, ready=say)
    return 0
