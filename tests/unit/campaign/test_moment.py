"""When batches fly if the recipe keeps hours and weather for testing: in usual ones, unless others are chosen."""

from pathlib import Path
from typing import Any

import pytest

from scenegen.climate.season import Season
from scenegen.foundation.canonical import pretty
from scenegen.foundation.errors import InputError
from scenegen_datasets.lock import make_lock
from scenegen_datasets.recipe import SCENE_SEMANTICS
from scenegen_datasets.resolve import Source
from scenegen_trainers.campaign.moment import draw_moment
from scenegen_trainers.campaign.plan import batches
from scenegen_trainers.campaign.recipe import FlightRecipe, resolve_flights
from scenegen_trainers.tables.table2_recipe import flight_recipe

SEASON = Season(50.0, 7, 15)
SPLITS = {"test_hours": [20.0, 5.0], "test_weather": ["overcast"]}


def resolve(**keys: Any) -> FlightRecipe:
    return resolve_flights([Source("", keys)])


def shown(recipe: FlightRecipe) -> list[str]:
    """What each of 16 batches shows of what the recipe holds out."""
    held = recipe.dataset.splits.held_out
    moments = [draw_moment(recipe, SEASON, batch) for batch in batches("city", 400, recipe.campaign)]
    return [held.condition(moment.hour, vars(moment.weather)) for moment in moments]


def test_what_is_held_out_is_flown_in_only_if_that_is_chosen() -> None:
    usual = resolve(splits=SPLITS)
    assert usual.campaign.conditions == "usual"
    assert shown(usual) == [""] * 16
    assert all(shown(resolve(splits=SPLITS, campaign={"conditions": "held_out"})))
    some = shown(resolve(splits=SPLITS, campaign={"conditions": "any"}))
    assert 0 < sum(map(bool, some)) < 16


def test_any_conditions_are_those_of_a_recipe_that_holds_nothing_out() -> None:
    plain, anything = resolve(), resolve(splits=SPLITS, campaign={"conditions": "any"})
    for batch in batches("city", 200, plain.campaign):
        assert draw_moment(plain, SEASON, batch) == draw_moment(anything, SEASON, batch)
    assert plain.canonical() == anything.canonical(), "one campaign"


def test_hours_that_were_asked_for_stand_and_weather_is_still_chosen() -> None:
    recipe = resolve(splits=SPLITS, campaign={"hours": [22.0]})
    for batch in batches("city", 200, recipe.campaign):
        moment = draw_moment(recipe, SEASON, batch)
        assert moment.hour == 22.0 and moment.weather.cloud_fraction < 0.95


def test_a_campaign_knows_what_it_held_out() -> None:
    plain, usual = resolve().canonical(), resolve(splits=SPLITS).canonical()
    held = resolve(splits=SPLITS, campaign={"conditions": "held_out"}).canonical()
    assert "conditions" not in plain["campaign"] and "splits" not in plain, "as before there were such keys"
    assert usual["splits"] == held["splits"] and usual["splits"]["test_hours"] == [20.0, 5.0]
    assert [usual["campaign"]["conditions"], held["campaign"]["conditions"]] == ["usual", "held_out"]
    assert resolve(splits={"test_maps": ["city"]}, map=["city", "field"]).canonical() == (
        resolve(map=["city", "field"]).canonical()
    ), "which maps are held out decides no flight"


def test_held_out_conditions_of_a_recipe_without_any_are_refused() -> None:
    for keys in ({}, {"map": ["city", "field"], "splits": {"test_maps": ["city"]}}):
        with pytest.raises(InputError, match="holds out neither hours nor weather; say which with"):
            resolve(**keys, campaign={"conditions": "held_out"})


def test_a_dataset_brings_what_it_holds_out_into_table_2(tmp_path: Path) -> None:
    """Also a merged one, a sensed one, and a later piece of a plan, whose locks say so in their recipes."""
    keys = {"seed": 3, "first_world": 10, "merged": ["a"], "sensed": {"side_px": 1}, "pairs": 4}
    held = {**SPLITS, "test_maps": ["yard"]}
    lock = make_lock({**keys, "splits": held}, name="d", scene_semantics=SCENE_SEMANTICS, render={})
    (tmp_path / "recipe.lock.json").write_bytes(pretty(lock))
    recipe = flight_recipe([], None, tmp_path)
    assert recipe.dataset.seed == 3 and recipe.dataset.splits.test_maps == ()
    assert shown(recipe) == [""] * 16
    chosen = Source("", {"campaign": {"conditions": "held_out"}})
    assert all(shown(flight_recipe([chosen], None, tmp_path)))
