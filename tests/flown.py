"""Flights made up for tests: no world is built, nothing is flown."""

from pathlib import Path

from scenegen_datasets.resolve import Source
from scenegen_trainers.campaign.plan import Batch
from scenegen_trainers.campaign.recipe import FlightRecipe, resolve_flights
from scenegen_trainers.campaign.record import BatchRecord, FlightRecord
from scenegen_trainers.campaign.run import Campaign
from scenegen_trainers.campaign.store import BASE_POINT, CampaignStore
from scenegen_trainers.campaign.sweep import Point
from scenegen_trainers.pilots.spec import PilotSpec

ORACLE, BLIND = PilotSpec("name", "oracle", "waypoint"), PilotSpec("name", "blind", "waypoint")


def flight(number: int, kind: str = "goal", what: str = "", reason: str = "") -> FlightRecord:
    return FlightRecord(
        flight=number,
        kind=kind,
        time_s=12.5,
        place_m=(10.0, 20.0, 6.0),
        object=7 if what else 0,
        what=what,
        reason=reason,
        progress=1.0 if kind == "goal" else 0.4,
        mean_speed_mps=5.0,
        closest_m=None if number % 3 == 0 else 1.25,
        latency_s=0.1,
        decisions=60,
        start_m=(0.0, 0.0, 5.0),
        goal_m=(60.0, 0.0, 5.0),
        obstructed=number % 2 == 0,
        path=((0.0, 0.0, 0.0, 5.0), (6.0, 5.0, 11.0, 5.5), (12.5, 10.0, 20.0, 6.0)),
    )


def record(batch: Batch, crashes: tuple[int, ...] = ()) -> BatchRecord:
    flights = tuple(flight(k, "collision", "tree") if k in crashes else flight(k) for k in batch.flights)
    return BatchRecord(batch.world, 21.5, {"wind_mps": 3.0}, {"latitude_deg": 50.0}, flights)


def recipe(**keys: object) -> FlightRecipe:
    return resolve_flights([Source("", {"campaign": {"flights_per_batch": 4}, **keys})])


def campaign(
    root: Path,
    flights: int = 10,
    pilots: tuple[PilotSpec, ...] = (ORACLE, BLIND),
    sweep: tuple[Point, ...] = (),
    **keys: object,
) -> Campaign:
    base = recipe(**keys)
    points = {point.name: base for point in sweep} or {BASE_POINT: base}
    return Campaign(base, points, pilots, flights, root, 1, sweep)


def fill(asked: Campaign, crashes: dict[str, tuple[int, ...]]) -> CampaignStore:
    """Commit every batch of a campaign; `crashes` says by pilot which flights crash."""
    asked.root.mkdir(exist_ok=True)
    store = CampaignStore(asked.root)
    store.open(asked.recipe)
    for point, pilot, batch in asked.everything():
        spec = asked.pilots[pilot]
        store.commit(point, spec.slug, batch, record(batch, crashes.get(spec.name, ())))
    return store
