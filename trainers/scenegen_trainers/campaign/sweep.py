"""Sweeps: the same missions again and again, with one thing changed at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from scenegen.foundation.errors import InputError, nearest
from scenegen.foundation.strict_yaml import parse_mapping
from scenegen_trainers.campaign.names import slug

AXES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "hour": ("campaign.hours", "hour [h]"),
        "speed": ("loop.cruise_mps", "cruise speed [m/s]"),
        "netd": ("sensor.netd_mk", "NETD [mK]"),
        "latency": ("loop.latency_ms", "latency [ms]"),
        "cloud": ("climate.cloud_fraction", "cloud fraction"),
        "visibility": ("climate.visibility_km", "visibility [km]"),
        "air": ("climate.air_mean_C", "mean air temperature [°C]"),
        "wind": ("loop.wind.mean_mps", "mean wind [m/s]"),
        "difficulty": ("mission.difficulty", "share of obstructed missions"),
        "distance": ("mission.distance_m", "distance of the goal [m]"),
    }
)
"""Short names of what is swept most: recipe key, and words for a chart's axis."""

WEATHERS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "clear": {"cloud_fraction": 0.05, "visibility_km": 40.0},
        "cloudy": {"cloud_fraction": 0.6, "visibility_km": 25.0},
        "overcast": {"cloud_fraction": 1.0, "visibility_km": 15.0},
        "haze": {"cloud_fraction": 0.3, "visibility_km": 4.0},
        "mist": {"cloud_fraction": 1.0, "visibility_km": 1.5},
        "fog": {"cloud_fraction": 1.0, "visibility_km": 0.3},
    }
)
"""Values of the axis ``weather``: what they fix of the climate. Limits of visibility after the WMO's: fog below 1 km,
mist below 5 km."""

_FIXED = ("seed", "map", "scenes", "campaign")


@dataclass(frozen=True)
class Point:
    """One value of one axis.

    Attributes
    ----------
    axis, value : str
        As written by the user.
    name : str
        Of its directory.
    words : str
        What the axis is called in a chart.
    keys : mapping
        Recipe keys it sets, nested.
    number : float or None
        The value where it is one.
    """

    axis: str
    value: str
    name: str
    words: str
    keys: Mapping[str, Any]
    number: float | None


def parse_sweep(words: Sequence[str]) -> tuple[Point, ...]:
    """Read ``KEY=VALUE,VALUE,...``, each an axis of its own.

    Raises
    ------
    InputError
        If that is not what was written, or the key cannot be swept.
    """
    points: list[Point] = []
    for word in words:
        axis, equals, values = word.partition("=")
        given = [value.strip() for value in values.split(",") if value.strip()]
        if not equals or not given:
            raise InputError(f"--sweep {word}: write KEY=VALUE,VALUE, such as speed=3,6,9")
        points += [_point(axis.strip(), value) for value in given]
    names = [point.name for point in points]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"--sweep: {twice} is given twice")
    return tuple(points)


def _point(axis: str, value: str) -> Point:
    name = slug(f"{axis}={value}")
    if axis == "weather":
        if value not in WEATHERS:
            raise InputError(f"--sweep weather={value}: unknown weather{nearest(value, WEATHERS)}")
        return Point(axis, value, name, "weather", {"climate": dict(WEATHERS[value])}, None)
    key, words = AXES.get(axis, (axis.replace("-", "_"), axis))
    if axis not in AXES and "." not in axis:
        raise InputError(
            f"--sweep {axis}: unknown axis{nearest(axis, [*AXES, 'weather'])}; or a dotted recipe key"
        )
    if axis not in AXES and key.partition(".")[0] in _FIXED:
        raise InputError(f"--sweep {axis}: decides which missions there are and cannot be swept")
    plain = parse_mapping(f"value: {value}", f"--sweep {axis}")["value"]
    number = float(plain) if isinstance(plain, int | float) and not isinstance(plain, bool) else None
    nested: Any = plain
    for part in reversed(key.split(".")):
        nested = {part: nested}
    return Point(axis, value, name, words, nested, number)
