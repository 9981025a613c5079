"""A dataset of two maps, the city and a scene of the user's own, and a look at both before rendering."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import small
from PIL import Image

import hostile_scenes as hostile
from scenegen.classes import Semantic
from scenegen_cli.main import main
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.recipe import resolve_recipe
from scenegen_datasets.resolve import Source

SIDECAR = (
    "up_axis: z\ndefault_material: brick_red\nmaterials: {ground: asphalt_aged}\nclasses: {ball: boat}\n"
)
FLAGS = (
    *("--size", "64x64", "--pairs-per-clip", "2", "--clips-per-world", "1", "--city.extent-m", "400"),
    *("--exposure.directions", "32", "--exposure.sun-step-min", "120"),
    *("--flight.height-m", "6", "12", "--flight.speed-mps", "3"),
)


def rendered(root: Path, pairs: int, *maps: str | Path) -> int:
    named = [word for map in maps for word in ("--map", str(map))]
    return main(["render", "--pairs", str(pairs), "--out", str(root), "--jobs", "2", *FLAGS, *named])


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenes") / "My Yard.glb"
    path.write_bytes(hostile.sound(".glb"))
    path.with_suffix(".yaml").write_text(SIDECAR)
    return path


def test_city_and_an_own_scene_take_turns_in_one_dataset(scene: Path, tmp_path: Path) -> None:
    root = tmp_path / "both"
    assert rendered(root, 4, "city", scene) == 0
    pairs = PairDataset(root, layers=["thermal", "depth", "semantic", "temperature"])
    samples = [pairs[i] for i in range(len(pairs))]
    assert [sample["key"][:-5] for sample in samples[::2]] == ["city-00000-000", "my_yard-00000-000"]
    seen = set(np.unique([sample["semantic"] for sample in samples[2:]]).tolist())
    assert seen <= {Semantic.SKY, Semantic.ROAD, Semantic.WALL, Semantic.BOAT}
    assert Semantic.ROAD in seen
    assert (root / "shards/train/my_yard-00000/000.tar").is_file()
    lock = json.loads((root / "recipe.lock.json").read_text())
    assert list(lock["recipe"]["scenes"]) == ["my_yard"]
    assert str(scene.parent) not in (root / "recipe.lock.json").read_text()


def test_the_same_files_elsewhere_continue_a_dataset_and_other_files_do_not(
    scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    root, moved = tmp_path / "yard", tmp_path / "moved" / "My Yard.glb"
    moved.parent.mkdir()
    shutil.copy(scene, moved)
    shutil.copy(scene.with_suffix(".yaml"), moved.with_suffix(".yaml"))
    assert rendered(root, 2, scene) == 0
    before = small.tree(root)
    assert rendered(root, 2, moved) == 0
    assert {k: v for k, v in small.tree(root).items() if k != "recipe.yaml"} == {
        k: v for k, v in before.items() if k != "recipe.yaml"
    }
    moved.with_suffix(".yaml").write_text(SIDECAR.replace("brick_red", "granite"))
    capsys.readouterr()
    assert rendered(root, 2, moved) == 2
    assert "scenes" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("sidecar", "message"),
    [
        ("", "is empty"),
        ("up_axis: z\n", "no material for 'ground', 'house 0', 'house 1', 'ball'; map them in"),
        ("default_material: brick\n", "unknown material 'brick'"),
        ("default_material: granite\nmaterials: {hose: granite}\n", "nothing in"),
    ],
)
def test_a_wrong_sidecar_is_said_before_anything_is_made(
    scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], sidecar: str, message: str
) -> None:
    path = tmp_path / "yard.glb"
    shutil.copy(scene, path)
    path.with_suffix(".yaml").write_text(sidecar)
    assert main(["render", "--map", str(path), "--pairs", "4", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_two_scenes_of_one_name_are_refused(
    scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / "my-yard.obj"
    assert main(["render", "--map", str(scene), str(other), "--pairs", "4"]) == 2
    assert "are both called my_yard; rename one file" in capsys.readouterr().err


def test_a_recipe_file_may_name_scenes(scene: Path) -> None:
    given = {"map": ["city", "yard"], "scenes": {"yard": {"file": str(scene)}}}
    by_path = resolve_recipe([Source("r.yaml", {"map": str(scene)})])
    by_name = resolve_recipe([Source("r.yaml", given)])
    assert by_name.scenes["yard"].sha256 == by_path.scenes["my_yard"].sha256
    assert by_name.canonical()["scenes"] == {"yard": {"sha256": by_name.scenes["yard"].sha256}}
    unused = resolve_recipe([Source("r.yaml", given | {"map": "city"})])
    assert unused.canonical() == resolve_recipe([]).canonical()


def test_an_own_scene_is_drawn_and_listed_before_it_is_rendered(
    scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "look" / "yard.png"
    assert main(["maps", str(scene), "--preview", str(out), "--json", "--exposure.directions", "32"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["objects"] == 4
    assert told["classes"]["wall"]["objects"] == 2
    assert told["files"] == [str(out)]
    picture = np.asarray(Image.open(out))
    assert picture.shape[2] == 3
    assert picture.shape[0] > picture.shape[1] > 1000
    assert main(["maps", str(scene)]) == 0
    listed = capsys.readouterr().out
    assert "house 1" in listed
    assert "brick_red" in listed
