"""What no flight may do: start inside anything, overlook a wire, or go on for ever where there is no room."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from routes import positions, solid_distance
from scenegen.foundation.errors import InputError, RejectedDrawError
from scenegen.foundation.rng import stream
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import FlightKnobs


def test_open_to_sky_knows_inside_from_outside(city, city_air: Airspace) -> None:
    """1,000 poses of known truth, half of them inside closed boxes and below roofs."""
    rng = np.random.default_rng(4)
    houses = city.boxes[::2]
    chosen = houses[rng.integers(len(houses), size=500)]
    low, high = chosen[:, 0] + 0.6, chosen[:, 1] - 0.6
    low[:, 2] = 1.0
    inside = low + rng.random((500, 3)) * (high - low)
    outside = np.empty((0, 3))
    while len(outside) < 500:
        draw = rng.uniform([-130, -130, 1.0], [130, 130, 80.0], (500, 3))
        column = city.boxes.copy()
        column[:, 1, 2] = np.maximum(column[:, 1, 2], 0.0)
        outside = np.concatenate([outside, draw[solid_distance(column, draw) > 0.5]])[:500]
    verdict = city_air.open_to_sky(np.concatenate([inside, outside]), 0.5)
    assert not verdict[:500].any()
    assert verdict[500:].all()


def test_no_flight_starts_inside_a_closed_hall(build_city) -> None:
    """A hall wide enough to fly in, and nothing else free: every draw is rejected, and the message says why."""
    hall = build_city(np.array([[[-150.0, -150.0, -1.0], [150.0, 150.0, 60.0]]]))
    knobs = FlightKnobs(styles="explore", height_m=20.0, max_draws=64)
    with pytest.raises(RejectedDrawError, match="open sky"):
        fly(hall.world, knobs, 16, stream(1), Airspace(hall.world))


def test_too_tight_a_world_is_given_up_with_advice(build_city) -> None:
    x, y = np.meshgrid(np.arange(-148.0, 148.0, 4.0), np.arange(-148.0, 148.0, 4.0))
    low = np.stack([x.ravel(), y.ravel(), np.full(x.size, -1.0)], axis=1)
    forest = build_city(np.stack([low, low + np.array([1.0, 1.0, 31.0])], axis=1))
    knobs = FlightKnobs(styles="explore", height_m=(5.0, 10.0), clearance_m=1.8, max_draws=96)
    with pytest.raises(RejectedDrawError, match=r"no free flight of 65 m .* 96 draws .* less clearance"):
        fly(forest.world, knobs, 64, stream(1), Airspace(forest.world))


def test_a_clip_needs_a_frame(city, city_air: Airspace) -> None:
    with pytest.raises(InputError, match="at least one frame"):
        fly(city.world, FlightKnobs(), 0, stream(1), city_air)
    assert fly(city.world, FlightKnobs(), 1, stream(1), city_air).time_s.shape == (3,)


def test_an_airspace_of_another_world_is_refused(city, hills_air: Airspace) -> None:
    with pytest.raises(AssertionError, match="another world"):
        fly(city.world, FlightKnobs(), 3, stream(1), hills_air)


@pytest.fixture(scope="module")
def net(build_city) -> Airspace:
    """Wires of 2 cm, 12 m apart both ways, 10 m above a plain: too thin to steer around, easy to step over."""
    at = np.arange(-144.0, 150.0, 12.0)
    wires = [[[x, -150.0, 10.0], [x + 0.02, 150.0, 10.02]] for x in at]
    wires += [[[-150.0, y, 10.0], [150.0, y + 0.02, 10.02]] for y in at]
    return Airspace(build_city(np.array(wires)).world)


def test_no_wire_between_two_frames_is_overlooked(net: Airspace) -> None:
    """Steps of 5 m: a wire is crossed between frames far more often than touched at one, also in the last step."""
    knobs = FlightKnobs(styles="explore", height_m=10.0, climb_deg=0.0, spacing_m=5.0, clearance_m=0.3)
    share = np.linspace(0, 1, 200)[:, None]
    searched = 0
    for index in range(40):
        trajectory = fly(net.world, knobs, 1, stream(6, index), net)
        points = np.concatenate([a + share * (b - a) for a, b in pairwise(positions(trajectory))])
        nearest = (np.abs((points[:, :2] + 6.0) % 12.0 - 6.0)).min()  # in the plane of the wires
        assert nearest >= knobs.clearance_m - 0.03
        searched += trajectory.rejected
    assert searched > 40  # most draws do cross a wire


def test_a_flight_longer_than_a_mesh_of_the_net_is_impossible(net: Airspace) -> None:
    knobs = FlightKnobs(
        styles="explore", height_m=10.0, climb_deg=0.0, spacing_m=5.0, clearance_m=0.3, max_draws=128
    )
    with pytest.raises(RejectedDrawError):
        fly(net.world, knobs, 8, stream(6), net)


def test_rejected_draws_are_counted_one_by_one(net: Airspace) -> None:
    """Allowing exactly one draw more than were rejected gives the same flight; allowing no more gives none."""
    knobs = FlightKnobs(styles="explore", height_m=10.0, climb_deg=0.0, spacing_m=4.0, clearance_m=0.3)
    counts = []
    for index in range(12):
        trajectory = fly(net.world, knobs, 1, stream(8, index), net)
        counts.append(trajectory.rejected)
        enough = knobs.model_copy(update={"max_draws": trajectory.rejected + 1})
        again = fly(net.world, enough, 1, stream(8, index), net)
        assert again.world_from_camera.tobytes() == trajectory.world_from_camera.tobytes()
        if trajectory.rejected:
            with pytest.raises(RejectedDrawError, match=f"after {trajectory.rejected} draws"):
                short = knobs.model_copy(update={"max_draws": trajectory.rejected})
                fly(net.world, short, 1, stream(8, index), net)
    assert len(set(counts)) > 3
