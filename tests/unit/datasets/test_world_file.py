"""Worlds as files for other programs: nothing is lost on the way, and the sidecar brings it back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.own_scene.own_scene import build_own_scene
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen.world import World
from scenegen_datasets.census import count_classes, count_objects
from scenegen_datasets.world_file import ENDINGS, SIDECAR_MARK, parts_of, sidecar, world_file
from scenegen_render.reference_scenes import box_city


@pytest.fixture(scope="module")
def world() -> World:
    names = ("asphalt_aged", "brick_red", "bitumen_felt_roof", "window_glass")
    ground, wall, roof, glass = (Surface(material(n), material(n).emissivity, 0.8) for n in names)
    return box_city((ground, wall, roof, glass), np.random.default_rng(3), blocks=2, cell_m=5.0)


def test_the_census_counts_every_face_and_object_once(world: World) -> None:
    counts = {c.kind.id: c for c in count_classes(world)}
    assert set(counts) == {Semantic.ROAD, Semantic.WALL, Semantic.ROOF, Semantic.WINDOW}
    assert sum(c.triangles for c in counts.values()) == len(world.mesh.faces)
    assert count_objects(world) == 5
    assert (counts[Semantic.ROAD].objects, counts[Semantic.WALL].objects) == (1, 4)


@pytest.mark.parametrize("ending", ENDINGS)
def test_every_triangle_is_written(world: World, ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"city{ending}"
    path.write_bytes(world_file(parts_of(world, "class"), ending))
    scene = (
        trimesh.load_scene(path, process=False, split_objects=True)
        if ending == ".obj"
        else trimesh.load_scene(path)
    )
    assert sum(len(mesh.faces) for mesh in scene.geometry.values()) == len(world.mesh.faces)
    size = scene.extents[[0, 1, 2] if ending == ".ply" else [0, 2, 1]]
    expected = world.mesh.vertices.max(axis=0) - world.mesh.vertices.min(axis=0)
    np.testing.assert_allclose(size, expected, rtol=1e-5)
    if ending != ".ply":
        assert set(scene.geometry) == {
            "road/asphalt_aged",
            "wall/brick_red",
            "roof/bitumen_felt_roof",
            "window/window_glass",
        }


@pytest.mark.parametrize(("ending", "nodes"), [(".glb", "class"), (".glb", "object"), (".obj", "class")])
def test_an_exported_world_comes_back_as_an_own_scene(
    world: World, ending: str, nodes: str, tmp_path: Path
) -> None:
    parts = parts_of(world, "object" if nodes == "object" else "class")
    path = tmp_path / f"city{ending}"
    path.write_bytes(world_file(parts, ending))
    path.with_suffix(".yaml").write_text(sidecar(world, parts, ending))
    back = build_own_scene("back", OwnScene(file=str(path)), Season(40.0, 7, 15), np.random.default_rng(0))
    assert dict(back.counts)["triangles in the file"] == len(world.mesh.faces)
    for kind in (Semantic.ROAD, Semantic.WALL, Semantic.ROOF, Semantic.WINDOW):
        there, here = (_area(w, w.face_semantic == kind) for w in (world, back))
        assert here == pytest.approx(there, rel=1e-4)
        names = {
            back.palette[s].material.name for s in np.unique(back.face_surface[back.face_semantic == kind])
        }
        assert len(names) == 1
    np.testing.assert_allclose(
        back.flight_box_m[0][:2], np.asarray(world.flight_box_m[0][:2]) + 5.0, atol=0.1
    )


def test_objects_become_nodes_if_asked_for(world: World) -> None:
    parts = parts_of(world, "object")
    assert len({p.object for p in parts}) == 5
    assert len({p.name for p in parts}) == len(parts) > 5
    assert sum(len(p.faces) for p in parts) == len(world.mesh.faces)


def test_a_prescribed_surface_stays_one(world: World) -> None:
    hot = Surface(material("brick_red"), 0.5, 0.8, prescribed_K=320.0)
    hot = replace(hot, material=replace(hot.material, id=1000, name="prescribed_320K_0.5"))
    warm = replace(world, palette=(*world.palette[:1], hot, *world.palette[2:]))
    words = sidecar(warm, parts_of(warm, "class"), ".glb")
    assert words.startswith(SIDECAR_MARK)
    assert "temperature_K: 320.0" in words
    assert sidecar(warm, parts_of(warm, "class"), ".ply") == ""


def _area(world: World, chosen: np.ndarray) -> float:
    corners = world.mesh.vertices[world.mesh.faces[chosen]].astype(float)
    return float(
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2
    )
