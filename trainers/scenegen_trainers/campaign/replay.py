"""A flight once more, as an animation: what the camera reported, what the pilot believed, what is there.

Nothing of a flight's images is kept. It is flown again, with its whole batch, from the same seeds; the outcome says
whether it was the same flight.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt16
from PIL import Image

from scenegen.foundation.atomic import make_directories, write_atomic
from scenegen.foundation.errors import InputError
from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen_datasets.pictures import colour
from scenegen_datasets.pictures.canvas import FAINT, INK, Canvas
from scenegen_datasets.workers import ENVIRONMENT
from scenegen_flythrough.loop.asking import Answer
from scenegen_flythrough.loop.pilot import Observation
from scenegen_render.sensor.agc import plateau_agc
from scenegen_trainers.campaign.eyes import Images
from scenegen_trainers.campaign.plan import Batch, batch_of
from scenegen_trainers.campaign.recipe import FlightRecipe
from scenegen_trainers.campaign.record import FlightRecord
from scenegen_trainers.campaign.report.ink import END_WORDS
from scenegen_trainers.campaign.run import Campaign, worker_setup
from scenegen_trainers.campaign.store import REPLAYS, CampaignStore
from scenegen_trainers.campaign.worker import Airfield, settle
from scenegen_trainers.pilots.spec import PilotSpec

WORKER = "scenegen_trainers.campaign.replay:worker"
TILE_PX = 320
_HEAD_PX, _FOOT_PX, _GAP_PX = 28, 26, 6
_MAX_GAIN = 2.5
_FAR_M = 100.0


@dataclass(eq=False)
class Tape:
    """What one flight saw and believed, decision by decision."""

    flight: int
    time_s: list[float] = field(default_factory=list)
    speed_mps: list[float] = field(default_factory=list)
    goal_m: list[float] = field(default_factory=list)
    counts: list[UInt16[np.ndarray, "rows columns"]] = field(default_factory=list)
    believed: list[Float32[np.ndarray, "rows columns"] | None] = field(default_factory=list)
    depth: list[Float32[np.ndarray, "rows columns"]] = field(default_factory=list)

    def witness(self, seen: Observation, answer: Answer, images: Images | None) -> None:
        """Record a decision, if the flight is still in the air."""
        rows = np.flatnonzero(seen.flight == self.flight)
        if len(rows) == 0 or images is None or images.counts is None:
            return
        k = int(rows[0])
        self.time_s.append(seen.time_s)
        self.speed_mps.append(float(np.linalg.norm(seen.velocity_mps[k])))
        self.goal_m.append(float(np.linalg.norm(seen.goal_m[k] - seen.position_m[k])))
        self.counts.append(images.counts[k].copy())
        self.believed.append(None if answer.depth_m is None else answer.depth_m[k].copy())
        self.depth.append(images.depth_m[k].copy())


def replay(campaign: Campaign, flight: int) -> list[Path]:
    """Fly a flight of every map, point and pilot once more and keep it as WebP.

    Raises
    ------
    InputError
        If a flight cannot be flown, or did not fare as before.
    """
    make_directories(campaign.root, REPLAYS)
    tasks = [
        Task(name, map, {"point": point, "pilot": k, "map": map, "flight": flight, "name": name})
        for map in campaign.plans
        for point in campaign.points
        for k, spec in enumerate(campaign.pilots)
        for name in [f"{map}-{flight:05d}-{point}-{spec.slug}.webp"]
    ]
    setup = {**worker_setup(campaign), "flights": campaign.flights}
    made = []
    with Pool(WORKER, setup, campaign.processes, environment=ENVIRONMENT) as pool:
        for event in pool.run(tasks):
            if isinstance(event, Done):
                made.append(campaign.root / REPLAYS / event.task.key)
            elif isinstance(event, Failed):
                raise InputError(f"flight {flight} cannot be replayed: {event.failure.message}")
    return sorted(made)


def worker(setup: Mapping[str, Any]) -> Callable[[dict[str, Any], Any], dict[str, Any]]:
    """Factory for `scenegen.foundation.pool.Pool`."""
    settle(setup["path"])
    recipes = {name: FlightRecipe.model_validate(plain) for name, plain in setup["points"].items()}
    pilots = [PilotSpec(**plain) for plain in setup["pilots"]]
    airfield, store = Airfield(), CampaignStore(Path(setup["root"]))

    def fly(payload: dict[str, Any], told: Any) -> dict[str, Any]:
        recipe, spec = recipes[payload["point"]], pilots[payload["pilot"]]
        batch = batch_of(payload["map"], payload["flight"], setup["flights"], recipe.campaign)
        tape, record = refly(airfield, recipe, spec, batch, payload["flight"])
        _check_same(store, payload["point"], spec, batch, record, recipe.loop.latency == "measured")
        write_atomic(store.root / REPLAYS / payload["name"], animate(tape, record, recipe, spec.name))
        return {}

    return fly


def refly(
    airfield: Airfield, recipe: FlightRecipe, spec: PilotSpec, batch: Batch, flight: int
) -> tuple[Tape, FlightRecord]:
    """Fly a batch again and keep what one of its flights saw."""
    tape = Tape(flight)
    sortie = airfield.sortie(recipe, batch)
    record = sortie.fly(airfield.pilot(spec, recipe), tape.witness, frozenset({"thermal", "depth"}))
    return tape, next(r for r in record.flights if r.flight == flight)


def animate(tape: Tape, record: FlightRecord, recipe: FlightRecipe, pilot: str) -> bytes:
    """Thermal, believed depth and true depth side by side, at the speed they were flown; one scale throughout."""
    counts = np.stack(tape.counts)
    levels = plateau_agc(counts.reshape(-1, counts.shape[-1]), max_gain=_MAX_GAIN).reshape(counts.shape)
    low, high = colour.depth_range([np.minimum(d, np.float32(_FAR_M)) for d in tape.depth])
    frames = [_frame(tape, k, levels[k], (low, high), pilot) for k in range(len(tape.time_s))]
    frames.append(_ending(frames[-1], record))
    step_ms = round(1e3 * recipe.loop.decision_s)
    file = io.BytesIO()
    durations = [*[step_ms] * (len(frames) - 1), 1800]
    frames[0].save(
        file,
        "WEBP",
        save_all=True,
        append_images=frames[1:],
        duration=durations,
        loop=0,
        quality=80,
        method=4,
    )
    return file.getvalue()


def _frame(tape: Tape, k: int, level: np.ndarray, span_m: tuple[float, float], pilot: str) -> Image.Image:
    rows, columns = tape.depth[k].shape
    height = max(1, round(TILE_PX * rows / columns))
    canvas = Canvas(3 * TILE_PX + 2 * _GAP_PX, _HEAD_PX + height + _FOOT_PX)
    believed = tape.believed[k]
    shown = colour.depth(tape.depth[k] if believed is None else believed, *span_m)
    tiles = (
        ("thermal", np.repeat(np.asarray(level)[..., None], 3, axis=2)),
        (f"what {pilot} believes", shown if believed is not None else np.zeros_like(shown)),
        (f"true depth, {span_m[0]:g} to {span_m[1]:g} m", colour.depth(tape.depth[k], *span_m)),
    )
    for column, (words, picture) in enumerate(tiles):
        x = column * (TILE_PX + _GAP_PX)
        canvas.text(x + 4, 19, words, 13, INK)
        tile = Image.fromarray(np.asarray(picture, np.uint8)).resize((TILE_PX, height))
        canvas.picture(x, _HEAD_PX, np.asarray(tile))
    facts = f"{tape.time_s[k]:5.1f} s    {tape.speed_mps[k]:4.1f} m/s    {tape.goal_m[k]:5.0f} m to the goal"
    canvas.text(4, _HEAD_PX + height + 18, facts, 12, FAINT)
    return canvas.image


def _ending(last: Image.Image, record: FlightRecord) -> Image.Image:
    """The last frame with how the flight ended written under it."""
    canvas = Canvas(*last.size)
    canvas.picture(0, 0, np.asarray(last))
    what = f" with {record.what.replace('_', ' ')}" if record.what else ""
    words = f"flight {record.flight}: {END_WORDS[record.kind]}{what} after {record.time_s:.1f} s"
    canvas.text(last.size[0] - 6, last.size[1] - 8, words, 13, INK, "rs")
    return canvas.image


def _check_same(
    store: CampaignStore, point: str, spec: PilotSpec, batch: Batch, record: FlightRecord, measured: bool
) -> None:
    """A flight flown again is the same flight, unless its latency was this machine's."""
    kept = store.read(point, spec.slug, batch)
    if kept is None or measured:
        return
    before = next((flight for flight in kept.flights if flight.flight == record.flight), None)
    if before is not None and before != record:
        raise InputError(
            f"flown again it {END_WORDS[record.kind]}, but in the campaign it {END_WORDS[before.kind]}: "
            "the machine or the software is another one"
        )
