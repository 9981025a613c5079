"""From a plan to outcomes on disk: fly what is missing, one file per batch. Idempotent; may be killed at any moment."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError, NoSpaceError
from scenegen.foundation.lock import DirectoryLock
from scenegen.foundation.pool import Done, Failed, Note, Pool, Strike, Task
from scenegen_datasets.place import make_directory
from scenegen_datasets.run import JobError
from scenegen_datasets.run_log import RunLog, machine
from scenegen_datasets.workers import ENVIRONMENT
from scenegen_trainers.campaign.plan import Batch, batches
from scenegen_trainers.campaign.recipe import FlightRecipe
from scenegen_trainers.campaign.store import BASE_POINT, CampaignStore, check_output
from scenegen_trainers.campaign.sweep import Point
from scenegen_trainers.pilots.spec import PilotSpec

WORKER = "scenegen_trainers.campaign.worker:worker"
"""What a worker process does."""

SHARE_FROM = 2
"""A world is built a second time by another worker if at least this many of its batches are open."""


@dataclass(frozen=True, eq=False)
class Campaign:
    """What to fly, where to keep it.

    Attributes
    ----------
    recipe : FlightRecipe
        The recipe without what is swept.
    points : mapping of str to FlightRecipe
        Points of a sweep by name; a campaign that sweeps nothing has one, `BASE_POINT`.
    pilots : tuple of PilotSpec
        One or several; the first two are compared.
    flights : int
        Of each pilot over each map, at each point.
    root : Path
    processes : int
    sweep : tuple of Point
        What `points` differ by.
    allow_mixed : bool
        Add to flights that other software flew.
    names : tuple of str
        What tables call the pilots; empty calls them by file or name.
    """

    recipe: FlightRecipe
    points: Mapping[str, FlightRecipe]
    pilots: tuple[PilotSpec, ...]
    flights: int
    root: Path
    processes: int
    sweep: tuple[Point, ...] = ()
    allow_mixed: bool = False
    names: tuple[str, ...] = ()

    @property
    def swept(self) -> bool:
        """Whether it has more than the one plain point."""
        return set(self.points) != {BASE_POINT}

    @cached_property
    def plans(self) -> Mapping[str, tuple[Batch, ...]]:
        """Batches of each map; the same for all pilots and points."""
        knobs = self.recipe.campaign
        return {map: batches(map, self.flights, knobs) for map in self.recipe.dataset.map}

    @property
    def total(self) -> int:
        """Flights there are to fly."""
        return self.flights * len(self.plans) * len(self.points) * len(self.pilots)

    def everything(self) -> Iterator[tuple[str, int, Batch]]:
        """Every batch there is to fly: point, pilot, batch; those of a world follow each other."""
        for plan in self.plans.values():
            for batch in plan:
                for point in self.points:
                    for pilot in range(len(self.pilots)):
                        yield point, pilot, batch


@dataclass(frozen=True)
class Progress:
    """How far a campaign is.

    Attributes
    ----------
    flown, flights : int
        Flights, those of earlier runs included.
    here : int
        Flights of this run.
    what : str
        What happened last, in words.
    """

    flown: int
    flights: int
    here: int
    what: str = ""


Told = Callable[[Progress], None]


def run(campaign: Campaign, told: Told) -> dict[str, str]:
    """Fly what is missing.

    Parameters
    ----------
    campaign : Campaign
    told : callable
        Hears of progress.

    Returns
    -------
    dict of str to str
        Batches that could not be flown, and why.

    Raises
    ------
    InputError
        If the directory cannot be used, or the recipe asks for something no world can give.
    NoSpaceError
        If the device is full.
    """
    make_directory(campaign.root)
    check_output(campaign.root)
    store = CampaignStore(campaign.root)
    with DirectoryLock(campaign.root):
        store.open(campaign.recipe, allow_mixed=campaign.allow_mixed)
        missing = [
            (point, pilot, batch)
            for point, pilot, batch in campaign.everything()
            if store.read(point, campaign.pilots[pilot].slug, batch) is None
        ]
        with RunLog(campaign.root) as log:
            log.write(
                "start",
                missing=len(missing),
                processes=campaign.processes,
                machine=machine(),
                pilots=[spec.to_json() for spec in campaign.pilots],
            )
            failed = _fly(campaign, missing, log, told)
            log.write("end", failed=len(failed))
    return failed


Entry = tuple[str, int, Batch]
"""Point, pilot and batch."""


@dataclass
class _Tally:
    """What became of the flights so far."""

    flown: int
    total: int
    here: int = 0
    failed: dict[str, str] = field(default_factory=dict)

    def progress(self, what: str = "") -> Progress:
        return Progress(self.flown, self.total, self.here, what)


def _fly(campaign: Campaign, missing: Sequence[Entry], log: RunLog, told: Told) -> dict[str, str]:
    """Fly, and once more with networks in boxes where a process went down with its batch."""
    tally = _Tally(campaign.total - sum(batch.count for _, _, batch in missing), campaign.total)
    told(tally.progress())
    died = _fly_all(campaign, missing, log, told, tally, boxed=False)
    if died:
        _fly_all(campaign, died, log, told, tally, boxed=True)
    return tally.failed


def _fly_all(
    campaign: Campaign, entries: Sequence[Entry], log: RunLog, told: Told, tally: _Tally, *, boxed: bool
) -> list[Entry]:
    """Fly batches; returns those that took their process down and are worth a box."""
    tasks = {task.key: (task, entry) for entry in entries for task in [_task(campaign, *entry, boxed=boxed)]}
    died: list[Entry] = []
    with Pool(
        WORKER,
        worker_setup(campaign),
        campaign.processes,
        environment=ENVIRONMENT,
        share_from=SHARE_FROM,
        silence_s=60.0 + 2.0 * campaign.recipe.loop.patience_s,
    ) as pool:
        for event in pool.run([task for task, _ in tasks.values()]):
            if isinstance(event, Note):
                told(tally.progress(_words(event)))
                continue
            if isinstance(event, Done):
                log.write("batch", batch=event.task.key, **event.value)
                tally.flown += event.value["flights"]
                tally.here += event.value["flights"]
            elif isinstance(event, Strike | Failed):
                log.write("strike", batch=event.task.key, boxed=boxed, **asdict(event.failure))
            if isinstance(event, Failed):
                entry = tasks[event.task.key][1]
                if event.failure.died and not boxed and campaign.pilots[entry[1]].kind != "name":
                    died.append(entry)
                else:
                    _stop_if_hopeless(event, tally.here)
                    tally.failed[event.task.key] = event.failure.message
            told(tally.progress())
    return died


def worker_setup(campaign: Campaign) -> dict[str, Any]:
    """What every worker process of a campaign is told once, as plain data."""
    return {
        "root": str(campaign.root.resolve()),
        "path": str(Path.cwd()),
        "points": {name: recipe.model_dump(mode="json") for name, recipe in campaign.points.items()},
        "pilots": [spec.to_json() for spec in campaign.pilots],
    }


def _task(campaign: Campaign, point: str, pilot: int, batch: Batch, *, boxed: bool) -> Task:
    key = f"{point}/{batch.map}/{campaign.pilots[pilot].slug}/{batch.name}"
    payload = {"point": point, "pilot": pilot, "batch": asdict(batch), "boxed": boxed}
    return Task(key, f"{batch.map}-{batch.world}", payload)


def _words(note: Note) -> str:
    point, map, pilot, _ = note.task.key.split("/")
    where = map if point == BASE_POINT else f"{map} {point}"
    if "flying" in note.data:
        return f"{where}, {pilot}: {note.data['flying']} in the air"
    return f"{where}, {pilot}: building world {note.data['stage'].rpartition(' ')[2]}"


def _stop_if_hopeless(event: Failed, flown: int) -> None:
    """A user's error would fail every batch; so would a bug that fails the very first."""
    failure = event.failure
    if failure.exit_code == NoSpaceError.exit_code:
        raise NoSpaceError(failure.message)
    if failure.exit_code == InputError.exit_code:
        raise InputError(failure.message)
    if flown == 0:
        raise JobError(f"no flight can be flown: {failure.message}")
