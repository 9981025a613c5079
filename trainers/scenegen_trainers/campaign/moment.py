"""When a batch flies: weather, hour and clock, those of a clip of the dataset plan."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from scenegen.climate.knobs import draw_weather_and_hour
from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.foundation.rng import stream
from scenegen.movers.clock import Clock
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
    """The moment of a batch; a pure function of recipe, season and batch."""
    dataset = recipe.dataset
    path = ("clip", batch.map, batch.world, batch.clip)
    weather, hour = draw_weather_and_hour(dataset.climate, season, stream(dataset.seed, *path, "weather"))
    hours = recipe.campaign.hours
    if hours:
        hour = float(hours[batch.index % len(hours)])
    if not dataset.movers:
        return Moment(season, weather, hour, Clock.stopped())
    return Moment(season, weather, hour, Clock.draw(stream(dataset.seed, *path, "clock")))
