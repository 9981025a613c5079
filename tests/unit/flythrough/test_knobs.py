"""What a recipe may ask of flights, and what it is told when it asks for too much."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from scenegen_flythrough.knobs import FlightKnobs


def test_defaults_hold_their_own_bounds() -> None:
    knobs = FlightKnobs()
    assert FlightKnobs.model_validate(knobs.model_dump()) == knobs
    assert knobs.spacing_m == 1.0


def test_one_number_is_a_range_of_itself() -> None:
    assert FlightKnobs.model_validate({"height_m": 6}).height_m == (6.0, 6.0)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("speed_mps", (3, 22.3), "at most 22.2"),
        ("speed_mps", 0, "above 0"),
        ("speed_mps", -1, "above 0"),
        ("speed_mps", (9, 3), "upside down"),
        ("speed_mps", True, "not True"),
        ("speed_mps", (1, 2, 3), "not 3 values"),
        ("speed_mps", float("nan"), "finite"),
        ("height_m", (1.9, 10), "2 to 120"),
        ("height_m", (5, 121), "2 to 120"),
        ("height_slack_m", 0, "greater than 0"),
        ("spacing_m", 0, "greater than or equal to 0.02"),
        ("spacing_m", float("inf"), "finite"),
        ("clearance_m", 0, "greater than 0"),
        ("clearance_m", 5, "reaches the ground"),
        ("pitch_deg", (-91, 0), "-90"),
        ("pitch_deg", (-10, 31), "-90"),
        ("turn_radius_m", 0.5, "greater than or equal to 1"),
        ("bank_deg", 61, "less than or equal to 60"),
        ("climb_deg", -1, "greater than or equal to 0"),
        ("max_draws", 0, "greater than or equal to 1"),
        ("max_draws", 10.5, "integer"),
        ("hieght_m", 5, "Extra inputs"),
    ],
)
def test_bad_wishes_are_refused(key: str, value: object, message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        FlightKnobs.model_validate({key: value})


@pytest.mark.parametrize("value", [(0.1, 22.2), 22.2])
def test_the_edges_of_the_speed_range_are_allowed(value: object) -> None:
    FlightKnobs.model_validate({"speed_mps": value})
