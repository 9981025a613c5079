"""What can be turned in the field family: distributions from which each world draws."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Number, Section, Share, Span, within


class FieldKnobs(Section):
    """Distributions of the field family; every world draws its own values inside them."""

    extent_m: Annotated[Span, within(380.0, 640.0)] = (480.0, 560.0)
    """Side of the square [m] in which everything is detailed."""

    pitches: Annotated[Span, within(1.0, 3.0)] = (1.0, 3.0)
    """Number of football pitches, rounded to a whole number."""

    artificial_share: Share = (0.2, 0.6)
    """Share of pitches with artificial turf; the rest is grass, mown in stripes."""

    track_share: Share = (0.3, 0.6)
    """Share of grounds with a running track around the main pitch."""

    stand_rows: Annotated[Span, within(3.0, 20.0)] = (4.0, 14.0)
    """Rows of seats of the main stand; the one opposite has about half."""

    floodlight_share: Share = (0.6, 1.0)
    """Share of pitches with floodlights; the main pitch comes first."""

    mast_height_m: Annotated[Span, within(10.0, 40.0)] = (15.0, 30.0)
    """Height of the floodlight masts of the main pitch [m]."""

    fence_height_m: Annotated[Span, within(1.2, 3.0)] = (1.6, 2.4)
    """Height of the chain-link fence around the grounds [m]."""

    net_height_m: Annotated[Span, within(3.0, 10.0)] = (4.0, 7.0)
    """Height of the ball-catching nets behind the goals [m]."""

    trees_per_hectare: Annotated[Span, within(0.0, 60.0)] = (8.0, 20.0)
    """Single trees, rows and copses of the detailed square, per hectare; woods have their own."""

    wood_share: Annotated[Span, within(0.0, 0.6)] = (0.08, 0.25)
    """Share of the land around that is woodland."""

    crop_share: Share = (0.3, 0.6)
    """Share of the open land that is ploughed or under crops; the rest is meadow."""

    dry_share: Share = (0.1, 0.7)
    """Share of meadows that are dry."""

    hedge_share: Share = (0.2, 0.5)
    """Share of field boundaries with a hedge or a row of trees."""

    farms: Annotated[Span, within(0.0, 60.0)] = (14.0, 30.0)
    """Farmsteads and hamlets in the land around."""

    pond_share: Share = (0.3, 0.7)
    """Share of worlds with a pond."""

    pylon_share: Share = (0.3, 0.8)
    """Share of worlds that a high-voltage line crosses."""

    relief_m: Annotated[Span, within(0.0, 6.0)] = (1.0, 3.5)
    """Amplitude of the terrain around the grounds [m]."""

    hills_m: Annotated[Span, within(0.0, 120.0)] = (15.0, 60.0)
    """Amplitude of the hills in the distance [m]."""

    car_park_use: Share = (0.15, 0.85)
    """Share of bays that are taken."""

    road_cars_per_100_m: Annotated[Span, within(0.0, 6.0)] = (0.2, 1.2)
    """Cars in each lane of the country road, per 100 m."""

    stand_occupancy: Annotated[Span, within(0.0, 0.6)] = (0.02, 0.12)
    """Share of seats that are taken."""

    bystanders: Annotated[Span, within(0.0, 120.0)] = (10.0, 40.0)
    """People on paths, along the touchlines and in the car park."""

    flight_ceiling_m: Annotated[Number, Field(ge=30.0, le=300.0)] = 120.0
    """Upper edge of the airspace flights may use [m]."""
