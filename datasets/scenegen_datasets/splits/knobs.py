"""The recipe's section about splits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field

from scenegen.climate.knobs import ClimateKnobs
from scenegen.foundation.errors import nearest
from scenegen.foundation.section import Number, Section
from scenegen_datasets.splits.held_out import WEATHERS, HeldOut


def _one_or_many(value: Any) -> Any:
    return (value,) if isinstance(value, str) else tuple(value) if isinstance(value, list) else value


def _sorted(value: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(sorted(set(value)))


def _kinds(value: tuple[str, ...]) -> tuple[str, ...]:
    for name in value:
        if name not in WEATHERS:
            raise ValueError(f"unknown weather '{name}'{nearest(name, WEATHERS)}")
    return value


def _pair(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


Names = Annotated[tuple[str, ...], BeforeValidator(_one_or_many), AfterValidator(_sorted)]
Hour = Annotated[Number, Field(ge=0.0, lt=24.0)]
Hours = Annotated[tuple[Hour, Hour], BeforeValidator(_pair)]


class SplitKnobs(Section):
    """What only the test split may show, besides worlds of its own."""

    test_maps: Names = ()
    """Maps kept for the test split: all their worlds go there."""
    test_hours: Hours | None = None
    """Hours kept for the test split, FROM TO [h]; over midnight if FROM is the larger."""
    test_weather: Annotated[Names, AfterValidator(_kinds)] = ()
    """Weather kept for the test split: clear, cloudy, overcast, calm, windy."""

    @property
    def held_out(self) -> HeldOut:
        """The same as plain facts."""
        return HeldOut.of_recipe({"splits": self.model_dump()})

    def contradiction(self, maps: Sequence[str], climate: ClimateKnobs) -> str:
        """Say in one line why a recipe of these maps and this climate cannot be split so; "" if it can."""
        for name in self.test_maps:
            if name not in maps:
                return f"test_maps: the recipe has no map '{name}'{nearest(name, maps)}"
        if set(maps) <= set(self.test_maps):
            return "test_maps: every map is held out; nothing would be left to train on"
        return self._hours_contradict(climate) or self._weather_contradicts(climate)

    def _hours_contradict(self, climate: ClimateKnobs) -> str:
        if self.test_hours is None or climate.hour is None:
            return ""
        drawn = [climate.hour[0] + k / 1000.0 * (climate.hour[1] - climate.hour[0]) for k in range(1001)]
        held = [bool(HeldOut(hours=(self.test_hours,)).condition(hour, {})) for hour in drawn]
        return _verdict(held, "test_hours", f"climate.hour is {_span(climate.hour)}")

    def _weather_contradicts(self, climate: ClimateKnobs) -> str:
        for field in ("cloud_fraction", "wind_mps"):
            names = [name for name in self.test_weather if WEATHERS[name][0] == field]
            given = getattr(climate, field)
            if not names:
                continue
            if given is None and {"clear", "cloudy", "overcast"} <= set(names):
                return "test_weather: every sky is held out; nothing would be left to train on"
            if given is None:
                continue
            drawn = [given[0] + k / 1000.0 * (given[1] - given[0]) for k in range(1001)]
            for name in names:  # each must occur; what is left must occur, too
                held = [bool(HeldOut(weather=(name,)).condition(0.0, {field: x})) for x in drawn]
                if not any(held):
                    return _verdict(held, f"test_weather {name}", f"climate.{field} is {_span(given)}")
            held = [bool(HeldOut(weather=tuple(names)).condition(0.0, {field: x})) for x in drawn]
            found = _verdict(held, f"test_weather {' '.join(names)}", f"climate.{field} is {_span(given)}")
            if found:
                return found
        return ""


def _verdict(held: Sequence[bool], key: str, because: str) -> str:
    if all(held):
        return f"{key}: everything is held out ({because}); nothing would be left to train on"
    if not any(held):
        return f"{key}: is never drawn ({because})"
    return ""


def _span(value: tuple[float, float]) -> str:
    return f"{value[0]:g} to {value[1]:g}"
