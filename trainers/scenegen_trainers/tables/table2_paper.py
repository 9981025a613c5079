"""Table 2 of the paper: collision rates of the conventional and the proposed method on its four maps.

Its last row, AVERAGE 19.25 and 12.50, is the mean of three maps: City is left out, without a word. Over all four it is
28.90 and 22.33. City's own figures are no counts out of 400 flights; 83, or a multiple of it, is the only number of
flights up to 400 that gives both.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from statistics import fmean
from types import MappingProxyType
from typing import Literal

from scenegen_trainers.campaign.statistics import Rate, wilson

Method = Literal["conventional", "proposed"]
METHODS: tuple[Method, Method] = ("conventional", "proposed")

LEFT_OUT = "city"
"""The map that the paper's averages leave out."""


@dataclass(frozen=True)
class Published:
    """A row of Table 2.

    Attributes
    ----------
    title : str
        As the paper calls the map.
    percent : mapping of method to float
        Printed collision rates [%].
    counts : mapping of method to int
        Collisions they come from.
    flights : int
        Out of so many.
    """

    title: str
    percent: Mapping[Method, float]
    counts: Mapping[Method, int]
    flights: int

    def rate(self, method: Method) -> Rate:
        """The rate with Wilson's interval."""
        return wilson(self.counts[method], self.flights)


def _row(title: str, percent: tuple[float, float], counts: tuple[int, int], flights: int) -> Published:
    return Published(
        title, dict(zip(METHODS, percent, strict=True)), dict(zip(METHODS, counts, strict=True)), flights
    )


PUBLISHED: Mapping[str, Published] = MappingProxyType(
    {
        "city": _row("City environment", (57.83, 51.81), (48, 43), 83),
        "coastline": _row("Coastline", (51.25, 31.75), (205, 127), 400),
        "neighborhood": _row("Neighborhood", (1.00, 0.50), (4, 2), 400),
        "field": _row("Soccer Field", (5.50, 5.25), (22, 21), 400),
    }
)
"""By the map of ours that stands for it."""

PRINTED_AVERAGE: Mapping[Method, float] = MappingProxyType({"conventional": 19.25, "proposed": 12.50})
"""The paper's last row [%]."""


def published_mean(method: Method, maps: Iterable[str]) -> float | None:
    """Mean of the printed rates over some maps [%]; None unless the paper flew all of them."""
    names = list(maps)
    if not names or not all(name in PUBLISHED for name in names):
        return None
    return fmean(PUBLISHED[name].percent[method] for name in names)


def published_words(percent: float) -> str:
    """A rate as the paper prints them: two digits, halves rounded up."""
    return f"{percent + 1e-9:.2f} %"
