"""Drawing climate: bounds, messages, independence of the draws, plausible weather."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest
from pydantic import ValidationError

from scenegen.climate.knobs import ClimateKnobs, draw_season, draw_weather_and_hour
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream


def _drawn(knobs: ClimateKnobs, seed: int) -> dict[str, float]:
    season = draw_season(knobs, stream(seed, "season"))
    weather, hour = draw_weather_and_hour(knobs, season, stream(seed, "weather"))
    return {**asdict(season), **asdict(weather), "hour": hour}


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("hour", 25, "hour must be at least 0 and below 24 h, got 25"),
        ("hour", 24, "hour must be at least 0 and below 24 h, got 24"),
        ("hour", -1, "hour must be at least 0 and below 24 h, got -1"),
        ("hour", [6, 24], "hour must be at least 0 and below 24 h, got 24"),
        ("latitude_deg", 91, "latitude_deg must be at least -90 and at most 90 deg, got 91"),
        ("date", "02-30", "date must be MM-DD in an ordinary year, such as 07-15, got '02-30'"),
        ("date", "02-29", "got '02-29'"),
        ("date", "July", "got 'July'"),
        ("wind_mps", [5, 2], "the range [5, 2] is upside down"),
        ("cloud_fraction", 1.5, "cloud_fraction must be at least 0 and at most 1, got 1.5"),
        ("air_mean_C", 300, "air_mean_C must be at least -60 and at most 50 C, got 300"),
        ("linke_turbidity", 0, "linke_turbidity must be at least 1.5 and at most 10, got 0"),
    ],
)
def test_bad_values_are_refused_in_one_clear_line(key, value, message):
    with pytest.raises(ValidationError) as caught:
        ClimateKnobs.model_validate({key: value})
    assert message in caught.value.errors()[0]["msg"]


@pytest.mark.parametrize("key", ["hour", "wind_mps", "latitude_deg", "sky_optical_depth_factor"])
@pytest.mark.parametrize("value", [float("nan"), float("inf"), True, "warm", [1, 2, 3]])
def test_nonsense_is_refused(key, value):
    with pytest.raises(ValidationError):
        ClimateKnobs.model_validate({key: value})


def test_unknown_keys_are_refused():
    with pytest.raises(ValidationError):
        ClimateKnobs.model_validate({"windspeed": 3})


FIXED = {
    "latitude_deg": ({"latitude_deg": 12.0}, {"latitude_deg"}),
    "hour": ({"hour": 3.0}, {"hour"}),
    "air_amplitude_K": ({"air_amplitude_K": 5.0}, {"air_amplitude_K", "dew_point_K"}),
    "dew_point_depression_K": ({"dew_point_depression_K": 5.0}, {"dew_point_K"}),
    "air_mean_C": ({"air_mean_C": 5.0}, {"air_mean_K", "dew_point_K"}),
    "air_peak_hour": ({"air_peak_hour": 14.2}, {"air_peak_hour"}),
    "wind_mps": ({"wind_mps": 5.0}, {"wind_mps"}),
    "cloud_fraction": ({"cloud_fraction": 0.4}, {"cloud_fraction"}),
    "linke_turbidity": ({"linke_turbidity": 3.3}, {"linke_turbidity"}),
    "visibility_km": ({"visibility_km": 12.0}, {"visibility_km"}),
    "sky_optical_depth_factor": ({"sky_optical_depth_factor": 1.0}, {"sky_optical_depth_factor"}),
}


@pytest.mark.parametrize("name", FIXED)
def test_fixing_one_key_moves_nothing_else(name):
    """The dew point is defined below the day's lowest temperature, so it alone follows mean and amplitude."""
    change, may_move = FIXED[name]
    season = {"latitude_deg", "month", "day"}
    for seed in range(5):
        free, fixed = _drawn(ClimateKnobs(), seed), _drawn(ClimateKnobs.model_validate(change), seed)
        moved = {key for key in free if free[key] != fixed[key]}
        if name == "latitude_deg":  # the climatology follows the place; the place's date must not move
            assert moved & season == {"latitude_deg"}
            assert "hour" not in moved
        else:
            assert moved <= may_move
            assert moved


def test_fixing_the_date_keeps_the_latitude_and_the_hour():
    free, fixed = _drawn(ClimateKnobs(), 3), _drawn(ClimateKnobs(date="7-15"), 3)
    assert (fixed["month"], fixed["day"]) == (7, 15)
    assert fixed["latitude_deg"] == free["latitude_deg"]
    assert fixed["hour"] == free["hour"]


def test_ranges_are_drawn_from():
    hours = [_drawn(ClimateKnobs(hour=(20.0, 22.0)), seed)["hour"] for seed in range(40)]
    assert 20.0 <= min(hours) < 20.5
    assert 21.5 < max(hours) <= 22.0


def test_a_single_number_means_that_value():
    drawn = _drawn(ClimateKnobs.model_validate({"hour": 14, "wind_mps": 3, "air_mean_C": 24.5}), 0)
    assert drawn["hour"] == 14.0
    assert drawn["wind_mps"] == 3.0
    assert drawn["air_mean_K"] == pytest.approx(297.65)


def test_same_seed_same_weather():
    assert _drawn(ClimateKnobs(), 11) == _drawn(ClimateKnobs(), 11)


def test_weather_is_plausible_everywhere_and_always():
    hours = []
    for seed in range(600):
        w = _drawn(ClimateKnobs(), seed)
        hours.append(w["hour"])
        lowest, highest = w["air_mean_K"] - w["air_amplitude_K"], w["air_mean_K"] + w["air_amplitude_K"]
        assert w["dew_point_K"] <= lowest
        assert lowest > 215.0
        assert highest < 322.0
        assert 0.0 <= w["cloud_fraction"] <= 1.0
        assert 1.0 <= w["wind_mps"] <= 12.0
        assert 1.8 <= w["linke_turbidity"] <= 6.5
    share, _ = np.histogram(hours, bins=6, range=(0.0, 24.0))
    assert share.min() > 60  # the whole day, evenly
    assert max(hours) < 24.0


@pytest.mark.parametrize(
    ("season", "low_C", "high_C"),
    [
        (Season(70.0, 1, 15), -42.0, -8.0),
        (Season(60.0, 7, 15), 6.0, 27.0),
        (Season(40.0, 7, 15), 15.0, 36.0),
        (Season(40.0, 1, 15), -8.0, 15.0),
        (Season(0.0, 4, 1), 21.0, 32.0),
        (Season(-40.0, 7, 15), -4.0, 19.0),
    ],
)
def test_daily_means_of_known_places(season, low_C, high_C):
    means = [
        draw_weather_and_hour(ClimateKnobs(), season, stream(seed, "w"))[0].air_mean_K - 273.15
        for seed in range(200)
    ]
    assert low_C < min(means)
    assert max(means) < high_C


def test_seasons_cover_the_year_and_never_leave_it():
    days = [draw_season(ClimateKnobs(), stream(seed, "s")).day_of_year for seed in range(800)]
    assert min(days) >= 1
    assert max(days) <= 365
    assert len(set(days)) > 250
    assert Season.from_day_of_year(10.0, 365) == Season(10.0, 12, 31)
    assert Season(0.0, 3, 1).day_of_year == 60
