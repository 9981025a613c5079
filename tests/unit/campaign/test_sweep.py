"""What may be swept, and what not."""

import pytest

from scenegen.foundation.errors import InputError
from scenegen_datasets.resolve import Source
from scenegen_trainers.campaign.recipe import resolve_flights
from scenegen_trainers.campaign.sweep import AXES, WEATHERS, parse_sweep


def test_axes_take_turns() -> None:
    points = parse_sweep(["speed=3,6", "loop.drone.jerk_mps3=30,60", "weather=fog"])
    assert [point.name for point in points] == [
        "speed=3", "speed=6", "loop.drone.jerk_mps3=30", "loop.drone.jerk_mps3=60", "weather=fog",
    ]  # fmt: skip
    assert points[0].keys == {"loop": {"cruise_mps": 3}}
    assert points[2].keys == {"loop": {"drone": {"jerk_mps3": 30}}}
    assert points[4].number is None


@pytest.mark.parametrize("axis", AXES)
def test_every_short_name_is_a_key_of_the_recipe(axis: str) -> None:
    (point,) = parse_sweep([f"{axis}=0.5" if axis in ("cloud", "difficulty") else f"{axis}=12"])
    resolve_flights([Source("", point.keys)])


@pytest.mark.parametrize("weather", WEATHERS)
def test_every_weather_is_one_the_climate_knows(weather: str) -> None:
    (point,) = parse_sweep([f"weather={weather}"])
    assert resolve_flights([Source("", point.keys)]).dataset.climate.visibility_km is not None


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("speed", "write KEY=VALUE,VALUE"),
        ("speed=", "write KEY=VALUE,VALUE"),
        ("sped=3", "perhaps you meant 'speed'"),
        ("weather=rain", "unknown weather"),
        ("campaign.flights_per_batch=3", "cannot be swept"),
        ("speed=3,3", "given twice"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(word: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        parse_sweep([word])
