"""What can be turned in the city: distributions from which each world draws."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Number, Section, Span


class CityKnobs(Section):
    """Distributions of the city family; every world draws its own values inside them."""

    extent_m: Annotated[Span, Field()] = (715.0, 765.0)
    """Side of the detailed square [m], 400 to 1,000."""

    block_area_m2: Span = (7000.0, 13000.0)
    """Area [m^2] at which the street network stops dividing a block, drawn per block."""

    street_bend_m: Span = (4.0, 16.0)
    """How far streets bend away from straight lines [m]."""

    building_density: Span = (0.8, 0.97)
    """Share of building lots that are built on; the rest are yards and car parks."""

    storeys: Span = (2.0, 6.0)
    """Storeys of ordinary buildings; towers and sheds have their own rules."""

    tower_share: Span = (0.02, 0.10)
    """Share of lots with a tower."""

    tower_storeys: Span = (10.0, 22.0)
    """Storeys of towers."""

    modern_share: Span = (0.2, 0.6)
    """Share of buildings after 1960: concrete, flat roofs, wide windows. The rest are brick and render, often pitched."""

    industry_share: Span = (0.05, 0.18)
    """Share of blocks given to sheds and workshops."""

    park_area_share: Span = (0.03, 0.07)
    """Share of the detailed area given to parks; at least one block."""

    dry_lawn_share: Span = (0.0, 0.6)
    """Share of lawns that are not watered."""

    street_tree_spacing_m: Span = (9.0, 18.0)
    """Distance between street trees [m] where a street has any."""

    yard_trees_per_1000_m2: Span = (2.0, 6.0)
    """Trees in yards."""

    park_trees_per_1000_m2: Span = (5.0, 10.0)
    """Trees in parks."""

    parked_cars_per_100_m: Span = (4.0, 8.0)
    """Parked cars along 100 m of kerb."""

    moving_cars_per_100_m: Span = (0.3, 1.2)
    """Cars in the lanes, per 100 m of street."""

    relief_m: Span = (0.4, 1.8)
    """Amplitude of the terrain [m]."""

    flight_ceiling_m: Annotated[Number, Field(ge=30.0, le=300.0)] = 120.0
    """Upper edge of the airspace flights may use [m]."""
