"""``scenegen render``: make a dataset, resume one, or grow one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenegen.foundation.errors import InputError
from scenegen_cli.asking import sources
from scenegen_cli.console import say, say_json
from scenegen_cli.helping import keys_help
from scenegen_cli.parse import parse, split_recipe_flags
from scenegen_datasets.licence import checked_licence
from scenegen_datasets.recipe import Recipe, resolve_recipe, settle_pairs
from scenegen_datasets.resolve import leaves, merge

if TYPE_CHECKING:
    from scenegen_datasets.render_job import Job


@dataclass(frozen=True)
class Render:
    """Make a dataset. Run again to resume it where it stopped; raise --pairs to grow it."""

    pairs: int | None = None
    """How many pairs, rounded up to whole clips; must be given."""
    out: Path | None = None
    """Directory of the dataset; by default scenegen-MAP here."""
    recipe: Path | None = None
    """YAML file of recipe keys; flags win over it."""
    size: str | None = None
    """Image size WIDTHxHEIGHT; keeps the camera's horizontal field of view."""
    jobs: int = 0
    """Worker processes; 0 is one per CPU."""
    dry_run: bool = False
    """Say what would be made, and stop."""
    no_verify: bool = False
    """Do not verify the whole dataset at the end."""
    allow_mixed: bool = False
    """Go on with a dataset that other software versions began."""
    license: str | None = None
    """Licence of the data, by its SPDX name; CC-BY-4.0 if nothing else is said."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    own, flags = split_recipe_flags(arguments, [key for key, _, _ in leaves(Recipe)])
    command = parse(Render, "render", own, _recipe_help())
    from scenegen.maps.own_scene.own_scene import describe
    from scenegen_cli.making import make, processes
    from scenegen_datasets.render_job import Job

    asked, recipe = ask(command.recipe, command.size, flags)
    if not command.pairs:
        raise InputError("--pairs is missing or 0: say how many pairs to make, such as --pairs 512")
    recipe, pairs = settle_pairs(recipe, command.pairs)
    for scene in recipe.scenes.values():
        describe(scene)  # what is wrong with a scene is said now, not when its first clip is due
    out = command.out or Path("-".join(("scenegen", *recipe.map)))
    job = Job(
        recipe=recipe,
        pairs=pairs,
        root=out,
        asked=asked,
        processes=processes(command.jobs),
        allow_mixed=command.allow_mixed,
        license=None if command.license is None else checked_licence(command.license),
    )
    if command.dry_run:
        _say_plan(job, command)
        return 0
    again = ["scenegen", "render", *arguments, *([] if command.out else ["--out", str(out)])]
    if pairs != command.pairs and not command.json:
        say(f"{command.pairs:,} pairs are rounded up to {pairs:,}: whole clips of {recipe.pairs_per_clip}")
    return make(job, again, check_after=not command.no_verify, as_json=command.json)


def ask(file: Path | None, size: str | None, flags: Mapping[str, Any]) -> tuple[dict[str, Any], Recipe]:
    """What was asked for, and the recipe that follows from it.

    Parameters
    ----------
    file : Path or None
        Recipe file.
    size : str or None
        As `Render.size`.
    flags : mapping
        Recipe keys from the command line, nested.
    """
    asked = sources(file, flags, size)
    return merge(source.values for source in asked), resolve_recipe(asked)


def _say_plan(job: Job, command: Render) -> None:
    from scenegen_cli.making import plan_in_words

    splits = {name: sum(c.pairs for c in job.clips if c.split == name) for name in ("train", "val", "test")}
    if command.json:
        say_json(
            {
                "root": str(job.root),
                "pairs": job.pairs,
                "clips": len(job.clips),
                "splits": splits,
                "bytes": job.bytes,
                "recipe": job.recipe.canonical(),
            }
        )
        return
    say(f"{job.root}: {plan_in_words(job)}")
    say("splits: " + ", ".join(f"{count:,} pairs {name}" for name, count in splits.items()))


def _recipe_help() -> str:
    """All recipe keys, generated from the recipe itself."""
    title = "recipe keys, as flags here or in a YAML file (a range is two numbers: --climate.hour 20 23):"
    return "\n\n" + keys_help(
        title, leaves(Recipe), lambda key: "drawn" if key.startswith("climate.") else "none"
    )
