"""What a user can set about the exposure of a world."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Count, Number, Section


class ExposureKnobs(Section):
    """How finely sun and surroundings of each site are sampled.

    The defaults keep the random part of the radiance below 20 mK; see ``benchmarks/bake_error.py``.
    """

    directions: Annotated[Count, Field(ge=16, le=1024)] = 96
    """Rays over the hemisphere of each site."""
    sun_step_min: Annotated[Number, Field(ge=2.0, le=120.0)] = 15.0
    """Longest step between sun positions [min]; shadow edges are found eight times finer."""
    smoothing: Annotated[Count, Field(ge=0, le=4)] = 2
    """Rounds of averaging over neighbours on the same facet, which share their rays that way."""
