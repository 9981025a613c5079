"""Splits: worlds never shared, held-out conditions in the test split only, however far a dataset grows."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenegen.climate.knobs import ClimateKnobs, draw_season, draw_weather_and_hour
from scenegen.foundation.errors import DatasetError, InputError, RejectedDrawError
from scenegen.foundation.rng import stream
from scenegen_datasets.job import ClipJob
from scenegen_datasets.lock import recipe_id
from scenegen_datasets.plan import plan, split_of
from scenegen_datasets.recipe import resolve_recipe
from scenegen_datasets.resolve import Source
from scenegen_datasets.splits.draw import draw_conditions, shows_held_out
from scenegen_datasets.splits.faults import split_faults, split_rule
from scenegen_datasets.splits.held_out import WEATHERS, HeldOut
from scenegen_datasets.versions.merge import merge

CLIMATE = ClimateKnobs()


def season(job: ClipJob, seed: int = 0) -> Any:
    return draw_season(CLIMATE, stream(seed, job.map, job.world, "season"))


def drawn(held_out: HeldOut, jobs: tuple[ClipJob, ...], seed: int = 0) -> list[tuple[ClipJob, str]]:
    """Every clip with what it shows that is held out."""
    found = []
    for job in jobs:
        weather, hour = draw_conditions(CLIMATE, held_out, season(job, seed), seed, job)
        found.append((job, held_out.condition(hour, vars(weather))))
    return found


def test_where_nothing_is_held_out_the_draw_is_the_one_it_always_was() -> None:
    for job in plan(["city", "field"], 3, 8, 200):
        rng = stream(7, "clip", job.map, job.world, job.clip, "weather")
        expected = draw_weather_and_hour(CLIMATE, season(job), rng)
        assert draw_conditions(CLIMATE, HeldOut(), season(job), 7, job) == expected


@pytest.mark.parametrize(
    "held_out",
    [
        HeldOut(hours=((0.0, 5.0),)),
        HeldOut(hours=((22.0, 4.0),)),
        HeldOut(weather=("overcast",)),
        HeldOut(hours=((11.5, 11.75),), weather=("windy", "clear")),
    ],
    ids=str,
)
def test_what_is_held_out_is_shown_by_every_other_test_clip_and_by_no_other(held_out: HeldOut) -> None:
    clips = drawn(held_out, plan(["city", "coastline"], 6, 1, 300))
    by_split = Counter((job.split, bool(seen)) for job, seen in clips)
    assert by_split["train", True] == by_split["val", True] == 0
    assert by_split["test", True] == by_split["test", False] > 10
    assert all(bool(seen) == shows_held_out(job) for job, seen in clips)


def test_a_draw_that_may_stay_stays() -> None:
    """Holding something out redraws only the clips that show it: the others keep weather and hour."""
    held_out = HeldOut(hours=((0.0, 5.0),))
    jobs = plan(["city"], 8, 1, 80)
    kept = sum(
        draw_conditions(CLIMATE, held_out, season(j), 0, j)
        == draw_conditions(CLIMATE, HeldOut(), season(j), 0, j)
        for j in jobs
    )
    assert 50 < kept < 80


def test_single_clips_of_test_worlds_take_turns_too() -> None:
    shown = [shows_held_out(job) for job in plan(["city"], 1, 1, 60) if job.split == "test"]
    assert shown == [True, False] * 3


def test_worlds_of_a_held_out_map_are_all_for_the_test_split() -> None:
    jobs = plan(["city", "field"], 2, 4, 400, ("field",))
    assert {job.split for job in jobs if job.map == "field"} == {"test"}
    assert [(j.map, j.world, j.clip) for j in jobs] == [
        (j.map, j.world, j.clip) for j in plan(["city", "field"], 2, 4, 400)
    ]
    assert all(job.split == split_of(job.world) for job in jobs if job.map == "city")
    assert plan(["city", "field"], 2, 4, 900, ("field",))[: len(jobs)] == jobs


@settings(deadline=None, max_examples=40)
@given(st.floats(0, 23.99), st.floats(0, 23.99), st.floats(0, 23.99))
def test_hours_over_midnight(first: float, last: float, hour: float) -> None:
    """Walking the clock from the first hour meets the hour before the last one."""
    held = bool(HeldOut(hours=((first, last),)).condition(hour, {}))
    assert held == ((hour - first) % 24.0 <= (last - first) % 24.0 or hour in (first, last))


def test_a_climate_that_hardly_offers_it_is_said_in_one_line() -> None:
    job = ClipJob(0, "city", 2, 0, "test", 4)
    with pytest.raises(RejectedDrawError, match=r"^city-00002-000: .*hold out wider hours"):
        draw_conditions(CLIMATE, HeldOut(hours=((3.0, 3.0),)), season(job), 0, job)


def test_kinds_of_sky_leave_no_gap_and_every_kind_occurs() -> None:
    skies = sorted(span[1:] for span in WEATHERS.values() if span[0] == "cloud_fraction")
    assert [low for low, _ in skies] == [0.0, *(high for _, high in skies[:-1])]
    days = [
        draw_weather_and_hour(CLIMATE, season(job), stream(1, job.clip, "w"))[0]
        for job in plan(["city"], 400, 1, 400)
    ]
    for name in WEATHERS:
        share = sum(bool(HeldOut(weather=(name,)).condition(0.0, vars(day))) for day in days) / len(days)
        assert 0.05 < share < 0.6, (name, share)


def resolved(**keys: Any) -> Any:
    return resolve_recipe([Source("r.yaml", keys)])


def test_identity_changes_with_what_is_held_out_and_only_then() -> None:
    base = recipe_id(resolved().canonical(), 3)
    assert "splits" not in resolved(splits={"test_maps": []}).canonical()
    others = [
        resolved(splits={"test_hours": [0, 5]}),
        resolved(splits={"test_hours": [5, 0]}),
        resolved(splits={"test_weather": "overcast"}),
        resolved(map=["city", "field"], splits={"test_maps": "field"}),
        resolved(map=["city", "field"]),
    ]
    ids = [recipe_id(one.canonical(), 3) for one in others]
    assert len({base, *ids}) == len(ids) + 1
    same = resolved(splits={"test_weather": ["windy", "clear", "windy"]})
    assert same == resolved(splits={"test_weather": ["clear", "windy"]})
    assert HeldOut.of_recipe(same.canonical()) == same.splits.held_out == HeldOut(weather=("clear", "windy"))


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"splits": {"test_maps": "field"}}, "no map 'field'"),
        ({"splits": {"test_maps": "city"}}, "nothing would be left to train on"),
        ({"splits": {"test_hours": [25, 3]}}, "r.yaml: splits.test_hours"),
        ({"splits": {"test_hours": 3}}, "r.yaml: splits.test_hours"),
        ({"splits": {"test_weather": "overcsat"}}, "perhaps you meant 'overcast'"),
        ({"splits": {"test_wether": "overcast"}}, "perhaps you meant 'test_weather'"),
        ({"splits": {"test_weather": ["clear", "cloudy", "overcast"]}}, "nothing would be left"),
        ({"splits": {"test_hours": [0, 5]}, "climate": {"hour": [10, 14]}}, "is never drawn"),
        ({"splits": {"test_hours": [0, 5]}, "climate": {"hour": 3}}, "nothing would be left to train on"),
        (
            {"splits": {"test_weather": "windy"}, "climate": {"wind_mps": [0, 4]}},
            "windy: is never drawn .climate.wind_mps is 0 to 4",
        ),
        ({"splits": {"test_weather": "clear"}, "climate": {"cloud_fraction": 0.1}}, "nothing would be left"),
    ],
)
def test_what_cannot_be_split_so_is_refused(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        resolved(**keys)
    assert "\n" not in str(caught.value)


def test_faults_are_found_and_named(fakes: ModuleType) -> None:
    """Six clips of worlds 0 (train), 1 (val), 2 (test), at hours 0, 5.5, 11, 16.5, 22, 3.5."""
    records = [fakes.record(job) for job in fakes.jobs(6)]
    plain = {"recipe": {"map": ["city"]}}
    assert list(split_faults(plain, {}, records)) == []
    assert list(split_faults(plain, {"split_rule": split_rule(plain)}, records)) == []
    night = {"recipe": {"map": ["city"], "splits": {"test_hours": [16, 4], "test_weather": []}}}
    faults = dict(split_faults(night, {"split_rule": split_rule(plain)}, records))
    assert set(faults) == {
        "dataset.json",
        "receipts/train/city-00000/000.json",
        "receipts/val/city-00001/001.json",
    }
    assert "hour 16.50 (16 to 4 is held out)" in faults["receipts/val/city-00001/001.json"]
    held = {"recipe": {"splits": {"test_maps": ["city"]}}}
    assert len(list(split_faults(held, {}, records))) == 4
    moved = replace(records[0], job=replace(records[0].job, split="test"))
    assert list(split_faults(plain, {}, [moved])) == [
        ("receipts/test/city-00000/000.json", "is in split test, world 0 of city belongs to train")
    ]


def test_a_merged_dataset_keeps_what_any_part_holds_out() -> None:
    parts = [
        {"recipe": {"splits": {"test_hours": [0, 5]}}},
        {"recipe": {"splits": {"test_maps": ["field"], "test_hours": [20, 22]}}},
        {"recipe": {}},
    ]
    assert HeldOut.of_lock({"recipe": {}, "parts": parts}) == HeldOut(
        maps=("field",), hours=((0.0, 5.0), (20.0, 22.0))
    )


def test_a_sensed_dataset_keeps_what_its_source_holds_out() -> None:
    merged = {"recipe": {}, "parts": [{"recipe": {"splits": {"test_hours": [0, 5]}}}, {"recipe": {}}]}
    sensed = {"recipe": {"sensed": {}}, "source": merged}
    assert HeldOut.of_lock(sensed) == HeldOut.of_lock({"recipe": {}, "parts": [sensed]})
    assert HeldOut.of_lock(sensed) == HeldOut(hours=((0.0, 5.0),))


@pytest.mark.parametrize(
    "lock", [{}, {"recipe": 3}, {"parts": [3]}, {"parts": {"a": 1}}, {"source": {}}], ids=str
)
def test_a_lock_that_makes_no_sense_is_refused(lock: dict[str, Any]) -> None:
    with pytest.raises(DatasetError, match=r"recipe\.lock\.json"):
        HeldOut.of_lock(lock)


def test_what_is_held_out_is_told_in_words() -> None:
    held = HeldOut(("field",), ((22.0, 4.5),), ("calm", "overcast", "cloudy"))
    assert HeldOut.of_statement(held.statement()) == held
    assert held.words == (
        "map `field`: all of its worlds are for test",
        "hours 22 to 4.5, in local mean solar time",
        "calm weather: `wind_mps` from 0 to below 1.6",
        "overcast weather: `cloud_fraction` 0.95 or more",
        "cloudy weather: `cloud_fraction` from 0.25 to below 0.95",
    )
    assert HeldOut().words == ()


def test_the_card_states_what_is_held_out(fakes: ModuleType, make_map: Any, tmp_path: Path) -> None:
    plain = make_map(tmp_path / "plain", "city", 2)
    said = (plain / "README.md").read_text(encoding="utf-8")
    assert "of every 10 worlds of a map, number 1 is for validation, number 2 for test" in said
    assert "of all splits are drawn alike" in said and "Held out" not in said
    night = make_map(
        tmp_path / "night", "field", 2, splits={"test_hours": [20, 23], "test_weather": ["windy"]}
    )
    said = (night / "README.md").read_text(encoding="utf-8")
    assert "* hours 20 to 23, in local mean solar time\n* windy weather: `wind_mps` 5.5 or more\n" in said
    merge(tmp_path / "all", [plain, night])
    said = (tmp_path / "all" / "README.md").read_text(encoding="utf-8")
    assert "* hours 20 to 23" in said and "| plain | 1.0.0 | 6 | city 0 |" in said
