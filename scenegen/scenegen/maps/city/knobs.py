"""What can be turned in the city: distributions from which each world draws."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Number, Section, Share, Span, within


class CityKnobs(Section):
    """Distributions of the city family; every world draws its own values inside them."""

    extent_m: Annotated[Span, within(400.0, 860.0)] = (690.0, 730.0)
    """Square root of the detailed area [m], 400 to 860: beyond, a world has too many thermal sites."""

    block_area_m2: Annotated[Span, within(3000.0, 40000.0)] = (7000.0, 13000.0)
    """Area [m^2] at which the street network stops dividing a block, drawn per block."""

    street_bend_m: Annotated[Span, within(0.0, 25.0)] = (4.0, 16.0)
    """How far streets bend away from straight lines [m]."""

    building_density: Share = (0.75, 0.95)
    """Share of building lots that are built on; the rest are gardens, yards and car parks."""

    storeys: Annotated[Span, within(1.0, 12.0)] = (2.0, 6.0)
    """Storeys of ordinary buildings; houses, towers and sheds have their own rules."""

    tower_share: Annotated[Span, within(0.0, 0.25)] = (0.03, 0.10)
    """Share of towers on housing estates; four times this among offices."""

    tower_storeys: Annotated[Span, within(6.0, 30.0)] = (10.0, 22.0)
    """Storeys of towers, podium included."""

    setback_share: Share = (0.15, 0.5)
    """Share of flat-roofed buildings of four storeys or more whose upper storeys step back."""

    unheated_share: Share = (0.04, 0.15)
    """Share of rooms that nobody heats: stairs, stores, empty flats."""

    unheated_warehouse_share: Share = (0.3, 0.8)
    """Share of sheds and warehouses without heating."""

    running_units_share: Share = (0.3, 0.8)
    """Share of buildings whose rooftop air handlers run."""

    modern_share: Share = (0.2, 0.6)
    """Share of the middle built after 1960: office blocks and towers instead of perimeter blocks."""

    industry_share: Share = (0.05, 0.18)
    """Share of blocks given to sheds and workshops."""

    park_area_share: Annotated[Span, within(0.001, 0.5)] = (0.03, 0.07)
    """Share of the detailed area given to parks; at least one block."""

    dry_lawn_share: Share = (0.0, 0.6)
    """Share of lawns that are not watered."""

    street_tree_spacing_m: Annotated[Span, within(5.0, 100.0)] = (11.0, 20.0)
    """Distance between street trees [m] where a street has any."""

    yard_trees_per_1000_m2: Annotated[Span, within(0.0, 15.0)] = (2.0, 4.2)
    """Trees in yards."""

    park_trees_per_1000_m2: Annotated[Span, within(0.0, 25.0)] = (5.0, 10.0)
    """Trees in parks."""

    viaduct_chance: Annotated[Number, Field(ge=0.0, le=1.0)] = 1.0
    """Chance that an elevated railway runs over the longest arterial."""

    viaduct_clearance_m: Annotated[Span, within(5.2, 14.0)] = (5.6, 8.0)
    """Room under the viaduct's girder [m]."""

    viaduct_span_m: Annotated[Span, within(14.0, 45.0)] = (20.0, 30.0)
    """Distance between the viaduct's piers [m]."""

    wired_street_share: Share = (0.3, 0.9)
    """Share of arterials and collectors with overhead wires of trams and trolleybuses."""

    bus_stop_share: Share = (0.1, 0.35)
    """Share of the longer stretches of collectors that have a bus stop, on either side."""

    people_standing: Annotated[Span, within(0.0, 400.0)] = (40.0, 120.0)
    """People who stand at crossings and in parks; a few more wait at bus stops."""

    parked_cars_per_100_m: Annotated[Span, within(0.0, 17.0)] = (4.0, 8.0)
    """Parked cars along 100 m of kerb."""

    moving_cars_per_100_m: Annotated[Span, within(0.0, 10.0)] = (0.3, 1.2)
    """Cars that drive in each lane, per 100 m of street."""

    people_per_100_m: Annotated[Span, within(0.0, 10.0)] = (0.2, 1.0)
    """People walking along 100 m of sidewalk."""

    relief_m: Annotated[Span, within(0.0, 3.0)] = (0.4, 1.8)
    """Amplitude of the terrain [m]."""

    flight_ceiling_m: Annotated[Number, Field(ge=30.0, le=300.0)] = 120.0
    """Upper edge of the airspace flights may use [m]."""
