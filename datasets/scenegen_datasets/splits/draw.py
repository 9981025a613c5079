"""Hour and weather of a clip, such as its split may show.

A world belongs to one split, and what is held out is never moved there from a training world: it is not drawn in one.
So neither a place nor a condition of the test split is ever seen in training.
"""

from __future__ import annotations

from scenegen.climate.knobs import ClimateKnobs, draw_weather_and_hour
from scenegen.climate.season import Season
from scenegen.climate.weather import Weather
from scenegen.foundation.errors import RejectedDrawError
from scenegen.foundation.rng import stream
from scenegen_datasets.job import ClipJob
from scenegen_datasets.plan import SPLIT_PERIOD
from scenegen_datasets.splits.held_out import HeldOut

MAX_DRAWS = 1000
"""Draws until a clip is given up. Rarest is a held-out hour: one in a hundred draws for a quarter of an hour."""

Clip = tuple[str, int, int]
"""Map, world and clip: what conditions are drawn for."""


def draw_conditions(
    climate: ClimateKnobs, held_out: HeldOut, season: Season, seed: int, job: ClipJob
) -> tuple[Weather, float]:
    """Draw weather and hour [h] of a clip; a pure function of its arguments.

    Where nothing is held out, the first draw is taken. Clips of training and validation worlds are drawn until nothing
    of the draw is held out; those of test worlds by turns, so that one split measures both: one clip until something
    is, the next until nothing is.

    Parameters
    ----------
    climate : ClimateKnobs
    held_out : HeldOut
    season : Season
        Of the clip's world.
    seed : int
        Of the recipe.
    job : ClipJob

    Raises
    ------
    RejectedDrawError
        If no draw of `MAX_DRAWS` will do.
    """
    clip = (job.map, job.world, job.clip)
    return draw_until(climate, held_out, season, seed, clip, shows_held_out(job))


def draw_until(
    climate: ClimateKnobs, held_out: HeldOut, season: Season, seed: int, clip: Clip, wanted: bool
) -> tuple[Weather, float]:
    """Draw weather and hour [h] until they are held out, if `wanted`, else until they are not.

    Raises
    ------
    RejectedDrawError
        As `draw_conditions`.
    """
    for attempt in range(MAX_DRAWS):
        again = (attempt,) if attempt else ()
        rng = stream(seed, "clip", *clip, "weather", *again)
        weather, hour = draw_weather_and_hour(climate, season, rng)
        if not held_out.conditions or bool(held_out.condition(hour, vars(weather))) == wanted:
            return weather, hour
    what = "what is held out" if wanted else "anything but what is held out"
    map, world, number = clip
    raise RejectedDrawError(
        f"{map}-{world:05d}-{number:03d}: the climate of this recipe draws {what} less than once in {MAX_DRAWS} times; "
        "hold out wider hours or other weather"
    )


def shows_held_out(job: ClipJob) -> bool:
    """Whether a clip is to show what is held out: every other one of the test split.

    The first clip of a test world does if the world's number and its decade are even together, as for world 2; so with
    a single clip per world, test worlds take turns as well.
    """
    return job.split == "test" and (job.clip + job.world + job.world // SPLIT_PERIOD) % 2 == 0
