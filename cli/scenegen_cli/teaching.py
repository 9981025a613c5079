"""What train, evaluate and table1 share: recipe keys as flags, and how far they are."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_cli.console import note, span
from scenegen_cli.helping import keys_help
from scenegen_cli.parse import split_recipe_flags
from scenegen_datasets.resolve import leaves

SAY_EVERY_S = 15.0


def training_flags(arguments: Sequence[str]) -> tuple[list[str], dict[str, Any]]:
    """Take the recipe keys of a training out of a command line; `model` and `seed` stay flags of the command."""
    from scenegen_trainers.training.recipe import TrainingRecipe

    keys = [key for key, _, _ in leaves(TrainingRecipe) if key not in ("model", "seed")]
    return split_recipe_flags(arguments, keys)


def recipe_help() -> str:
    """All recipe keys, generated from the recipe itself."""
    from scenegen_trainers.training.recipe import MODELS, PROFILES, TrainingRecipe

    known = f"models: {', '.join(MODELS)}; profiles: {', '.join(PROFILES)}"
    title = "recipe keys, as flags here or in a YAML file; models and profiles set some of them:"
    keys = [row for row in leaves(TrainingRecipe) if row[0] not in ("model", "seed")]
    return f"\n\n{known}\n\n{keys_help(title, keys)}"


def need_torch() -> None:
    """Say in one line what to install where torch is missing."""
    from importlib.util import find_spec

    if find_spec("torch") is None:
        raise InputError("this needs torch and lightning: pip install 'thermal-scenegen[train]'")


class Steps:
    """A line on standard error now and then: how far, how long still, and what the losses are.

    Parameters
    ----------
    doing : str
    quiet : bool
    """

    def __init__(self, doing: str, *, quiet: bool = False) -> None:
        self._doing, self._quiet = doing, quiet
        self._began = self._shown = time.monotonic()
        self._first = -1
        self._last: Mapping[str, float] = {}

    def __call__(self, done: int, total: int, losses: Mapping[str, float] | None = None) -> None:
        """So many steps of so many are done."""
        now = time.monotonic()
        self._first = done - 1 if self._first < 0 else self._first
        self._last = losses or self._last
        patience = 1.0 if sys.stderr.isatty() else SAY_EVERY_S
        if self._quiet or (now - self._shown < patience and done < total):
            return
        self._shown = now
        left = (total - done) * (now - self._began) / (done - self._first)
        said = "  ".join(f"{name} {value:.3g}" for name, value in self._last.items())
        note(f"{self._doing}  {done:,} of {total:,}  {span(left)} left  {said}".rstrip())
