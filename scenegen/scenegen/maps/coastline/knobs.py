"""What can be turned on the coast: distributions from which each world draws."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Number, Section, Span, within


class CoastlineKnobs(Section):
    """Distributions of the coastline family; every world draws its own values inside them."""

    extent_m: Annotated[Span, within(400.0, 900.0)] = (720.0, 840.0)
    """Side of the square of detailed land and sea [m], 400 to 900."""

    cliff_share: Annotated[Span, within(0.0, 0.9)] = (0.3, 0.6)
    """Share of the detailed shore that is cliff; the rest is beach and dune."""

    cliff_height_m: Annotated[Span, within(3.0, 60.0)] = (12.0, 32.0)
    """Height of the highest cliffs [m]."""

    beach_width_m: Annotated[Span, within(15.0, 100.0)] = (26.0, 60.0)
    """Width of the open beach, wet sand included [m]."""

    dune_height_m: Annotated[Span, within(0.0, 12.0)] = (2.0, 6.0)
    """Height of the dunes behind the beach [m]."""

    wet_height_m: Annotated[Span, within(0.2, 1.5)] = (0.4, 0.9)
    """How high above the sea the sand is wet [m]: what the tide has left."""

    relief_m: Annotated[Span, within(0.0, 8.0)] = (1.5, 4.5)
    """Amplitude of the rolling land [m]."""

    wind_mps: Annotated[Span, within(0.5, 14.0)] = (2.5, 9.0)
    """Wind that raised the sea [m/s]."""

    fetch_km: Annotated[Span, within(2.0, 500.0)] = (20.0, 200.0)
    """Open water over which it blew [km]."""

    swell_m: Annotated[Span, within(0.0, 2.0)] = (0.1, 0.7)
    """Significant height of the old swell below the wind sea [m]."""

    rocks_per_100_m: Annotated[Span, within(0.0, 150.0)] = (30.0, 80.0)
    """Rocks along 100 m of cliff foot; beaches have a few, headlands have stacks off shore."""

    pier_length_m: Annotated[Span, within(30.0, 200.0)] = (60.0, 130.0)
    """Length of the pier [m]."""

    breakwater_length_m: Annotated[Span, within(40.0, 250.0)] = (80.0, 170.0)
    """Length of the breakwater [m]."""

    houses: Annotated[Span, within(0.0, 60.0)] = (10.0, 24.0)
    """Houses wanted along the coastal road; fewer where the land is steep."""

    huts: Annotated[Span, within(0.0, 60.0)] = (8.0, 22.0)
    """Huts at the head of the beach."""

    trees_per_1000_m2: Annotated[Span, within(0.0, 8.0)] = (0.6, 2.2)
    """Trees in groves behind the coast."""

    shrubs_per_1000_m2: Annotated[Span, within(0.0, 20.0)] = (2.0, 8.0)
    """Shrubs on dunes' backs and cliff tops."""

    tufts_per_1000_m2: Annotated[Span, within(0.0, 400.0)] = (90.0, 240.0)
    """Tufts of marram grass on dunes."""

    cars: Annotated[Span, within(0.0, 80.0)] = (14.0, 36.0)
    """Cars in the car park and on the road."""

    boats: Annotated[Span, within(0.0, 60.0)] = (8.0, 20.0)
    """Boats at anchor, at the pier and on the beach."""

    traffic_per_100_m: Annotated[Span, within(0.0, 4.0)] = (0.1, 0.5)
    """Moving vehicles on 100 m of lane."""

    sailing_per_km: Annotated[Span, within(0.0, 20.0)] = (1.0, 5.0)
    """Boats under way on a kilometre of their rounds off shore."""

    people: Annotated[Span, within(0.0, 250.0)] = (30.0, 90.0)
    """People on beach, pier and road."""

    flight_ceiling_m: Annotated[Number, Field(ge=30.0, le=300.0)] = 120.0
    """Upper edge of the airspace flights may use [m]."""
