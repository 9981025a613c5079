"""One flight as it is kept: how it ended, where, and the way it took; plain data with exact reading back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
from jaxtyping import Float64

from scenegen.foundation.errors import DatasetError
from scenegen_flythrough.loop.outcome import Outcome

_MILLI = 3  # decimals kept: millimetres, milliseconds; a path of 300 places stays below 10 kB


@dataclass(frozen=True)
class FlightRecord:
    """A flight that was flown.

    Attributes
    ----------
    flight : int
        Id within its map.
    kind : str
        "goal", "collision", "timeout" or "pilot".
    time_s : float
        When it ended.
    place_m : (float, float, float)
        Where it ended.
    object : int
        Instance id of what was touched, 0 if nothing was.
    what : str
        Its class; empty if nothing was touched.
    reason : str
        Why a pilot failed.
    progress : float
        Share of the way to the goal that was gained.
    mean_speed_mps : float
    closest_m : float or None
        Least distance to anything before the end; None if nothing was near.
    latency_s : float
        Mean delay from frame to command.
    decisions : int
    start_m, goal_m : (float, float, float)
    obstructed : bool
        Whether something stands on the straight line between them.
    path : tuple of (float, float, float, float)
        Time and place after every decision.
    """

    flight: int
    kind: str
    time_s: float
    place_m: tuple[float, ...]
    object: int
    what: str
    reason: str
    progress: float
    mean_speed_mps: float
    closest_m: float | None
    latency_s: float
    decisions: int
    start_m: tuple[float, ...]
    goal_m: tuple[float, ...]
    obstructed: bool
    path: tuple[tuple[float, ...], ...]

    @property
    def collided(self) -> bool:
        """Whether it touched anything."""
        return self.kind == "collision"

    @classmethod
    def of(
        cls,
        outcome: Outcome,
        start_m: Float64[np.ndarray, "3"],
        goal_m: Float64[np.ndarray, "3"],
        obstructed: bool,
    ) -> FlightRecord:
        """Keep an outcome and the mission it belongs to."""
        return cls(
            flight=int(outcome.flight),
            kind=str(outcome.kind),
            time_s=_short(outcome.time_s),
            place_m=_place(outcome.place_m),
            object=int(outcome.object),
            what=outcome.class_name,
            reason=" ".join(outcome.reason.split()),
            progress=_short(outcome.progress),
            mean_speed_mps=_short(outcome.mean_speed_mps),
            closest_m=_short(outcome.closest_m) if math.isfinite(outcome.closest_m) else None,
            latency_s=_short(outcome.latency_s),
            decisions=int(outcome.decisions),
            start_m=_place(start_m),
            goal_m=_place(goal_m),
            obstructed=bool(obstructed),
            path=tuple(_place(row) for row in outcome.path),
        )

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)

    @classmethod
    def from_json(cls, value: Mapping[str, Any], where: str) -> FlightRecord:
        """Read plain data back.

        Raises
        ------
        DatasetError
            If it is not a flight.
        """
        if not isinstance(value, Mapping) or value.keys() != {f.name for f in fields(cls)}:
            raise DatasetError(f"{where}: not a flight")
        return cls(**{name: _tuples(entry) for name, entry in value.items()})


@dataclass(frozen=True)
class BatchRecord:
    """A batch that was flown by one pilot.

    Attributes
    ----------
    world : int
    hour : float
        Local mean solar time.
    weather : mapping of str to float
    season : mapping of str to float
        Latitude and date.
    flights : tuple of FlightRecord
    """

    world: int
    hour: float
    weather: Mapping[str, float]
    season: Mapping[str, float]
    flights: tuple[FlightRecord, ...]

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "world": self.world,
            "hour": self.hour,
            "weather": dict(self.weather),
            "season": dict(self.season),
            "flights": [flight.to_json() for flight in self.flights],
        }

    @classmethod
    def from_json(cls, value: Any, where: str) -> BatchRecord:
        """Read plain data back.

        Raises
        ------
        DatasetError
            If it is not a batch.
        """
        wanted = {"world", "hour", "weather", "season", "flights"}
        if not isinstance(value, Mapping) or not wanted <= value.keys():
            raise DatasetError(f"{where}: not a batch of flights")
        flights = tuple(FlightRecord.from_json(flight, where) for flight in value["flights"])
        return cls(value["world"], value["hour"], dict(value["weather"]), dict(value["season"]), flights)


def _short(value: float) -> float:
    return round(float(value), _MILLI)


def _place(values: Any) -> tuple[float, ...]:
    return tuple(_short(v) for v in values)


def _tuples(value: Any) -> Any:
    return tuple(_tuples(v) for v in value) if isinstance(value, list) else value
