"""Sidecars: what they say, and every mistake in one line that names file and key."""

from pathlib import Path

import pytest

from scenegen.classes import Semantic
from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.naming import meanings
from scenegen.maps.own_scene.raw import Names
from scenegen.maps.own_scene.sidecar import Prescribed, Sidecar, read_sidecar

SCENE = Path("farm.glb")
PARTS = (
    Names("barn", "box", "wood", 0),
    Names("silo", "tube", "steel", 1),
    Names("silo 2", "tube", "steel", 2),
    Names("", "plane", "", 3),
)


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    return path


def test_a_sidecar_is_read_whole(tmp_path: Path) -> None:
    text = (
        "up_axis: z\nunit_m: 0.01\nmaterials: {barn: wood_siding, silo: {temperature_K: 310, emissivity: 0.3}}\n"
        "default_material: grass_dry\nclasses: {barn: roof}\nflight_ceiling_m: 60\nflight_area_m: [-5, -5, 5, 5]\n"
    )
    assert read_sidecar(written(tmp_path, text)) == Sidecar(
        up_axis="z",
        unit_m=0.01,
        materials={"barn": "wood_siding", "silo": Prescribed(temperature_K=310, emissivity=0.3)},
        default_material="grass_dry",
        classes={"barn": Semantic.ROOF},
        flight_ceiling_m=60,
        flight_area_m=(-5, -5, 5, 5),
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("up: z\n", "scene.yaml: up: unknown key; known: classes, "),
        ("up_axes: z\n", "scene.yaml: up_axes: unknown key; perhaps you meant 'up_axis'"),
        ("up_axis: x\n", "scene.yaml: up_axis: must be 'z' or 'y'"),
        ("unit_m: 0\n", "scene.yaml: unit_m: must be greater than or equal to 0.0001"),
        ("unit_m: true\n", "scene.yaml: unit_m: expected a number"),
        ("materials: {a: brick}\n", "scene.yaml: materials: a: unknown material 'brick'"),
        ("materials: {a: 5}\n", "scene.yaml: materials: a: 5 is neither a material"),
        (
            "materials: {a: {temperature_K: 300}}\n",
            "scene.yaml: materials: a: takes temperature_K and emissivity",
        ),
        (
            "materials: {a: {temperature_K: 300, emissivity: 1.2}}\n",
            "scene.yaml: materials: a: emissivity: must be less than or equal to 1",
        ),
        (
            "default_material: {temperature_K: 3000, emissivity: 1}\n",
            "scene.yaml: default_material: temperature_K: must be less than or equal to 420",
        ),
        ("classes: {a: wal}\n", "scene.yaml: classes: a: unknown class 'wal'; perhaps you meant 'wall'"),
        ("classes: {a: sky}\n", "scene.yaml: classes: a: unknown class 'sky'"),
        ("flight_area_m: [0, 0, 0, 9]\n", "scene.yaml: flight_area_m: takes west, south, east, north"),
        ("- 1\n", "scene.yaml:1: a recipe is a mapping"),
        ("a: &b 1\n", "scene.yaml:1: anchor"),
    ],
)
def test_a_mistake_is_one_line_with_file_and_key(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_sidecar(written(tmp_path, text))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_node_wins_over_its_mesh_and_a_mesh_over_its_material() -> None:
    sidecar = Sidecar(
        materials={"steel": "metal_galv_new", "tube": "metal_galv_weathered", "silo 2": "concrete_wall"},
        default_material="grass_dry",
        classes={"silo": Semantic.CHIMNEY},
    )
    barn, silo, other, plane = meanings(PARTS, sidecar, SCENE, Path("farm.yaml"))
    assert (barn.made_of, barn.semantic) == ("grass_dry", Semantic.GRASS)
    assert (silo.made_of, silo.semantic) == ("metal_galv_weathered", Semantic.CHIMNEY)
    assert (other.made_of, other.semantic) == ("concrete_wall", Semantic.WALL)
    assert plane.semantic == Semantic.GRASS


def test_parts_without_a_material_are_listed_once_in_one_line() -> None:
    with pytest.raises(InputError) as caught:
        meanings(PARTS, Sidecar(materials={"barn": "wood_siding"}), SCENE, None)
    assert str(caught.value) == (
        "farm.glb: no material for 'silo', 'silo 2', 'plane'; map them in farm.yaml under 'materials', "
        "or set 'default_material'"
    )
    many = tuple(Names(f"n{k}", "", "", k) for k in range(100))
    with pytest.raises(InputError, match=r"'n6', 'n7' and 92 more; map them in x.yaml"):
        meanings(many, Sidecar(), SCENE, Path("x.yaml"))


@pytest.mark.parametrize("section", ["materials", "classes"])
def test_a_name_that_nothing_goes_by_is_a_mistake(section: str) -> None:
    value = {"materials": "concrete_wall", "classes": Semantic.WALL}[section]
    sidecar = Sidecar.model_validate({section: {"bran": value}, "default_material": "soil_dry"})
    with pytest.raises(
        InputError, match=f"f.yaml: {section}: nothing in farm.glb is called 'bran'; perhaps you meant 'barn'"
    ):
        meanings(PARTS, sidecar, SCENE, Path("f.yaml"))
