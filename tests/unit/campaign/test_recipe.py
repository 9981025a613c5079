"""Recipes of campaigns: two rooms' keys side by side, one line for whatever is wrong."""

import pytest

import flown
from scenegen.foundation.errors import InputError
from scenegen.maps.registry import MAPS
from scenegen_datasets.resolve import Source
from scenegen_trainers.campaign import recipe as module
from scenegen_trainers.campaign.recipe import flight_keys, resolve_flights


def resolve(**keys: object) -> module.FlightRecipe:
    return resolve_flights([Source("", keys)])


def test_keys_of_both_rooms_arrive() -> None:
    recipe = resolve(seed=3, map="coastline", sensor={"netd_mk": 20.0}, loop={"radius_m": 0.5})
    assert (recipe.dataset.seed, recipe.dataset.map) == (3, ("coastline",))
    assert (recipe.dataset.sensor.netd_mk, recipe.loop.radius_m) == (20.0, 0.5)


def test_a_map_has_its_own_difficulty_unless_one_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "DIFFICULTY", {"city": 0.25, "field": 0.75})
    recipe = resolve(map=["city", "field", "coastline"])
    usual = module.FlightSections().mission.difficulty
    assert [recipe.missions[m].difficulty for m in ("city", "field", "coastline")] == [0.25, 0.75, usual]
    asked = resolve(map=["city", "field"], mission={"difficulty": 0.5, "distance_m": 70.0})
    assert {(k.difficulty, k.distance_m) for k in asked.missions.values()} == {(0.5, 70.0)}


def test_every_map_has_a_difficulty_fixed_for_it() -> None:
    assert set(module.DIFFICULTY) == set(MAPS)


def test_a_drone_is_as_fast_as_it_is_to_cruise() -> None:
    assert resolve(loop={"cruise_mps": 20.0}).loop.drone.speed_mps == 20.0
    assert resolve(loop={"cruise_mps": 3.0}).loop.drone.speed_mps == flown.recipe().loop.drone.speed_mps
    with pytest.raises(InputError, match=r"drone\.speed_mps 5"):
        resolve(loop={"cruise_mps": 9.0, "drone": {"speed_mps": 5.0}})


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"loop": {"radus_m": 1.0}}, "--loop.radus_m: unknown key; perhaps you meant 'radius_m'"),
        ({"loop": {"radius_m": 9.0}}, "--loop.radius_m"),
        ({"mission": 3}, "--mission: has keys of its own"),
        ({"campaign": {"hours": [25.0]}}, "--campaign.hours"),
        ({"lop": {}}, "--lop: unknown key"),
        ({"map": "citty"}, "perhaps you meant 'city'"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(keys: dict[str, object], said: str) -> None:
    with pytest.raises(InputError) as caught:
        resolve(**keys)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_decides_no_flight_is_not_part_of_the_recipe() -> None:
    usual = flown.recipe().canonical()
    assert flown.recipe(pairs_per_clip=3, clips_per_world=2).canonical() == usual
    assert flown.recipe(seed=1).canonical() != usual
    assert flown.recipe(loop={"wind": {"mean_mps": 1.0}}).canonical() != usual


def test_a_recipe_survives_the_way_to_a_worker() -> None:
    recipe = flown.recipe(map=["city", "field"], campaign={"hours": 4.0})
    again = module.FlightRecipe.model_validate(recipe.model_dump(mode="json"))
    assert again == recipe
    assert recipe.campaign.hours == (4.0,)


def test_every_key_of_the_loop_says_what_it_means() -> None:
    keys = list(flight_keys())
    assert {"loop.radius_m", "mission.difficulty", "campaign.split"} <= {key for key, _, _ in keys}
    assert all(meaning for _, meaning, _ in keys)
