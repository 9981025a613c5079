"""Make rendered clips again, from a recipe alone, by the path on which they were made first."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from scenegen.foundation.errors import InputError
from scenegen_datasets.job import ClipJob
from scenegen_datasets.lock import VOLATILE_KEYS, fingerprint, recipe_id
from scenegen_datasets.probe import render_fingerprint
from scenegen_datasets.recipe import SCENE_SEMANTICS, Recipe, refuse_too_large_a_plan
from scenegen_datasets.render_job import Job
from scenegen_datasets.run import Progress, make_clips
from scenegen_datasets.run_log import RunLog
from scenegen_datasets.store import LOCK

Told = Callable[[Progress], None]


def recipe_of(root: Path, entry: Mapping[str, Any]) -> Recipe:
    """The recipe clips were rendered by; of files of the user's own it holds the content, not the place.

    Parameters
    ----------
    root : Path
        The dataset.
    entry : mapping
        Its lock, or what that says of a dataset it was made from.

    Raises
    ------
    InputError
        If this version of scenegen would make other samples of it.
    """
    if entry.get("scene_semantics") != SCENE_SEMANTICS:
        raise InputError(
            f"{root} was made when this recipe meant other scenes (version {entry.get('scene_semantics')}, this "
            f"scenegen makes {SCENE_SEMANTICS}); install the scenegen that made it (see {LOCK}, 'software')"
        )
    plain = {key: value for key, value in entry["recipe"].items() if key not in VOLATILE_KEYS}
    try:
        recipe = Recipe.model_validate(plain)
    except (ValidationError, InputError) as error:
        raise InputError(
            f"{root / LOCK}: not a recipe of this scenegen: {str(error).splitlines()[0]}"
        ) from None
    if recipe_id(recipe.canonical(), SCENE_SEMANTICS) != entry["recipe_id"]:
        raise InputError(
            f"{root}: this scenegen reads another recipe out of {LOCK} than the one that was rendered; install the "
            "scenegen that made it (see 'software' there)"
        )
    return recipe


def job_of(root: Path, entry: Mapping[str, Any], into: Path | None = None, processes: int = 1) -> Job:
    """The job that rendered a dataset; its `clips` are the plan.

    Parameters
    ----------
    root, entry
        As for `recipe_of`.
    into : Path, optional
        Directory to render into, instead of the dataset's own.
    processes : int

    Raises
    ------
    InputError
        As `recipe_of`, or if the lock does not say how many pairs there are to be.
    """
    recipe, pairs = recipe_of(root, entry), entry["recipe"].get("pairs")
    if type(pairs) is not int or not 1 <= pairs <= 10**8:
        raise InputError(
            f"{root / LOCK}: does not say how many pairs the dataset has; restore it from a copy"
        )
    refuse_too_large_a_plan(recipe, pairs)
    return Job(recipe=recipe, pairs=pairs, root=into or root, asked={}, processes=processes)


def fingerprint_here() -> dict[str, str]:
    """Fingerprint of what would render on this machine now.

    Raises
    ------
    BackendError
        If the renderer cannot start.
    """
    return fingerprint(render_fingerprint())


def remake(
    job: Job, clips: Sequence[ClipJob], fingerprint: str, log_root: Path, told: Told
) -> dict[str, str]:
    """Render clips of a plan again, below the job's directory; shards and receipts lie there as in a dataset.

    Parameters
    ----------
    job : Job
        Whose `root` is an existing directory: not that of the dataset.
    clips : sequence of ClipJob
    fingerprint : str
        Id of the render fingerprint, for the receipts.
    log_root : Path
        Directory of the log of costs.
    told : callable
        Hears of progress.

    Returns
    -------
    dict
        Clips that could not be made, and why.
    """
    with RunLog(log_root) as log:
        log.write("remake", clips=[clip.name for clip in clips], fingerprint=fingerprint)
        return make_clips(job, clips, fingerprint, log, told)
