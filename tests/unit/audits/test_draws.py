"""What was drawn against what was asked, of clips written by hand."""

from typing import Any

import numpy as np
import pytest

from scenegen_datasets.audits.draws import Draw, Draws, audit_draws, evenness

RECIPE: dict[str, Any] = {
    "map": ["city", "field"],
    "climate": {"hour": [6.0, 18.0], "latitude_deg": [-60.0, 65.0], "date": None, "wind_mps": 3.0},
    "flight": {"speed_mps": [3.0, 15.0], "clearance_m": 1.0, "styles": ["explore", "explore", "orbit"]},
}


def clip(k: int, **changed: Any) -> dict[str, Any]:
    """Clip `k` of 40: four to a world, everything evenly spread."""
    world = k // 4
    return {
        "job": {"map": ("city", "field")[world % 2], "world": world, "split": "train", "pairs": 8},
        "hour": 6.0 + 12.0 * (k + 0.5) / 40,
        "latitude_deg": -60.0 + 125.0 * (world + 0.5) / 10,
        "month": 1 + world,
        "day": 15,
        "sun_elevation_deg": 10.0,
        "speed_mps": 2.0 + k / 4,
        "clearance_m": 1.5,
        "rejected": 2,
        "weather": {
            "air_mean_K": 283.15,
            "air_amplitude_K": 5.0,
            "dew_point_K": 276.15,
            "wind_mps": 3.0,
            "cloud_fraction": 0.5,
            "visibility_km": 20.0,
        },
        "extra": {"style": "explore" if k % 2 else "orbit"},
    } | changed


def draws(found: Draws) -> dict[str, Draw]:
    return {draw.name: draw for draw in found.draws}


def test_what_was_asked_for_is_fine() -> None:
    found = audit_draws((clip(k) for k in range(40)), RECIPE)
    assert found.verdict.level == "fine"
    assert (found.clips, found.worlds, found.rejected) == (40, 10, 80)
    hour = draws(found)["hour"]
    assert hour.asked == (6.0, 18.0) and hour.explicit and hour.count == 40 and hour.outside == 0
    assert hour.covered == pytest.approx(39 / 40)
    assert hour.histogram.edges[0] == 6.0 and sum(hour.histogram.counts) == 40
    assert draws(found)["latitude_deg"].count == 10  # once per world
    assert draws(found)["dew_point_depression_K"].median == pytest.approx(283.15 - 5.0 - 276.15)
    assert draws(found)["day_of_year"].low == 15.0


def test_a_draw_outside_is_a_fault_and_named() -> None:
    found = audit_draws([clip(k) for k in range(39)] + [clip(39, hour=20.0)], RECIPE)
    assert found.verdict.level == "fault"
    assert "hour (1 of 40)" in found.verdict.words
    assert draws(found)["hour"].outside == 1


def test_a_fixed_value_holds_every_clip_to_it() -> None:
    weather = clip(0)["weather"] | {"wind_mps": 3.1}
    found = draws(audit_draws([clip(0), clip(1, weather=weather)], RECIPE))["wind_mps"]
    assert found.asked == (3.0, 3.0) and found.outside == 1


def test_bends_slow_a_flight_down_and_only_slopes_speed_it_up() -> None:
    slow = draws(audit_draws([clip(0, speed_mps=1.0)], RECIPE))["speed_mps"]
    climbing = draws(audit_draws([clip(0, speed_mps=15.5)], RECIPE))[
        "speed_mps"
    ]  # 15 m/s up a slope of 15 deg
    fast = draws(audit_draws([clip(0, speed_mps=15.7)], RECIPE))["speed_mps"]
    assert (slow.outside, climbing.outside, fast.outside) == (0, 0, 1)


def test_draws_that_crowd_are_noted() -> None:
    found = audit_draws((clip(k, hour=6.0 + k / 40) for k in range(40)), RECIPE)
    assert found.verdict.level == "note" and "hour" in found.verdict.words


def test_what_the_test_split_keeps_for_itself_is_not_called_uneven() -> None:
    held = RECIPE | {"splits": {"test_hours": [7.0, 18.0], "test_maps": ["field"]}}
    found = audit_draws([clip(k, hour=6.0 + k / 40) for k in range(40)], held)
    assert found.verdict.level == "fine" and draws(found)["hour"].chance is None
    assert draws(found)["latitude_deg"].chance is not None
    assert found.tallies[1].asked == {} and found.tallies[1].counts["train"] == 320


def test_tallies_stand_beside_what_was_asked() -> None:
    maps, splits, styles = audit_draws((clip(k) for k in range(40)), RECIPE).tallies
    assert maps.counts == {"city": 160, "field": 160} and maps.asked == {"city": 0.5, "field": 0.5}
    assert splits.counts == {"train": 320, "val": 0, "test": 0}
    assert styles.asked == {"explore": pytest.approx(2 / 3), "orbit": pytest.approx(1 / 3)}


def test_what_a_clip_does_not_record_is_left_out() -> None:
    weather = {name: value for name, value in clip(0)["weather"].items() if name != "visibility_km"}
    found = draws(audit_draws([clip(0, weather=weather)], RECIPE))
    assert "visibility_km" not in found and "wind_mps" in found


def test_nothing_yet() -> None:
    assert audit_draws([], RECIPE).verdict.level == "skipped"


def test_evenness_is_the_level_of_the_test() -> None:
    rng = np.random.default_rng(11)
    chances = np.array([evenness(rng.uniform(size=12)) for _ in range(2000)])
    # Under evenness the chance itself is evenly spread: 5 % of sound datasets lie below 5 %.
    assert np.mean(chances < 0.05) == pytest.approx(0.05, abs=0.02)
    assert evenness(rng.uniform(size=300) ** 2) < 1e-6
