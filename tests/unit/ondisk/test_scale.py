"""What counts mean is read from the clip's own line, or refused."""

from __future__ import annotations

from typing import Any

import pytest

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.scale import scale_of, sensor_facts
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.scale import CountScale

KNOBS = SensorKnobs(scale_K=(250.0, 330.0), linear_in="temperature")
BAND_UM = (7.5, 13.0)


def facts(**changes: Any) -> dict[str, Any]:
    said = {"sensor": dict(sensor_facts(KNOBS, BAND_UM)), "band_um": list(BAND_UM)}
    for name, value in changes.items():
        (said if name in said else said["sensor"])[name] = value
    return said


def test_a_clip_says_what_its_counts_mean() -> None:
    assert scale_of(facts()) == CountScale(250.0, 330.0, BAND_UM, "temperature")


@pytest.mark.parametrize(
    "changes",
    [
        {"sensor": {}},
        {"low_K": "cold"},
        {"low_K": 400.0},
        {"high_K": 1e9},
        {"linear_in": "counts"},
        {"band_um": [13.0, 7.5]},
        {"band_um": [0.0, 13.0]},
    ],
)
def test_what_no_sensor_says_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(DatasetError, match=r"clips.jsonl: a clip does not say what its counts mean; run"):
        scale_of(facts(**changes))
