"""What came of a pilot's flights over one map, and how two pilots compare on the same missions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from scenegen_trainers.campaign.record import BatchRecord, FlightRecord
from scenegen_trainers.campaign.statistics import Paired, Rate, compare, wilson

KINDS = ("goal", "collision", "timeout", "pilot")
"""How flights end, in the order of all tables."""


@dataclass(frozen=True)
class Spread:
    """Of one figure over flights; None where there is no flight.

    Attributes
    ----------
    mean, low, median, high : float or None
        Mean, 10th, 50th and 90th percentile.
    """

    mean: float | None
    low: float | None
    median: float | None
    high: float | None

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Summarise."""
        if not values:
            return cls(None, None, None, None)
        low, median, high = np.percentile(values, (10, 50, 90))
        return cls(*(round(float(v), 4) for v in (np.mean(values), low, median, high)))


@dataclass(frozen=True)
class Line:
    """One pilot over one map at one point of a sweep.

    Attributes
    ----------
    point, map, pilot : str
    flights : int
    ends : dict of str to Rate
        Of each of `KINDS`: how many flights, with Wilson's interval.
    hit : dict of str to int
        Collisions by class of what was touched, most frequent first.
    failures : dict of str to int
        Reasons of pilots that failed.
    progress, speed_mps, latency_ms : Spread
    closest_m : Spread
        Of flights that touched nothing and had anything near.
    obstructed : int
        Missions whose straight way is obstructed.
    decisions : int
    batches : int
    """

    point: str
    map: str
    pilot: str
    flights: int
    ends: dict[str, Rate]
    hit: dict[str, int]
    failures: dict[str, int]
    progress: Spread
    speed_mps: Spread
    latency_ms: Spread
    closest_m: Spread
    obstructed: int
    decisions: int
    batches: int

    @property
    def collision(self) -> Rate:
        """The paper's figure."""
        return self.ends["collision"]

    def to_json(self) -> dict[str, Any]:
        """Plain data, rates as shares beside their counts."""
        plain = asdict(self)
        plain["ends"] = {kind: rate_json(rate) for kind, rate in self.ends.items()}
        return plain


def rate_json(rate: Rate) -> dict[str, Any]:
    """A rate as plain data."""
    share = round(rate.share, 6) if rate.of else None
    return {
        "count": rate.count,
        "of": rate.of,
        "share": share,
        "low": round(rate.low, 6),
        "high": round(rate.high, 6),
    }


def summarise(point: str, map: str, pilot: str, records: Sequence[BatchRecord]) -> Line:
    """Sum up what one pilot did."""
    flights = [flight for record in records for flight in record.flights]
    ends = Counter(flight.kind for flight in flights)
    return Line(
        point=point,
        map=map,
        pilot=pilot,
        flights=len(flights),
        ends={kind: wilson(ends[kind], len(flights)) for kind in KINDS},
        hit=_counted(flight.what for flight in flights if flight.collided),
        failures=_counted(flight.reason for flight in flights if flight.kind == "pilot"),
        progress=Spread.of([f.progress for f in flights]),
        speed_mps=Spread.of([f.mean_speed_mps for f in flights]),
        latency_ms=Spread.of([1e3 * f.latency_s for f in flights]),
        closest_m=Spread.of([f.closest_m for f in flights if f.closest_m is not None and not f.collided]),
        obstructed=sum(f.obstructed for f in flights),
        decisions=sum(f.decisions for f in flights),
        batches=len(records),
    )


@dataclass(frozen=True)
class Duel:
    """Two pilots on the same missions.

    Attributes
    ----------
    point, map, first, second : str
    paired : Paired
    """

    point: str
    map: str
    first: str
    second: str
    paired: Paired

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def duel(
    point: str,
    map: str,
    first: tuple[str, Sequence[BatchRecord]],
    second: tuple[str, Sequence[BatchRecord]],
) -> Duel:
    """Compare collisions on the missions both have flown."""
    ours, theirs = (_by_flight(records) for _, records in (first, second))
    common = sorted(ours.keys() & theirs.keys())
    paired = compare([ours[k].collided for k in common], [theirs[k].collided for k in common])
    return Duel(point, map, first[0], second[0], paired)


def _by_flight(records: Sequence[BatchRecord]) -> dict[int, FlightRecord]:
    return {flight.flight: flight for record in records for flight in record.flights}


def _counted(words: Any) -> dict[str, int]:
    """Counts, most frequent first, equal ones by name."""
    return dict(sorted(Counter(words).items(), key=lambda item: (-item[1], item[0])))
