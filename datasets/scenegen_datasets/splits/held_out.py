"""What a dataset keeps for its test split: maps, hours, kinds of weather."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from scenegen.foundation.errors import DatasetError
from scenegen_datasets.lock import SOURCE

WEATHERS: Mapping[str, tuple[str, float, float]] = {
    "clear": ("cloud_fraction", 0.0, 0.25),
    "cloudy": ("cloud_fraction", 0.25, 0.95),
    "overcast": ("cloud_fraction", 0.95, float("inf")),
    "calm": ("wind_mps", 0.0, 1.6),
    "windy": ("wind_mps", 5.5, float("inf")),
}
"""Kind of weather: a field of `scenegen.climate.weather.Weather`, and its values from (included) to (not included).

The bounds of wind are those of the Beaufort scale: calm is below force 2, windy from force 4. Only what every season
can draw is here, because a world keeps its season: frost could be held out in no tropical world.
"""

Span = tuple[float, float]


@dataclass(frozen=True)
class HeldOut:
    """Conditions that only the test split may show.

    Attributes
    ----------
    maps : tuple of str
    hours : tuple of (float, float)
        Spans of local mean solar time [h], both ends included; one that begins later than it ends runs over midnight.
    weather : tuple of str
        Names in `WEATHERS`.
    """

    maps: tuple[str, ...] = ()
    hours: tuple[Span, ...] = ()
    weather: tuple[str, ...] = ()

    @property
    def conditions(self) -> bool:
        """Whether anything is held out that is drawn per clip."""
        return bool(self.hours or self.weather)

    def condition(self, hour: float, weather: Mapping[str, float]) -> str:
        """Say what of an hour [h] and a clip's weather is held out, in words; "" if nothing is."""
        for span in self.hours:
            if _inside(hour, span):
                return f"hour {hour:.2f} ({span[0]:g} to {span[1]:g} is held out)"
        for name in self.weather:
            field, low, high = WEATHERS[name]
            if low <= weather.get(field, -1.0) < high:
                return f"{name} weather ({field} {weather[field]:.2f})"
        return ""

    def statement(self) -> dict[str, Any]:
        """Plain data for ``dataset.json``; a kind of weather comes with its definition."""
        return {
            "maps": list(self.maps),
            "hours": [list(span) for span in self.hours],
            "weather": {name: _definition(name) for name in self.weather},
        }

    @property
    def words(self) -> tuple[str, ...]:
        """All of it for people, one line each."""
        kinds = []
        for name in self.weather:
            field, low, high = WEATHERS[name]
            more = f"{low:g} or more" if high == float("inf") else f"from {low:g} to below {high:g}"
            kinds.append(f"{name} weather: `{field}` {more}")
        return (
            *(f"map `{name}`: all of its worlds are for test" for name in self.maps),
            *(f"hours {first:g} to {last:g}, in local mean solar time" for first, last in self.hours),
            *kinds,
        )

    @classmethod
    def of_statement(cls, statement: Mapping[str, Any]) -> HeldOut:
        """Read what `statement` returned."""
        spans = tuple((float(first), float(last)) for first, last in statement["hours"])
        return cls(tuple(statement["maps"]), spans, tuple(statement["weather"]))

    @classmethod
    def of_recipe(cls, recipe: Mapping[str, Any]) -> HeldOut:
        """Read the ``splits`` section of a resolved recipe; without one nothing is held out.

        Raises
        ------
        DatasetError
            If it is not what a recipe holds there.
        """
        section = recipe.get("splits") or {}
        try:
            hours = section.get("test_hours")
            spans = ((float(hours[0]), float(hours[1])),) if hours else ()
            held = cls(tuple(section.get("test_maps") or ()), spans, tuple(section.get("test_weather") or ()))
            known = all(isinstance(name, str) for name in held.maps) and all(
                name in WEATHERS for name in held.weather
            )
        except (AttributeError, TypeError, ValueError, IndexError, KeyError):
            known = False
        if not known:
            raise DatasetError("recipe.lock.json: its section 'splits' makes no sense")
        return held

    @classmethod
    def of_lock(cls, lock: Mapping[str, Any]) -> HeldOut:
        """Of a dataset's lock: what its recipe holds out, or all that the parts of a merged dataset hold out.

        A sensed dataset holds out what its source does.

        Raises
        ------
        DatasetError
            If the lock makes no sense there.
        """
        source, parts = lock.get(SOURCE), lock.get("parts")
        if isinstance(source, dict):
            return cls.of_lock(source)
        if parts:
            if not (isinstance(parts, list) and all(isinstance(part, dict) for part in parts)):
                raise DatasetError("recipe.lock.json: its parts make no sense")
            return cls.union(map(cls.of_lock, parts))
        if not isinstance(lock.get("recipe"), dict):
            raise DatasetError("recipe.lock.json: it, or a part, has no recipe")
        return cls.of_recipe(lock["recipe"])

    @classmethod
    def union(cls, several: Iterable[HeldOut]) -> HeldOut:
        """Everything that one of several holds out, sorted."""
        found = list(several)
        return cls(
            maps=tuple(sorted({name for one in found for name in one.maps})),
            hours=tuple(sorted({span for one in found for span in one.hours})),
            weather=tuple(sorted({name for one in found for name in one.weather})),
        )


def _inside(hour: float, span: Span) -> bool:
    first, last = span
    return first <= hour <= last if first <= last else hour >= first or hour <= last


def _definition(name: str) -> list[Any]:
    field, low, high = WEATHERS[name]
    return [field, low, high if high < float("inf") else None]
