"""The page about own scenes does what it says: its snippet runs, its sidecar fits, its table names every key."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.maps.own_scene import limits
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.own_scene.own_scene import build_own_scene
from scenegen.maps.own_scene.sidecar import Sidecar
from scenegen_cli.main import main

PAGE = (Path(__file__).parents[2] / "docs" / "own_scenes.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    found = re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)
    assert len(found) == 1
    return found[0]


def test_the_farm_can_be_made_listed_and_built(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "make_farm.py").write_text(block("python"))
    (tmp_path / "farm.yaml").write_text(block("yaml"))
    subprocess.run([sys.executable, "make_farm.py"], cwd=tmp_path, check=True)
    scene = tmp_path / "farm.glb"
    assert main(["maps", str(scene)]) == 0
    told = capsys.readouterr()
    assert told.err == ""
    (silo,) = (line.split() for line in told.out.splitlines() if line.startswith("silo"))
    assert silo[-2:] == ["metal_galv_weathered", "chimney"]
    world = build_own_scene("farm", OwnScene(file=str(scene)), Season(48.0, 6, 21), np.random.default_rng(0))
    assert {Semantic.GRASS, Semantic.ROAD, Semantic.WALL, Semantic.CHIMNEY, Semantic.TREE} < set(
        np.unique(world.face_semantic)
    )


def test_every_key_and_limit_stands_on_the_page() -> None:
    assert set(re.findall(r"^\| `(\w+)` \|", PAGE, re.MULTILINE)) == set(Sidecar.model_fields)
    for words in (
        f"{limits.MAX_FILE_BYTES >> 20} MiB",
        f"{limits.MAX_FACES // 10**6} million triangles",
        f"{limits.MAX_PIECES:,} parts",
        f"{limits.READING_CPU_S} s",
        f"{limits.READING_BYTES >> 30} GiB",
    ):
        assert words in PAGE
