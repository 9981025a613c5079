"""A campaign directory: made, opened again, grown. A batch is one file, there whole or not at all.

DIR/campaign.json                                    recipe and software; refuses others
DIR/flights/POINT/MAP/PILOT/00003.json               one batch flown by one pilot
DIR/results.json  flights.csv  flights.parquet       derived from them
DIR/index.html  replays/                             for people
DIR/run.log.jsonl                                    when, where, at what cost; differs from run to run
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from scenegen.foundation import canonical
from scenegen.foundation.atomic import make_directories, remove_partials, write_atomic
from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets import store
from scenegen_datasets.lock import fingerprint, recipe_id
from scenegen_datasets.recipe import SCENE_SEMANTICS
from scenegen_datasets.store import RUN_LOG, WRITER_LOCK, differing_keys
from scenegen_trainers.campaign.names import is_slug
from scenegen_trainers.campaign.plan import Batch
from scenegen_trainers.campaign.recipe import FlightRecipe
from scenegen_trainers.campaign.record import BatchRecord

SCHEMA = 1
"""Version of all files of a campaign; a reader refuses what is newer than itself."""

LOCK, RESULTS, CSV, PARQUET = "campaign.json", "results.json", "flights.csv", "flights.parquet"
PAGE, FLIGHTS, PLANS, REPLAYS = "index.html", "flights", "plans", "replays"
BASE_POINT = "base"
"""Name of the one point of a campaign that sweeps nothing."""

_OURS = (LOCK, RESULTS, CSV, PARQUET, PAGE, FLIGHTS, PLANS, REPLAYS, RUN_LOG, WRITER_LOCK)


class CampaignStore:
    """The files of one campaign.

    Parameters
    ----------
    root : Path
        Must exist.
    """

    def __init__(self, root: Path) -> None:
        self.root = root

    def open(self, recipe: FlightRecipe, *, allow_mixed: bool = False) -> None:
        """Make the directory a campaign's, or go on with the campaign in it. Call it with the lock held.

        Parameters
        ----------
        recipe : FlightRecipe
        allow_mixed : bool
            Go on although other software flew the flights that are there.

        Raises
        ------
        InputError
            If it holds something else, a campaign of another recipe, or one flown by other software; names what
            differs.
        """
        check_output(self.root)
        wanted = _lock(recipe)
        path = self.root / LOCK
        if path.exists():
            self._refuse_other(wanted, allow_mixed)
        else:
            write_atomic(path, canonical.pretty(wanted))
        folders = [p for name in (FLIGHTS, PLANS, REPLAYS) for p in (self.root / name).rglob("**/")]
        for directory in (self.root, *folders):
            remove_partials(directory)

    def commit(self, point: str, pilot: str, batch: Batch, record: BatchRecord) -> None:
        """Keep a batch: a kill loses it or keeps it, nothing between."""
        path = self._path(point, pilot, batch)
        make_directories(self.root, str(path.parent.relative_to(self.root)))
        write_atomic(path, canonical.pretty({"schema": SCHEMA, **record.to_json()}))

    def read(self, point: str, pilot: str, batch: Batch) -> BatchRecord | None:
        """A batch that was flown, cut to the flights asked for; None if it was not, not wholly, or is damaged."""
        path = self._path(point, pilot, batch)
        if not path.is_file() or path.is_symlink():
            return None
        try:
            value = canonical.read(path)
            record = BatchRecord.from_json(value, str(path))
        except DatasetError:
            return None
        if value.get("schema") != SCHEMA or record.world != batch.world:
            return None
        wanted = record.flights[: batch.count]
        if [flight.flight for flight in wanted] != list(batch.flights):
            return None
        return BatchRecord(record.world, record.hour, record.weather, record.season, wanted)

    def plan_path(self, map: str, world: int, ending: str = "webp") -> Path:
        """Of the map of a world."""
        assert is_slug(map), map
        return self.root / PLANS / f"{map}-{world:05d}.{ending}"

    def commit_plan(self, map: str, world: int, picture: bytes, frame: Mapping[str, Any]) -> None:
        """Keep the map of a world; the frame comes last and says that it is there."""
        make_directories(self.root, PLANS)
        write_atomic(self.plan_path(map, world), picture)
        write_atomic(self.plan_path(map, world, "json"), canonical.pretty(dict(frame)))

    def read_plan(self, map: str, world: int) -> tuple[bytes, Any] | None:
        """The map of a world and its frame; None if there is none."""
        try:
            return self.plan_path(map, world).read_bytes(), canonical.read(self.plan_path(map, world, "json"))
        except (OSError, DatasetError):
            return None

    def _path(self, point: str, pilot: str, batch: Batch) -> Path:
        for word in (point, batch.map, pilot):
            assert is_slug(word), word
        return self.root / FLIGHTS / point / batch.map / pilot / f"{batch.name}.json"

    def _refuse_other(self, wanted: dict[str, Any], allow_mixed: bool) -> None:
        held = canonical.read(self.root / LOCK)
        if (
            not isinstance(held, dict)
            or held.get("schema") != SCHEMA
            or not isinstance(held.get("recipe"), dict)
        ):
            raise InputError(f"{self.root / LOCK}: written by another version; choose another --out")
        asked = canonical.parse(canonical.canonical(wanted["recipe"]), "recipe")
        found = list(differing_keys(held["recipe"], asked))
        if found:
            raise InputError(
                f"{self.root} holds flights of another recipe ({'; '.join(found[:8])}); "
                "use the same one or another --out"
            )
        if held["recipe_id"] != wanted["recipe_id"]:
            raise InputError(f"{self.root} was flown when this recipe meant other scenes; use another --out")
        other = list(differing_keys(held.get("software"), wanted["software"]))
        if other and not allow_mixed:
            raise InputError(
                f"{self.root} was flown by other software ({'; '.join(other[:6])}); "
                "add --allow-mixed to accept that, or use another --out"
            )


def check_output(root: Path) -> None:
    """Refuse a directory that is not empty and not a campaign, and symbolic links under our names.

    Raises
    ------
    InputError
        With what stands in the way.
    """
    store.check_output(root, _OURS, LOCK, "campaign")


def _lock(recipe: FlightRecipe) -> dict[str, Any]:
    plain = recipe.canonical()
    versions = {name: version(name) for name in ("mitsuba", "drjit", "thermal-scenegen")}
    return {
        "schema": SCHEMA,
        "recipe": plain,
        "recipe_id": recipe_id(plain, SCENE_SEMANTICS),
        "software": fingerprint(versions),
    }


def batches_read(
    store: CampaignStore, point: str, pilot: str, plan: tuple[Batch, ...]
) -> Iterator[tuple[Batch, BatchRecord]]:
    """The batches of a plan that were flown, in order."""
    for batch in plan:
        record = store.read(point, pilot, batch)
        if record is not None:
            yield batch, record
