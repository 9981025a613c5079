"""Which block is what: parks, a dense middle, housing around it, industry to one side."""

from __future__ import annotations

from enum import StrEnum

import numpy as np
import shapely

from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.city.streets import StreetPlan


class Use(StrEnum):
    """Use of a block."""

    HOMES = "homes"
    ESTATE = "estate"
    PERIMETER = "perimeter"
    OFFICES = "offices"
    INDUSTRY = "industry"
    PARK = "park"


LOT_AREA_M2 = {
    Use.ESTATE: (900.0, 1700.0),
    Use.OFFICES: (900.0, 1800.0),
    Use.INDUSTRY: (1300.0, 2600.0),
}
"""Range of the area at which division into lots stops [m^2]."""


def assign_uses(plan: StreetPlan, knobs: CityKnobs, rng: np.random.Generator) -> list[Use]:
    """Draw the use of every block of a plan."""
    centre = np.array([shapely.get_coordinates(b.centroid)[0] for b in plan.blocks])
    area = np.array([b.area for b in plan.blocks])
    reach = np.linalg.norm(centre, axis=1) / np.sqrt(plan.outline.area)
    uses: list[Use | None] = [None] * len(area)
    wanted = rng.uniform(*knobs.park_area_share) * plan.outline.area
    for k in np.argsort(reach + rng.uniform(0.0, 0.6, len(area)) - area / 4e4):
        if wanted <= 0:
            break
        uses[k] = Use.PARK
        wanted -= area[k]
    heading = rng.uniform(0.0, 2 * np.pi)
    side = centre @ np.array([np.cos(heading), np.sin(heading)])
    quarter = np.quantile(side, 1 - rng.uniform(*knobs.industry_share))
    modern = rng.uniform(*knobs.modern_share)
    drawn = []
    for k, use in enumerate(uses):
        if use is None:
            use = (
                Use.INDUSTRY
                if side[k] > quarter
                else _inner_use(reach[k] + rng.normal(0.0, 0.09), modern, rng)
            )
        drawn.append(use)
    return drawn


def _inner_use(reach: float, modern: float, rng: np.random.Generator) -> Use:
    """Dense near the middle, open towards the edge; `reach` is the distance over the side of the city."""
    choice = rng.uniform()
    if reach < 0.24:
        return Use.OFFICES if choice < modern else Use.PERIMETER
    if reach < 0.40:
        return Use.PERIMETER if choice < 0.5 * (1 - modern) else Use.ESTATE if choice < 0.55 else Use.HOMES
    return Use.ESTATE if choice < 0.25 else Use.HOMES
