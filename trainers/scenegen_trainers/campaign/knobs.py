"""What a recipe may say about a campaign: how its flights are spread over worlds and hours."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from scenegen.foundation.section import Count, Number, Section

Hour = Annotated[Number, Field(ge=0.0, lt=24.0)]


def _one_or_many(value: object) -> object:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return (value,)
    return tuple(value) if isinstance(value, list) else value


class CampaignKnobs(Section):
    """How flights are spread over worlds and hours."""

    flights_per_batch: Annotated[Count, Field(ge=1, le=200)] = 25
    """Flights that share a world, an hour and a clock, and whose views are traced together."""

    batches_per_world: Annotated[Count, Field(ge=1, le=1000)] = 4
    """Batches flown in a world before the next one is built."""

    split: Literal["test", "val", "train", "all"] = "test"
    """Worlds of the dataset plan to fly in. A pilot trained on a dataset of the same seed has not seen the test
    worlds."""

    conditions: Literal["usual", "held_out", "any"] = "usual"
    """Hours and weather to fly in where the recipe's `splits` keep some for testing: usual ones, which training may
    have seen; only those held out; or any, as the climate draws them."""

    hours: Annotated[tuple[Hour, ...], BeforeValidator(_one_or_many)] = ()
    """Hours [h] the batches take turns at; empty draws one per batch as `climate.hour` says."""
