"""``scenegen demo``: about a minute from nothing to pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scenegen_cli.console import say
from scenegen_cli.parse import parse

CLIPS, PAIRS_PER_CLIP = 4, 16


@dataclass(frozen=True)
class Demo:
    """Make a small dataset of one city at four hours of different days, and draw its pictures."""

    out: Path = Path("scenegen-demo")
    """Directory of the dataset."""
    jobs: int = 0
    """Worker processes; 0 is one per CPU."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    command = parse(Demo, "demo", arguments)
    from scenegen_cli.making import make, pictures, processes
    from scenegen_cli.render import ask
    from scenegen_datasets.render_job import Job

    asked, recipe = ask(None, None, {"clips_per_world": CLIPS, "pairs_per_clip": PAIRS_PER_CLIP})
    job = Job(
        recipe=recipe,
        pairs=CLIPS * PAIRS_PER_CLIP,
        root=command.out,
        asked=asked,
        processes=processes(command.jobs),
    )
    code = make(job, ["scenegen", "demo", *arguments], check_after=True, as_json=False)
    sheet, flight = pictures(command.out)
    say(f"contact sheet  {sheet}\nanimation      {flight}  (opens in any browser)")
    say(f"next           scenegen info {command.out}\n               scenegen render --map city --pairs 512")
    return code
