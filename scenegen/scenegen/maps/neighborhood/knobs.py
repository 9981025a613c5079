"""What can be turned in the neighborhood: distributions from which each world draws."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Number, Section, Share, Span, within


class NeighborhoodKnobs(Section):
    """Distributions of the neighborhood family; every world draws its own values inside them."""

    extent_m: Annotated[Span, within(220.0, 700.0)] = (505.0, 545.0)
    """Side of the square the street network is drawn in [m], 220 to 700; gardens reach a little beyond."""

    lot_width_m: Annotated[Span, within(14.0, 45.0)] = (20.0, 27.0)
    """Usual width of lots along the street [m]."""

    lot_depth_m: Annotated[Span, within(24.0, 55.0)] = (31.0, 38.0)
    """Usual depth of lots [m]: half the distance between parallel streets, without the streets."""

    street_curvature: Annotated[Span, within(0.0, 1.5)] = (0.5, 1.1)
    """How strongly streets wind, 0 for straight ones."""

    cul_de_sac_share: Annotated[Span, within(0.0, 0.8)] = (0.25, 0.5)
    """Share of street stretches cut into dead ends with turning circles, as far as all stay connected."""

    built_share: Annotated[Span, within(0.2, 1.0)] = (0.9, 0.98)
    """Share of lots with a house; the rest are meadows."""

    modern_share: Share = (0.15, 0.75)
    """Share of houses younger than 1980: low roofs, wide windows, hips and sheds instead of steep gables."""

    two_storey_share: Share = (0.25, 0.75)
    """Share of houses with two storeys."""

    garage_share: Share = (0.6, 0.9)
    """Share of houses with a garage."""

    unheated_share: Share = (0.15, 0.45)
    """Share of windows of rooms that nobody heats."""

    dry_lawn_share: Share = (0.1, 0.7)
    """Share of lawns that are not watered."""

    pool_share: Annotated[Span, within(0.0, 0.7)] = (0.06, 0.28)
    """Share of gardens with a pool."""

    shed_share: Share = (0.3, 0.6)
    """Share of gardens with a shed."""

    trees_per_1000_m2: Annotated[Span, within(0.0, 16.0)] = (1.6, 2.5)
    """Trees in gardens and commons."""

    conifer_share: Share = (0.1, 0.4)
    """Share of conifers among garden trees."""

    street_tree_share: Share = (0.2, 0.8)
    """Share of streets with trees on the verge."""

    hedge_share: Annotated[Span, within(0.0, 0.8)] = (0.03, 0.1)
    """Share of garden borders with a hedge."""

    fence_share: Annotated[Span, within(0.0, 0.9)] = (0.14, 0.3)
    """Share of the other garden borders with a fence."""

    driveway_cars: Annotated[Span, within(0.0, 2.0)] = (0.6, 1.1)
    """Cars standing on a driveway, on average."""

    parked_cars_per_100_m: Annotated[Span, within(0.0, 14.0)] = (0.8, 2.5)
    """Cars parked along 100 m of kerb."""

    moving_cars_per_km: Annotated[Span, within(0.0, 30.0)] = (3.0, 6.5)
    """Cars and vans that drive, on a kilometre of street."""

    walkers_per_100_m: Annotated[Span, within(0.0, 10.0)] = (0.1, 0.5)
    """People who walk or run, on 100 m of sidewalk."""

    people_per_100_lots: Annotated[Span, within(0.0, 200.0)] = (4.0, 18.0)
    """People who stand about in gardens."""

    pole_share: Share = (0.4, 0.85)
    """Share of streets with utility poles and overhead wires; the others have buried cables."""

    relief_m: Annotated[Span, within(0.0, 9.0)] = (1.5, 5.0)
    """Amplitude of the terrain [m]."""

    flight_ceiling_m: Annotated[Number, Field(ge=30.0, le=300.0)] = 100.0
    """Upper edge of the airspace flights may use [m]."""
