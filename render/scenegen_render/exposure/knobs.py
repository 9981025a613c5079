"""What a user can set about the exposure of a world."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Count, Number, Section


class ExposureKnobs(Section):
    """How finely sun and surroundings of each site are sampled; ``benchmarks/bake_error.py`` measures what it buys."""

    directions: Annotated[Count, Field(ge=32, le=1024)] = 64
    """Rays over the hemisphere of each site."""
    sun_step_min: Annotated[Number, Field(ge=2.0, le=120.0)] = 20.0
    """Longest step between sun positions [min]; shadow edges are found eight times finer."""
    smoothing: bool = True
    """Average over mesh neighbours on the same facet that see the same."""
    closer_rays: Annotated[Count, Field(ge=0, le=1_000_000)] = 60_000
    """Rays spent for each frame of a clip on the sites that its frames show; 0: what every site has is enough."""
