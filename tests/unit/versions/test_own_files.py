"""Files of a user's own are found again by their content: the recipe knows what they are, not where they lie."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

import hostile_scenes
from scenegen.foundation.errors import InputError
from scenegen_datasets.lock import recipe_id
from scenegen_datasets.recipe import SCENE_SEMANTICS, resolve_recipe
from scenegen_datasets.render_job import Job
from scenegen_datasets.repair.own_files import located
from scenegen_datasets.repair.remake import job_of
from scenegen_datasets.resolve import Source


@pytest.fixture
def yard(tmp_path: Path) -> Path:
    path = tmp_path / "scenes" / "yard.glb"
    path.parent.mkdir()
    path.write_bytes(hostile_scenes.sound(".glb"))
    path.with_suffix(".yaml").write_text("up_axis: z\ndefault_material: granite\n")
    return path


@pytest.fixture
def flight(tmp_path: Path) -> Path:
    path = tmp_path / "flight.csv"
    rows = "".join(f"{0.1 * k:.1f},{0.5 * k:.1f},0,20\n" for k in range(200))
    path.write_text(f"time_s,x_m,y_m,z_m\n{rows}")
    return path


def remembered(root: Path, asked: dict[str, Any]) -> Job:
    """What a dataset's lock tells of the job that made it."""
    root.mkdir(exist_ok=True)
    recipe = resolve_recipe([Source("", {"pairs_per_clip": 2, "clips_per_world": 1, **asked})]).canonical()
    return job_of(
        root,
        {
            "recipe": {**recipe, "pairs": 4},
            "scene_semantics": SCENE_SEMANTICS,
            "recipe_id": recipe_id(recipe, SCENE_SEMANTICS),
        },
    )


def moved(scene: Path, to: Path) -> Path:
    to.parent.mkdir()
    for path in (scene, scene.with_suffix(".yaml")):
        shutil.move(path, to.with_suffix(path.suffix))
    return to


def test_the_plan_needs_no_file_and_a_scene_is_found_under_any_name(yard: Path, tmp_path: Path) -> None:
    job = remembered(tmp_path / "data", {"map": ["city", str(yard)]})
    assert [clip.map for clip in job.clips] == ["city", "yard"] and job.recipe.scenes["yard"].file == ""
    there = moved(yard, tmp_path / "elsewhere" / "farm.glb")
    city, own = job.clips
    assert located(job, [city], job.root, False, ()) is job, "a city needs no scene"
    found = located(job, [city, own], job.root, False, [there])
    assert found.recipe.scenes["yard"].file == str(there)
    assert found.recipe.canonical() == job.recipe.canonical() and found.clips == job.clips


@pytest.mark.parametrize(
    ("own", "where"), [(False, "only the dataset it was"), (True, "it is not where recipe.yaml says")]
)
def test_what_is_missing_is_named_with_what_to_do(yard: Path, tmp_path: Path, own: bool, where: str) -> None:
    job = remembered(tmp_path / "data", {"map": str(yard)})
    (job.root / "recipe.yaml").write_text(f"map: {yard}\n")
    yard.with_suffix(".yaml").write_text("up_axis: z\ndefault_material: brick_red\n")
    with pytest.raises(InputError, match=rf"takes the scene yard, .* {where}.*; name it: --own-files FILE"):
        located(job, job.clips, job.root, own, [yard])
    with pytest.raises(InputError, match=r"no_such\.glb: does not exist"):
        located(job, job.clips, job.root, own, [tmp_path / "no_such.glb"])


@pytest.mark.parametrize(
    "told",
    ["map: scenes/yard.glb", "map: [city, scenes/yard.glb]", "scenes: {yard: {file: scenes/yard.glb}}"],
)
def test_a_relative_place_is_looked_for_beside_the_dataset(yard: Path, tmp_path: Path, told: str) -> None:
    job = remembered(tmp_path / "data", {"map": str(yard)})
    (job.root / "recipe.yaml").write_text(f"{told}\nflight: 3\n")
    assert located(job, job.clips, job.root, True, ()).recipe.scenes["yard"].file == str(yard)


def test_a_recording_is_found_as_well(flight: Path, tmp_path: Path) -> None:
    asked = {"map": "city", "flight": {"styles": ["recorded"], "recorded": {"file": str(flight)}}}
    job = remembered(tmp_path / "data", asked)
    assert job.recipe.flight.recorded.file == ""
    with pytest.raises(InputError, match="takes the recording of its flights"):
        located(job, job.clips, job.root, False, ())
    there = flight.rename(tmp_path / "other.csv")
    assert located(job, job.clips, job.root, False, [there]).recipe.flight.recorded.file == str(there)
