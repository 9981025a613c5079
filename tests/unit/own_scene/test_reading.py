"""Reading scene files: names arrive, and a world has what a file and its sidecar say."""

from pathlib import Path

import numpy as np
import pytest

import hostile_scenes as hostile
from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.identity import content_hash, is_scene_path, scene_name, sidecar_path
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.own_scene.own_scene import build_own_scene
from scenegen.maps.own_scene.reading import read_scene
from scenegen.maps.own_scene.sidecar import Sidecar
from scenegen.world import World

Z_UP = Sidecar(up_axis="z")

SEASON = Season(48.0, 6, 21)


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
