"""Scenes and recordings of a user's own: a dataset knows what is in them, not where they lie now.

They are told by content, wherever they are found: among files the user names, or where the dataset's ``recipe.yaml``
says, seen from here and from the directory the dataset lies in.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.foundation.strict_yaml import read_mapping
from scenegen.maps.own_scene.identity import content_hash, is_scene_path
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen_datasets.job import ClipJob
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.render_job import Job
from scenegen_datasets.resolve import Source
from scenegen_datasets.scenes import name_scenes
from scenegen_datasets.store import RECIPE

FLAG = "--own-files"
_DIGITS = 16


def located(job: Job, clips: Sequence[ClipJob], root: Path, own: bool, given: Sequence[Path]) -> Job:
    """The job with the files that its clips are rendered from.

    Parameters
    ----------
    job : Job
        Whose recipe was read from a dataset, and so has contents in the place of files.
    clips : sequence of ClipJob
        What is to be rendered; scenes of other maps are not looked for.
    root : Path
        The dataset.
    own : bool
        Whether the recipe is that of the dataset itself, not of one it was made from: ``recipe.yaml`` belongs to it.
    given : sequence of Path
        Files the user named.

    Raises
    ------
    InputError
        If a file is needed and not among these, or one of those named cannot be read.
    """
    recipe = job.recipe
    needed = _needed(recipe, {clip.map for clip in clips})
    if not needed:
        return job
    found = {_content(path): path for path in given}
    if own and not needed.keys() <= found.keys():
        for path in _told(root):
            with contextlib.suppress(InputError):
                found.setdefault(_content(path), path)
    for content, what in needed.items():
        if content not in found:
            raise InputError(_refusal(root, what, content, own))
    return replace(job, recipe=_with_files(recipe, {key: str(p.absolute()) for key, p in found.items()}))


def _needed(recipe: Recipe, maps: set[str]) -> dict[str, str]:
    """Content of every file that is needed, and what it is."""
    found = {scene.sha256: f"scene {name}" for name, scene in recipe.scenes.items() if name in maps}
    if "recorded" in recipe.flight.styles:
        found[recipe.flight.recorded.sha256] = "recording of its flights"
    return found


def _content(path: Path) -> str:
    """Identity of a scene, which its sidecar is part of, or of a recording."""
    if is_scene_path(path.name):
        return content_hash(path)
    from scenegen_flythrough.recordings.read import identity

    return identity(str(path))


def _told(root: Path) -> Iterator[Path]:
    """Places that ``recipe.yaml`` names; relative ones were seen from where the dataset was made."""
    try:
        (asked,) = name_scenes([Source(RECIPE, read_mapping(root / RECIPE))])
    except InputError:
        return
    scenes, flight = _mapping(asked.values.get("scenes")), _mapping(asked.values.get("flight"))
    for one in (*scenes.values(), flight.get("recorded")):
        file = _mapping(one).get("file")
        if isinstance(file, str) and file and "\0" not in file:
            yield Path(file)
            yield root.absolute().parent / file


def _mapping(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _with_files(recipe: Recipe, files: Mapping[str, str]) -> Recipe:
    scenes = {
        name: OwnScene(file=files.get(scene.sha256, ""), sha256=scene.sha256)
        for name, scene in recipe.scenes.items()
    }
    recorded = recipe.flight.recorded
    recorded = recorded.model_copy(update={"file": files.get(recorded.sha256, "")})
    flight = recipe.flight.model_copy(update={"recorded": recorded})
    return recipe.model_copy(update={"scenes": scenes, "flight": flight})


def _refusal(root: Path, what: str, content: str, own: bool) -> str:
    where = (
        f"it is not where {RECIPE} says, or has changed"
        if own
        else "only the dataset it was rendered into knows where it lay"
    )
    return (
        f"{root}: to make its clips again takes the {what}, a file of your own (content {content[:_DIGITS]}...), and "
        f"{where}; name it: {FLAG} FILE"
    )
