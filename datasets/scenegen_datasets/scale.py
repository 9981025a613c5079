"""What the counts of a clip mean, read from what the dataset says of the clip."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scenegen_render.sensor.scale import CountScale


def scale_of(facts: Mapping[str, Any]) -> CountScale:
    """Scale between counts and radiance of a clip.

    Parameters
    ----------
    facts : mapping
        The clip's line of ``clips.jsonl`` (`scenegen_datasets.source.Source.facts`).
    """
    sensor = facts["sensor"]
    low_um, high_um = facts["band_um"]
    return CountScale(sensor["low_K"], sensor["high_K"], (low_um, high_um), sensor["linear_in"])
