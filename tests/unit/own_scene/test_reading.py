"""Reading scene files: names arrive, strangers' bytes are refused or repaired, nothing outside the file is touched."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

import hostile_scenes as hostile
from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene import parse
from scenegen.maps.own_scene.identity import content_hash, is_scene_path, scene_name, sidecar_path
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


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "yard.glb"
    path.write_bytes(hostile.sound(".glb"))
    (tmp_path / "yard.yaml").write_text(
        "up_axis: z\ndefault_material: brick_red\n"
        "materials: {ground: asphalt_aged, ball: {temperature_K: 333, emissivity: 0.7}}\nclasses: {ball: boat}\n"
    )
    return path


@pytest.mark.parametrize("ending", hostile.ENDINGS)
def test_all_formats_hold_the_same_triangles(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"yard{ending}"
    path.write_bytes(hostile.sound(ending))
    raw = read_scene(path, Z_UP)
    assert len(raw.faces) == 12 * 3 + 320
    assert raw.repairs == ()
    corners = raw.vertices[raw.faces]
    area = (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2
    )
    assert area == pytest.approx(
        2 * 40 * 40 + 4 * 40 + 2 * 2 * (6 * 8 + 6 * 5 + 8 * 5) + 4 * np.pi * 4, rel=0.01
    )


def test_a_world_has_what_the_file_and_its_sidecar_say(scene: Path) -> None:
    world = built(scene)
    assert set(np.unique(world.face_semantic)) == {Semantic.ROAD, Semantic.WALL, Semantic.BOAT}
    assert len(np.unique(world.face_object)) == 4
    ball = world.palette[int(world.face_surface[world.face_semantic == Semantic.BOAT][0])]
    assert (ball.prescribed_K, ball.emissivity, ball.material.id) == (333.0, 0.7, 1000)
    assert abs(world.ground.at(np.array([[15.0, -15.0]]))[0]) < 1e-3
    low, high = np.asarray(world.flight_box_m)
    mesh = world.mesh.vertices
    assert (low[:2] >= mesh[:, :2].min(axis=0)).all()
    assert (high[:2] <= mesh[:, :2].max(axis=0)).all()
    assert dict(world.counts)["triangles in the file"] == 356
    assert world.sites.area.sum() == pytest.approx(
        np.linalg.norm(
            np.cross(*(mesh[world.mesh.faces][:, k] - mesh[world.mesh.faces][:, 0] for k in (1, 2))), axis=1
        ).sum()
        / 2,
        rel=1e-4,
    )


def test_the_generator_draws_materials_and_nothing_else(scene: Path) -> None:
    one, same, other = built(scene, 1), built(scene, 1), built(scene, 2)
    assert repr(one.palette) == repr(same.palette)  # NaN is not equal to itself
    assert repr(one.palette) != repr(other.palette)
    for a in (same, other):
        assert a.mesh.vertices.tobytes() == one.mesh.vertices.tobytes()
        assert a.sites.position.tobytes() == one.sites.position.tobytes()
    assert same.face_surface.tobytes() == one.face_surface.tobytes()


def test_flights_stay_in_the_area_of_the_sidecar(scene: Path) -> None:
    sidecar = scene.with_suffix(".yaml")
    words = sidecar.read_text()
    sidecar.write_text(words + "flight_area_m: [-10, -100, 12, 5]\nflight_ceiling_m: 30\n")
    low, high = built(scene).flight_box_m
    assert (low[0], low[1], high[0], high[1]) == (-10.0, -18.0, 12.0, 5.0)
    assert high[2] - low[2] == pytest.approx(30.0)
    sidecar.write_text(words + "flight_area_m: [100, 100, 200, 200]\n")
    with pytest.raises(InputError, match="lies outside the scene"):
        built(scene)


def test_names_of_objects_groups_and_materials_of_an_obj_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "named.obj"
    path.write_bytes(
        b"mtllib secret.mtl\r\nv 0 0 0\r\nv 9 0 0\r\nv 9 9 0\r\nv 0 9 0\r\nv 0 9 5\r\n"
        b"o Big House\r\nusemtl red brick\r\nf 1 2 3\r\ng roof\r\nusemtl tiles\r\nf 1 3 4\r\n"
        b"o Shed\r\nf 1 2 5\r\nl 1 2\r\nusemtl red brick\r\nf -5 -3 -1\r\n"
    )
    raw = read_scene(path, Sidecar())
    assert [(n.node, n.mesh, n.material) for n in raw.parts] == [
        ("Big House", "Big House", "red brick"),
        ("roof", "Big House", "tiles"),
        ("Shed", "Shed", "tiles"),
        ("Shed", "Shed", "red brick"),
    ]
    assert [n.object for n in raw.parts] == [1, 2, 3, 3]


def test_instances_and_several_materials_of_a_gltf_mesh(tmp_path: Path) -> None:
    header, blob = hostile._split(hostile.sound(".glb"))
    names = [m["name"] for m in header["meshes"]]
    house = header["meshes"][names.index("house")]
    house["primitives"].append(dict(house["primitives"][0], material=1))
    house["primitives"][0]["material"] = 0
    house["primitives"].append({"attributes": house["primitives"][0]["attributes"], "mode": 1})
    header["materials"] = [{"name": "brick"}, {"name": "glass", "extensions": {"KHR_materials_ior": {}}}]
    header["extensionsUsed"] = ["KHR_materials_ior"]
    path = tmp_path / "many.glb"
    path.write_bytes(hostile._joined(header, blob))
    raw = read_scene(path, Z_UP)
    found = [(n.node, n.material) for n in raw.parts if n.mesh == "house"]
    assert found == [("house 0", "brick"), ("house 0", "glass"), ("house 1", "brick"), ("house 1", "glass")]
    assert len({n.object for n in raw.parts}) == 4
    assert dict(raw.repairs) == {"lines and points ignored": 1, "faces dropped: duplicate": 24}


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


def test_another_content_is_another_identity_and_another_place_is_not(tmp_path: Path) -> None:
    one, two = tmp_path / "a" / "yard.glb", tmp_path / "b" / "farm.glb"
    for path in (one, two):
        path.parent.mkdir()
        path.write_bytes(hostile.sound(".glb"))
    assert content_hash(one) == content_hash(two)
    (one.parent / "scene.yaml").write_text("default_material: granite\n")
    assert sidecar_path(one) == one.parent / "scene.yaml"
    shared = content_hash(one)
    assert shared != content_hash(two)
    (one.parent / "yard.yaml").write_text("default_material: basalt\n")
    assert sidecar_path(one) == one.parent / "yard.yaml"
    assert content_hash(one) != shared
    one.write_bytes(hostile.sound(".glb") + b"\0\0\0\0")
    with pytest.raises(InputError, match="has changed since this dataset was begun"):
        build_own_scene("yard", OwnScene(file=str(one), sha256=shared), SEASON, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("a/b/Großes Haus 2.glb", "gro_es_haus_2"),
        ("3d.obj", "scene_3d"),
        ("city.ply", "scene_city"),
        ("__.gltf", "scene"),
        ("x" * 60 + ".glb", "x" * 24),
    ],
)
def test_names_are_made_of_file_names(file: str, name: str) -> None:
    assert is_scene_path(file)
    assert scene_name(file, ("city",)) == name


def test_a_gltf_with_its_numbers_in_another_file_is_refused(tmp_path: Path) -> None:
    header, _ = hostile._split(hostile.sound(".glb"))
    header["buffers"][0]["uri"] = "yard.bin"
    path = tmp_path / "yard.gltf"
    path.write_text(json.dumps(header))
    (tmp_path / "yard.bin").write_bytes(b"\0" * 9999)
    with pytest.raises(InputError, match=r"refers to another file, 'yard\.bin'; export it as one \.glb"):
        read_scene(path, Z_UP)
