"""What the counts of a clip mean, read from what the dataset says of the clip."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.store import CLIPS
from scenegen_render.sensor.knobs import SensorKnobs
from scenegen_render.sensor.scale import MAX_COUNT, CountScale


def sensor_facts(knobs: SensorKnobs, band_um: tuple[float, float]) -> dict[str, float | int | str]:
    """What a clip's record says of its camera: the scale of the counts, and the noise.

    Parameters
    ----------
    knobs : SensorKnobs
    band_um : (float, float)
        Spectral band [um].
    """
    low, high = CountScale.of(knobs, band_um).ends
    return {
        "low_radiance": low,
        "high_radiance": high,
        "low_K": knobs.scale_K[0],
        "high_K": knobs.scale_K[1],
        "linear_in": knobs.linear_in,
        "counts": MAX_COUNT + 1,
        "netd_mk": knobs.netd_mk,
        "time_constant_ms": knobs.time_constant_ms,
    }


def scale_of(facts: Mapping[str, Any]) -> CountScale:
    """Scale between counts and radiance of a clip.

    Parameters
    ----------
    facts : mapping
        The clip's line of ``clips.jsonl`` (`scenegen_datasets.source.Source.facts`).

    Raises
    ------
    DatasetError
        If it does not say, or says what no sensor has.
    """
    try:
        said, (low_um, high_um) = facts["sensor"], facts["band_um"]
        knobs = SensorKnobs(scale_K=(said["low_K"], said["high_K"]), linear_in=said["linear_in"])
        if not 0.0 < low_um < high_um:
            raise ValueError("a band from its long to its short end")
    except (KeyError, ValueError):
        raise DatasetError(
            f"{CLIPS}: a clip does not say what its counts mean; run `scenegen verify`"
        ) from None
    return CountScale.of(knobs, (low_um, high_um))
