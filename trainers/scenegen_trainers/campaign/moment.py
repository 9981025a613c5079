"""When a batch flies: weather, hour and clock, those of a clip of the dataset plan."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.foundation.rng import stream
from scenegen.movers.clock import Clock
from scenegen_datasets.splits.draw import draw_until
from scenegen_trainers.campaign.plan import Batch
from scenegen_trainers.campaign.recipe import FlightRecipe


@dataclass(frozen=True)
class Moment:
    """Weather, hour and clock of a batch.

    Attributes
    ----------
    season : Season
    weather : Weather
    hour : float
    clock : Clock
    """

    season: Season
    weather: Weather
    hour: float
    clock: Clock

    @property
    def facts(self) -> tuple[dict[str, float], dict[str, float]]:
        """Weather and season as plain data."""
        return asdict(self.weather), asdict(self.season)


def draw_moment(recipe: FlightRecipe, season: Season, batch: Batch) -> Moment:
    """The moment of a batch; a pure function of recipe, season and batch.

    What the recipe holds out is flown in if `campaign.conditions` says so; hours that were asked for stand as they are.

    Raises
    ------
    RejectedDrawError
        If the climate hardly ever draws such conditions.
    """
    dataset, hours = recipe.dataset, recipe.campaign.hours
    clip = (batch.map, batch.world, batch.clip)
    held_out, wanted = recipe.held_out, recipe.campaign.conditions == "held_out"
    weather, hour = draw_until(dataset.climate, held_out, season, dataset.seed, clip, wanted)
    if hours:
        hour = float(hours[batch.index % len(hours)])
    if not dataset.movers:
        return Moment(season, weather, hour, Clock.stopped())
    return Moment(season, weather, hour, Clock.draw(stream(dataset.seed, "clip", *clip, "clock")))
