"""A source of depth in a process of its own: the same answers, and deaths that cost no more than they must."""

from pathlib import Path

import numpy as np
import pytest

import crashing_pilot
from scenegen_flythrough.loop.asking import ask
from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_flythrough.loop.pilot import Observation
from scenegen_flythrough.loop.pilots import DepthPilot
from scenegen_render.camera import Camera
from scenegen_trainers.pilots.box import BoxedSource, observation, plain
from scenegen_trainers.pilots.spec import parse_pilot, raise_pilot

CAMERA = Camera.from_fov(16, 12, 90.0)
TESTS = Path(__file__).parents[2]


def seen(time_s: float, flights: int = 4) -> Observation:
    counts = np.arange(flights * 12 * 16, dtype=np.uint16).reshape(flights, 12, 16)
    places = np.tile(np.array([0.0, 0.0, 6.0]), (flights, 1))
    return Observation(
        flight=np.arange(flights),
        time_s=time_s,
        position_m=places,
        velocity_mps=np.zeros((flights, 3)),
        yaw_rad=np.zeros(flights),
        goal_m=places + np.array([50.0, 0.0, 0.0]),
        ceiling_m=np.full(flights, 20.0),
        camera=CAMERA,
        world_from_camera=np.tile(np.eye(4), (flights, 1, 1)),
        counts=counts,
        previous_counts=counts[:, ::-1],
    )


def test_an_observation_survives_the_pipe() -> None:
    what = seen(1.25)
    again = observation(plain(what), CAMERA)
    assert again.time_s == 1.25 and again.depth_m is None and again.camera == CAMERA
    for name in ("flight", "position_m", "yaw_rad", "world_from_camera", "counts", "previous_counts"):
        before, after = getattr(what, name), getattr(again, name)
        assert before.dtype == after.dtype and np.array_equal(before, after)


def test_a_death_costs_the_flights_that_were_asked_about(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(TESTS)
    monkeypatch.syspath_prepend(str(TESTS))
    spec = parse_pilot("crashing_pilot:Crashing", "straight")
    pilot = raise_pilot(spec, LoopKnobs(), CAMERA, boxed=True)
    assert isinstance(pilot, DepthPilot) and isinstance(pilot.source, BoxedSource)
    assert (pilot.name, pilot.needs) == ("crashing", frozenset())
    pilot.begin(np.arange(4), 0)
    answer = ask(pilot, seen(0.0), 600.0)
    assert answer.failed == {} and answer.depth_m is not None
    assert np.array_equal(answer.depth_m, crashing_pilot.Crashing().estimate(seen(0.0)))
    answer = ask(pilot, seen(1.0), 600.0)
    assert answer.failed == {2: "raised RuntimeError: its process was killed by SIGSEGV"}
    without = ask(pilot, seen(2.0).rows(np.array([0, 1, 3])), 600.0)
    assert without.failed == {}
    pilot.source.close()


def test_what_a_source_raises_in_its_box_is_what_it_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(TESTS)
    spec = parse_pilot("crashing_pilot:Crashing", "straight")
    source = BoxedSource("far", frozenset(), spec.to_json(), CAMERA)
    with pytest.raises(RuntimeError, match="ValueError: asked before the start"):
        source.estimate(seen(-1.0))
    source.close()
    gone = BoxedSource("far", frozenset(), {**spec.to_json(), "word": "crashing_pilot:Nobody"}, CAMERA)
    with pytest.raises(RuntimeError, match="Nobody"):
        gone.estimate(seen(0.0))
    gone.close()
