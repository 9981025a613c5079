"""Table 2: the conventional and the proposed method, oracle and blind, and whoever else, on the same missions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from statistics import fmean
from types import MappingProxyType

from scenegen.foundation.errors import InputError
from scenegen_trainers.campaign import results as campaign_results
from scenegen_trainers.campaign.recipe import FlightRecipe
from scenegen_trainers.campaign.record import BatchRecord
from scenegen_trainers.campaign.report.page import write_page
from scenegen_trainers.campaign.results import Results
from scenegen_trainers.campaign.run import Campaign, Progress, run
from scenegen_trainers.campaign.statistics import Paired, Rate, mcnemar, wilson
from scenegen_trainers.campaign.store import BASE_POINT
from scenegen_trainers.campaign.summary import Line, duel
from scenegen_trainers.campaign.worker import check_pilot
from scenegen_trainers.pilots.spec import PilotSpec, parse_pilot
from scenegen_trainers.tables.entrants import Entrant, check_sizes
from scenegen_trainers.tables.names import BOUNDS
from scenegen_trainers.tables.table2_paper import LEFT_OUT, METHODS, Method

FLIGHTS_DIR = "flights"
"""The campaign, below the table's directory."""

FLIGHTS: Mapping[str, int] = MappingProxyType({"ci": 6, "small": 100, "paper": 400})
"""Missions of each map, by profile."""


@dataclass(frozen=True, eq=False)
class Table2Job:
    """What to fly.

    Attributes
    ----------
    out : Path
    recipe : FlightRecipe
        Of `scenegen_trainers.tables.table2_recipe.flight_recipe`.
    conventional, proposed : Entrant
    flights : int
        Missions of each map.
    planner : str
    processes : int
    profile : str
        For the title.
    dataset : mapping of str to str
        Whose test worlds these are; empty if none was named.
    allow_mixed : bool
    others : tuple of Entrant
        Further networks on the same missions, each held against both methods.
    """

    out: Path
    recipe: FlightRecipe
    conventional: Entrant
    proposed: Entrant
    flights: int
    planner: str
    processes: int
    profile: str
    dataset: Mapping[str, str]
    allow_mixed: bool = False
    others: tuple[Entrant, ...] = ()

    @property
    def entrants(self) -> tuple[Entrant, ...]:
        """All networks: both methods, then the others."""
        return self.conventional, self.proposed, *self.others

    @cached_property
    def campaign(self) -> Campaign:
        """The flights.

        Raises
        ------
        InputError
            If the checkpoints do not fit the camera or each other.
        """
        check_sizes(*self.entrants)
        words = (*(str(entrant.path) for entrant in self.entrants), *BOUNDS)
        pilots = tuple(parse_pilot(word, self.planner) for word in words)
        self._refuse_twins(pilots)
        for spec in pilots:
            check_pilot(spec, self.recipe)
        return Campaign(
            recipe=self.recipe,
            points={BASE_POINT: self.recipe},
            pilots=pilots,
            flights=self.flights,
            root=self.out / FLIGHTS_DIR,
            processes=self.processes,
            allow_mixed=self.allow_mixed,
            names=(*(entrant.name for entrant in self.entrants), *BOUNDS),
        )

    def _refuse_twins(self, pilots: Sequence[PilotSpec]) -> None:
        """One network twice would be one pilot with two names."""
        names: dict[str, str] = {}
        for entrant, spec in zip(self.entrants, pilots, strict=False):
            if spec.sha256 in names:
                raise InputError(f"{entrant.flag}: is the {names[spec.sha256]} network itself")
            names[spec.sha256] = entrant.name


@dataclass(frozen=True, eq=False)
class Table2:
    """What came of it.

    Attributes
    ----------
    job : Table2Job
    lines : mapping of (str, str) to Line
        By map and pilot.
    duels : mapping of (str, str, str) to Paired
        Mission by mission, by map and the two compared: conventional against proposed, and each method against each
        other network.
    failed : mapping of str to str
        Batches that could not be flown, and why.
    """

    job: Table2Job
    lines: Mapping[tuple[str, str], Line]
    duels: Mapping[tuple[str, str, str], Paired]
    failed: Mapping[str, str]

    @property
    def maps(self) -> tuple[str, ...]:
        """As they were flown."""
        return self.job.recipe.dataset.map

    @property
    def averaged(self) -> tuple[str, ...]:
        """Maps that the paper's average would hold."""
        return tuple(map for map in self.maps if map != LEFT_OUT)

    def rate(self, pilot: str, maps: Iterable[str]) -> Rate:
        """Collisions of all flights over some maps together."""
        rates = [self.lines[map, pilot].collision for map in maps]
        return wilson(sum(rate.count for rate in rates), sum(rate.of for rate in rates))

    def mean(self, pilot: str, maps: Iterable[str]) -> float | None:
        """Mean of the maps' rates, as the paper averages; None where a map has no flight."""
        rates = [self.lines[map, pilot].collision for map in maps]
        return fmean(rate.share for rate in rates) if rates and all(rate.of for rate in rates) else None

    def paired(self, maps: Iterable[str], first: Method = METHODS[0], second: str = METHODS[1]) -> Paired:
        """Two networks over some maps together, mission by mission; both methods unless others are named."""
        duels = [self.duels[map, first, second] for map in maps]
        only_first, only_second = sum(d.first_only for d in duels), sum(d.second_only for d in duels)
        return Paired(
            sum(d.both for d in duels),
            only_first,
            only_second,
            sum(d.neither for d in duels),
            mcnemar(only_first, only_second),
        )


def run_table2(job: Table2Job, told: Callable[[Progress], None] = lambda progress: None) -> Table2:
    """Fly what is missing, then collect. Writes the campaign's own files, too.

    Parameters
    ----------
    job : Table2Job
    told : callable
        Hears of progress.

    Raises
    ------
    InputError
        If the checkpoints do not fit, or the directory holds something else.
    """
    campaign = job.campaign
    failed = run(campaign, told)
    found = campaign_results.gather(campaign)
    campaign_results.write(campaign, found)
    write_page(campaign, found)
    return tabled(job, found, failed)


def tabled(job: Table2Job, found: Results, failed: Mapping[str, str]) -> Table2:
    """The table that the results of a job's campaign make."""
    lines = {(line.map, line.pilot): line for line in found.lines}
    pairs: list[tuple[str, str]] = [
        METHODS,
        *((method, other.name) for other in job.others for method in METHODS),
    ]
    duels = {
        (map, *pair): duel(BASE_POINT, map, *((name, _records(found, map, name)) for name in pair)).paired
        for map in job.recipe.dataset.map
        for pair in pairs
    }
    return Table2(job, lines, duels, failed)


def _records(found: Results, map: str, name: str) -> list[BatchRecord]:
    return [record for _, record in found.flown[BASE_POINT, map, name]]
