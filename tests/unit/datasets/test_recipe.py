"""Composing a recipe: who wins, what is refused, what its identity holds."""

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen.foundation.canonical import canonical
from scenegen.foundation.errors import InputError
from scenegen.foundation.strict_yaml import parse_mapping, read_mapping
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.lock import recipe_id
from scenegen_datasets.recipe import Recipe, resolve_recipe, settle_pairs
from scenegen_datasets.resolve import Source, leaves, merge

RECIPES = Path(__file__).parents[3] / "recipes"
KEYS = [key for key, _, _ in leaves(Recipe)]


def nested(dotted: str, value: Any) -> dict[str, Any]:
    """``a.b`` and a value as {"a": {"b": value}}."""
    head, _, rest = dotted.partition(".")
    return {head: nested(rest, value) if rest else value}


def test_flags_win_over_the_file_and_the_file_over_the_preset() -> None:
    file = Source("r.yaml", {"camera": {"preset": "boson640", "hfov_deg": 32}, "seed": 3})
    recipe = resolve_recipe([file, Source("", {"camera": {"width_px": 320}, "seed": 4})])
    assert (recipe.seed, recipe.camera.width_px, recipe.camera.height_px) == (4, 320, 512)
    assert (recipe.camera.hfov_deg, recipe.camera.band_um) == (32, (7.5, 13.5))
    assert recipe.sensor.time_constant_ms == 8.0


def test_a_preset_on_the_command_line_goes_below_the_file() -> None:
    file = Source("r.yaml", {"camera": {"hfov_deg": 32}})
    recipe = resolve_recipe([file, Source("", {"camera": {"preset": "lepton35"}})])
    assert (recipe.camera.width_px, recipe.camera.hfov_deg) == (160, 32)


def test_every_key_has_a_meaning() -> None:
    assert len(KEYS) > 40
    assert [key for key, meaning, _ in leaves(Recipe) if len(meaning) < 8] == []


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e308, {"a": 1}, [[1]]], ids=repr)
def test_no_key_takes_nonsense(key: str, value: Any) -> None:
    with pytest.raises(InputError) as caught:
        resolve_recipe([Source("r.yaml", nested(key, value))])
    assert str(caught.value).startswith(f"r.yaml: {key.split('.')[0]}") or key == "camera.preset"
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "key", [k for k, _, d in leaves(Recipe) if isinstance(d, int | float) and not isinstance(d, bool)]
)
@pytest.mark.parametrize("value", [True, "300", None, -1e9])
def test_a_number_is_a_number(key: str, value: Any) -> None:
    with pytest.raises(InputError, match=key.rpartition(".")[2]):
        resolve_recipe([Source("r.yaml", nested(key, value))])


@settings(deadline=None)
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5), st.lists, max_leaves=4
    )
)
def test_any_value_is_taken_or_refused_in_one_line(value: Any) -> None:
    for key in ("seed", "map", "climate.hour", "sensor.netd_mk", "camera", "layers"):
        try:
            resolve_recipe([Source("r.yaml", nested(key, value))])
        except InputError as error:
            assert "\n" not in str(error)


def test_errors_name_the_source_that_set_the_key() -> None:
    file, flags = Source("r.yaml", {"sensor": {"netd_mk": -1}}), Source("", {"sensor": {"netd_mk": -2}})
    with pytest.raises(
        InputError, match=r"^r.yaml: sensor.netd_mk: must be greater than or equal to 0, not -1$"
    ):
        resolve_recipe([file])
    with pytest.raises(InputError, match=r"^--sensor.netd_mk: must be greater than or equal to 0, not -2$"):
        resolve_recipe([file, flags])


@pytest.mark.parametrize(("given", "shown"), [("x", "'x'"), ([1, 2, 3], "3 values"), (True, "True")])
def test_what_is_no_range_is_told_what_a_range_is(given: object, shown: str) -> None:
    with pytest.raises(
        InputError, match=f"^--climate.hour: expected a number, or two for a range, not {shown}$"
    ):
        resolve_recipe([Source("", {"climate": {"hour": given}})])


def test_unknown_keys_get_the_nearest_right_one() -> None:
    for asked, right in [
        ({"sensor": {"netdmk": 1}}, "netd_mk"),
        ({"sedd": 1}, "seed"),
        ({"netd_mk": 1}, "sensor.netd_mk"),
    ]:
        with pytest.raises(InputError, match=f"unknown key; perhaps you meant '{right}'"):
            resolve_recipe([Source("r.yaml", asked)])


def test_identity_holds_what_decides_samples_and_nothing_else() -> None:
    base = resolve_recipe([])
    assert recipe_id(base.canonical(), 1) == recipe_id({**base.canonical(), "pairs": 9}, 1)
    assert "city" in base.canonical()
    for key, value in [
        ("seed", 1),
        ("sensor.netd_mk", 51),
        ("climate.hour", 3),
        ("city.storeys", [2, 3]),
        ("layers", ["depth", "thermal"]),
    ]:
        other = resolve_recipe([Source("r.yaml", nested(key, value))])
        assert recipe_id(other.canonical(), 1) != recipe_id(base.canonical(), 1)
    defaults = {"map": "city", "climate": {"latitude_deg": [-60, 65.0]}, "layers": [*DEFAULT_LAYERS]}
    same = resolve_recipe([Source("r.yaml", defaults)])
    assert canonical(same.canonical()) == canonical(base.canonical())


def test_a_recipe_survives_its_own_canonical_form() -> None:
    recipe = resolve_recipe([Source("", {"camera": {"preset": "tau640"}, "climate": {"hour": [1, 2]}})])
    assert Recipe.model_validate(recipe.canonical()) == recipe


def test_layers_and_render_keys_agree() -> None:
    asked = resolve_recipe([Source("", {"layers": ["normal", "depth", "thermal", "flow_back"]})])
    assert asked.layers == ("thermal", "depth", "flow_back", "normal")
    assert (asked.tracing.normals, asked.tracing.backward_flow) == (True, True)
    switched = resolve_recipe([Source("", {"render": {"normals": True}})])
    assert "normal" in switched.stored_layers
    assert "flow_back" not in switched.stored_layers


def test_pairs_are_rounded_up_and_short_jobs_shorten_the_clip() -> None:
    recipe = resolve_recipe([])
    assert settle_pairs(recipe, 8000) == (recipe, 8000)
    assert settle_pairs(recipe, 65) == (recipe, 128)
    short, pairs = settle_pairs(recipe, 8)
    assert (short.pairs_per_clip, pairs) == (8, 8)
    for wrong in (0, -1, 10**9):
        with pytest.raises(InputError):
            settle_pairs(recipe, wrong)


def test_worlds_beyond_the_largest_number_are_refused() -> None:
    recipe = resolve_recipe([Source("", {"first_world": 99_999})])
    assert settle_pairs(recipe, 512) == (recipe, 512)
    with pytest.raises(InputError, match=r"576 pairs need worlds up to number 100,000, .*--clips-per-world"):
        settle_pairs(recipe, 513)
    with pytest.raises(InputError, match="need worlds up to number 124,999"):
        settle_pairs(resolve_recipe([]), 64_000_000)
    with pytest.raises(
        InputError, match=r"2,000,000 pairs are 2,000,000 clips of 1, .* raise --pairs-per-clip"
    ):
        settle_pairs(resolve_recipe([Source("", {"pairs_per_clip": 1})]), 2_000_000)


def test_the_first_world_is_part_of_a_recipe_if_it_is_not_the_first() -> None:
    assert "first_world" not in resolve_recipe([]).canonical()
    later = resolve_recipe([Source("", {"first_world": 100})])
    assert later.canonical()["first_world"] == 100
    assert Recipe.model_validate(later.canonical()) == later


def test_merge_is_key_by_key() -> None:
    assert merge([{"a": {"b": 1, "c": 2}}, {"a": {"b": 3}}, {"d": [1]}]) == {"a": {"b": 3, "c": 2}, "d": [1]}
    assert merge([{"a": 1}, {"a": {"b": 2}}, {"a": 4}]) == {"a": 4}


@pytest.mark.parametrize("path", sorted(RECIPES.glob("*.yaml")), ids=lambda p: p.stem)
def test_the_recipes_of_the_project_are_sound(path: Path) -> None:
    assert path.read_text(encoding="utf-8").startswith("#")
    resolve_recipe([Source(path.name, read_mapping(path))])


def test_movers_off_freezes_the_world_and_is_another_recipe():
    frozen = Recipe.model_validate(parse_mapping("movers: off", "recipe.yaml"))
    assert Recipe().movers and not frozen.movers
    assert canonical(frozen.canonical()) != canonical(Recipe().canonical())
