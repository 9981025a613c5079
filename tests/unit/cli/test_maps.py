"""``scenegen maps``: lists, and what is said before anything is built."""

import json
from pathlib import Path

import pytest

from scenegen.maps.registry import MAPS
from scenegen_cli.main import main


def test_all_maps_are_listed_with_their_knobs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["maps"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in listed[1:]] == list(MAPS)
    assert main(["maps", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert all(row["keys"] and all(row["keys"].values()) for row in rows)


def test_the_knobs_of_one_map_have_default_and_meaning(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["maps", "city"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("city: ")
    (storeys,) = (line for line in lines if line.startswith("city.storeys"))
    assert storeys.split()[1:3] == ["2", "6"]
    assert main(["maps", "city", "--json"]) == 0
    assert {"key": "city.storeys", "default": [2.0, 6.0]}.items() <= next(
        row for row in json.loads(capsys.readouterr().out) if row["key"] == "city.storeys"
    ).items()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["maps", "citty"], "unknown map 'citty'; perhaps you meant 'city'"),
        (["maps", "citty", "--preview", "x.png"], "unknown map 'citty'; perhaps you meant 'city'"),
        (["maps", "--preview", "x.png"], "name the map to look at"),
        (["maps", "city", "--preview", "x.jpg"], "--preview x.jpg: name a file that ends in .png"),
        (["maps", "city", "--export", "x.blend"], "--export x.blend: name a file that ends in .glb, .gltf"),
        (["maps", "city", "--preview", "here.png"], "--preview here.png: is a directory"),
        (["maps", "city", "--preview", "file/x.png"], "--preview file: is a file; name a directory"),
        (
            ["maps", "city", "--export", "x.glb", "--nodes", "clas"],
            "--nodes clas: unknown; perhaps you meant 'class'",
        ),
        (["maps", "city", "--preview", "x.png", "--world", "-1"], "--world -1: choose 0 to 99,999"),
        (["maps", "city", "--preview", "x.png", "--city.store", "3"], "--city.store: unknown key"),
        (["maps", "nowhere.glb"], "nowhere.glb: does not exist"),
        (["maps", "nowhere.glb", "--preview", "x.png"], "nowhere.glb: does not exist"),
        (["maps", "city", "--pairs", "8"], "unknown flag '--pairs'"),
    ],
)
def test_a_mistake_is_one_line_and_nothing_is_written(
    arguments: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "here.png").mkdir()
    (tmp_path / "file").write_text("")
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.strip().splitlines()) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "here.png"]


def test_a_sidecar_written_by_hand_is_not_overwritten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import hostile_scenes as hostile

    scene, out = tmp_path / "yard.glb", tmp_path / "out.glb"
    scene.write_bytes(hostile.sound(".glb"))
    scene.with_suffix(".yaml").write_text("default_material: granite\n")
    out.with_suffix(".yaml").write_text("default_material: basalt\n")
    assert main(["maps", str(scene), "--export", str(out)]) == 2
    assert "out.yaml is there already, and not from here" in capsys.readouterr().err
    assert not out.exists()
    out.with_suffix(".yaml").unlink()
    for _ in range(2):  # its own it may write anew
        assert main(["maps", str(scene), "--export", str(out)]) == 0
        assert capsys.readouterr().out.splitlines()[:2] == [str(out), str(out.with_suffix(".yaml"))]
