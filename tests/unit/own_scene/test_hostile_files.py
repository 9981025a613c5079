"""Scene files of strangers: refused in one line or repaired, and nothing outside the file is touched."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import hostile_scenes as hostile
from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene import parse
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.own_scene.own_scene import build_own_scene
from scenegen.maps.own_scene.raw import RawScene
from scenegen.maps.own_scene.reading import read_scene
from scenegen.maps.own_scene.repair import join, repair
from scenegen.maps.own_scene.sidecar import Sidecar
from scenegen.world import World

Z_UP = Sidecar(up_axis="z")

SEASON = Season(48.0, 6, 21)

MUTANTS = 18
"""Of each format; ``python tests/hostile_scenes.py 900`` reads more."""


def built(path: Path, seed: int = 0) -> World:
    return build_own_scene("trial", OwnScene(file=str(path)), SEASON, np.random.default_rng(seed))


def _glb(tmp_path: Path, change: dict[str, object]) -> Path:
    header, blob = hostile._split(hostile.sound(".glb"))
    path = tmp_path / "bad.glb"
    path.write_bytes(hostile._joined(header | change, blob))
    return path


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"buffers": [{"uri": "http://example.org/a.bin", "byteLength": 4}]},
            "refers to another file, 'http://exam",
        ),
        ({"buffers": [{"uri": "../../../etc/passwd", "byteLength": 4}]}, "refers to another file"),
        (
            {"extensionsRequired": ["KHR_draco_mesh_compression"]},
            "uses the extension KHR_draco_mesh_compression",
        ),
        ({"extensionsUsed": ["EXT_mesh_gpu_instancing"]}, "uses the extension EXT_mesh_gpu_instancing"),
        ({"nodes": [{"children": [1, 1]}, {"mesh": 0}]}, "has a node with two parents"),
        (
            {"nodes": [{"children": [1]}, {"mesh": 0, "children": [0]}], "scenes": [{"nodes": [0]}]},
            "starts inside of itself",
        ),
        ({"nodes": [{"name": "empty"}], "scenes": [{"nodes": [0]}]}, "has no node with triangles"),
        ({"nodes": [{"mesh": 77}]}, "refers to item 77 of a list of"),
        (
            {"accessors": [{"count": 10**12, "type": "VEC3", "componentType": 5126}] * 9},
            "has more than 2,000,000",
        ),
        (
            {"nodes": [{"mesh": 0, "scale": [1e-9, 1e-9, 1e-9]}], "scenes": [{"nodes": [0]}]},
            "is unit_m right?",
        ),
    ],
)
def test_hostile_headers_are_refused_in_one_line(
    tmp_path: Path, change: dict[str, object], message: str
) -> None:
    path = _glb(tmp_path, change)
    with pytest.raises(InputError) as caught:
        read_scene(path, Z_UP)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_too_many_triangles_by_repetition_are_refused(tmp_path: Path) -> None:
    """A file of half a megabyte that stands for forty million triangles."""
    ball = trimesh.creation.icosphere(subdivisions=5)
    header, blob = hostile._split(trimesh.Scene({"ball": ball}).export(file_type="glb"))
    header["nodes"] = [{"mesh": 0, "translation": [3 * k, 0, 0]} for k in range(2000)]
    header["scenes"] = [{"nodes": list(range(2000))}]
    path = tmp_path / "bomb.glb"
    path.write_bytes(hostile._joined(header, blob))
    with pytest.raises(InputError, match="has more than 2,000,000 triangles"):
        read_scene(path, Z_UP)


def test_mutants_of_every_format_are_read_or_refused_and_kill_nobody(tmp_path: Path) -> None:
    files = []
    for ending in hostile.ENDINGS:
        for number in range(MUTANTS):
            files.append(tmp_path / f"{number}{ending}")
            files[-1].write_bytes(hostile.mutant(ending, number))
    outcome = {path.name: (what, words) for path, what, words in hostile.read_all(files)}
    assert len(outcome) == len(files)
    assert [name for name, (what, _) in outcome.items() if what == "crashed"] == []
    assert all("\n" not in words for _, words in outcome.values())
    assert {what for what, _ in outcome.values()} == {"read", "refused"}


def test_what_is_read_of_mutants_can_be_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def read_here(path: Path, _: Sidecar) -> RawScene:
        with np.errstate(all="ignore"):
            soups, ignored = parse.parse(path.read_bytes(), path.suffix, path.stem)
            return repair(join(soups), ignored, "z", 1.0)

    monkeypatch.setattr("scenegen.maps.own_scene.own_scene.read_scene", read_here)
    (tmp_path / "scene.yaml").write_text("default_material: granite\n")
    worlds = 0
    for ending in hostile.ENDINGS:
        for number in range(1000, 1016):
            path = tmp_path / f"{number}{ending}"
            path.write_bytes(hostile.mutant(ending, number))
            try:
                read_here(path, Z_UP)
            except Exception:  # refused, as the child would
                continue
            world = built(path)
            np.testing.assert_allclose(np.linalg.norm(world.sites.normal, axis=1), 1.0, atol=1e-5)
            assert np.isfinite(world.ground.height_m).all()
            worlds += 1
    assert worlds > 8


def test_a_child_that_dies_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "yard.obj"
    path.write_bytes(hostile.sound(".obj"))
    monkeypatch.setattr("scenegen.maps.own_scene.reading._CHILD", "dying_reader:worker")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    with pytest.raises(
        InputError, match=r"yard.obj: cannot be read: its worker was killed by SIGSEGV \(limits: "
    ):
        read_scene(path, Z_UP)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "does not exist"),
        (b"", "is empty"),
        (b"glTF", "is no binary glTF 2 file"),
        (b"\0" * 99, "is no binary"),
    ],
)
def test_what_is_no_scene_is_said(tmp_path: Path, content: bytes | None, message: str) -> None:
    path = tmp_path / "x.glb"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_scene(path, Z_UP)


def test_a_gltf_with_its_numbers_in_another_file_is_refused(tmp_path: Path) -> None:
    header, _ = hostile._split(hostile.sound(".glb"))
    header["buffers"][0]["uri"] = "yard.bin"
    path = tmp_path / "yard.gltf"
    path.write_text(json.dumps(header))
    (tmp_path / "yard.bin").write_bytes(b"\0" * 9999)
    with pytest.raises(InputError, match=r"refers to another file, 'yard\.bin'; export it as one \.glb"):
        read_scene(path, Z_UP)
