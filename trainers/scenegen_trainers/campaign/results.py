"""Everything a campaign found out, gathered from its batches: figures, comparisons, one row per flight."""

from __future__ import annotations

import csv
import importlib
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.atomic import remove, write_atomic
from scenegen_trainers.campaign.plan import Batch
from scenegen_trainers.campaign.record import BatchRecord
from scenegen_trainers.campaign.run import Campaign
from scenegen_trainers.campaign.statistics import CONFIDENCE
from scenegen_trainers.campaign.store import CSV, PARQUET, RESULTS, SCHEMA, CampaignStore, batches_read
from scenegen_trainers.campaign.summary import Duel, Line, duel, summarise

Flown = Mapping[tuple[str, str, str], Sequence[tuple[Batch, BatchRecord]]]
"""Batches by point, map and pilot."""


@dataclass(frozen=True, eq=False)
class Results:
    """What came of a campaign.

    Attributes
    ----------
    flown : mapping
        Batches by point, map and pilot (its label).
    lines : tuple of Line
        One per point, map and pilot.
    duels : tuple of Duel
        Of the first two pilots.
    """

    flown: Flown
    lines: tuple[Line, ...]
    duels: tuple[Duel, ...]


def labels(campaign: Campaign) -> tuple[str, ...]:
    """What the pilots are called in tables: as the campaign says, or as briefly as tells them apart."""
    pilots = campaign.pilots
    choices = (
        campaign.names,
        tuple(spec.name for spec in pilots),
        tuple(f"{spec.name} ({spec.planner})" for spec in pilots),
        tuple(f"{Path(spec.word).parent.name}/{spec.name} ({spec.planner})" for spec in pilots),
        tuple(f"{k}: {spec.name} ({spec.planner})" for k, spec in enumerate(pilots, 1)),
    )
    return next(names for names in choices if len(set(names)) == len(pilots))


def gather(campaign: Campaign) -> Results:
    """Read the batches of a campaign and sum them up."""
    store = CampaignStore(campaign.root)
    flown: dict[tuple[str, str, str], Sequence[tuple[Batch, BatchRecord]]] = {}
    lines: list[Line] = []
    duels: list[Duel] = []
    pilots = list(zip(labels(campaign), campaign.pilots, strict=True))
    for point in campaign.points:
        for map, plan in campaign.plans.items():
            sides = []
            for label, spec in pilots:
                found = list(batches_read(store, point, spec.slug, plan))
                records = [record for _, record in found]
                flown[point, map, label] = found
                lines.append(summarise(point, map, label, records))
                sides.append((label, records))
            if len(sides) > 1:
                duels.append(duel(point, map, sides[0], sides[1]))
    return Results(flown, tuple(lines), tuple(duels))


def write(campaign: Campaign, results: Results) -> tuple[Path, ...]:
    """Write ``results.json``, ``flights.csv`` and, where pyarrow is at hand, ``flights.parquet``."""
    root = campaign.root
    write_atomic(root / RESULTS, canonical.pretty(to_json(campaign, results)))
    rows = list(flight_rows(results))
    write_atomic(root / CSV, _csv(rows))
    parquet = _parquet(rows)
    if parquet is None:
        remove(root / PARQUET)
        return root / RESULTS, root / CSV
    write_atomic(root / PARQUET, parquet)
    return root / RESULTS, root / CSV, root / PARQUET


def to_json(campaign: Campaign, results: Results) -> dict[str, Any]:
    """Plain data of everything but the single flights."""
    return {
        "schema": SCHEMA,
        "flights_per_line": campaign.flights,
        "confidence": CONFIDENCE,
        "recipe": campaign.recipe.canonical(),
        "pilots": [
            {"label": label, "word": spec.word if spec.kind != "file" else Path(spec.word).name}
            | {"planner": spec.planner, "sha256": spec.sha256, "directory": spec.slug}
            for label, spec in zip(labels(campaign), campaign.pilots, strict=True)
        ],
        "points": list(campaign.points),
        "lines": [line.to_json() for line in results.lines],
        "comparisons": [duel.to_json() for duel in results.duels],
    }


def flight_rows(results: Results) -> Iterator[dict[str, Any]]:
    """One row per flight, plain values under the names of the columns."""
    for (point, map, pilot), found in results.flown.items():
        for batch, record in found:
            for flight in record.flights:
                yield {
                    "point": point,
                    "map": map,
                    "pilot": pilot,
                    "flight": flight.flight,
                    "world": record.world,
                    "batch": batch.index,
                    "hour": round(record.hour, 4),
                    "outcome": flight.kind,
                    "hit": flight.what,
                    "object": flight.object,
                    "reason": flight.reason,
                    "time_s": flight.time_s,
                    **_place("end", flight.place_m),
                    **_place("start", flight.start_m),
                    **_place("goal", flight.goal_m),
                    "obstructed": flight.obstructed,
                    "progress": flight.progress,
                    "mean_speed_mps": flight.mean_speed_mps,
                    "closest_m": flight.closest_m,
                    "latency_ms": round(1e3 * flight.latency_s, 3),
                    "decisions": flight.decisions,
                }


def _place(name: str, place: Sequence[float]) -> dict[str, float]:
    return {f"{name}_{axis}_m": value for axis, value in zip("xyz", place, strict=True)}


def _csv(rows: Sequence[Mapping[str, Any]]) -> bytes:
    file = io.StringIO()
    if rows:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return file.getvalue().encode()


def _parquet(rows: Sequence[Mapping[str, Any]]) -> bytes | None:
    """The rows as Parquet, or None where pyarrow is not installed or there is nothing to write."""
    try:
        arrow: Any = importlib.import_module("pyarrow")
        parquet: Any = importlib.import_module("pyarrow.parquet")
    except ImportError:
        return None
    if not rows:
        return None
    sink = arrow.BufferOutputStream()
    parquet.write_table(arrow.Table.from_pylist([dict(row) for row in rows]), sink, compression="zstd")
    return bytes(sink.getvalue())
