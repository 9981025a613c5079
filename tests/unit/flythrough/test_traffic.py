"""Flights keep clear of movers, at the poses and in between."""

from __future__ import annotations

import numpy as np

from scenegen.geometry.modelling import Modeller
from scenegen.geometry.template import place
from scenegen.movers.clock import Clock
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import Pace, ring_route
from scenegen_flythrough.traffic import keeps_clear, reaches_of

TIMES = (np.arange(40) - 1.0) * 0.1


def cart(speed_mps: float = 10.0) -> Mover:
    """A box of 4 x 2 x 1.5 m that drives round a square of 100 m, eastwards along y = 0 first."""
    model = Modeller()
    model.box((-2.0, -1.0, 0.0), (2.0, 1.0, 1.5), 0, 1)
    zero = np.zeros((1, 3))
    body = place(model.finish(), zero, zero[:, 0], np.ones((1, 3)), np.zeros((1, 1), np.int64), np.array([7]))
    ring = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
    pace = Pace(speed_mps, 50.0, 50.0, 0.5, leans=False)
    return Mover("cart", body, ring_route(ring, lambda xy: np.zeros(len(xy)), pace))


def beside(mover: Mover, gap_m: float, start_s: float = 3.0) -> np.ndarray:
    """A path that rides along at a distance from its left side, 1 m above the ground."""
    poses = np.stack([mover.route.pose(float(t)) for t in start_s + TIMES])
    return np.asarray(poses[:, :3, 3] + poses[:, :3, 1] * (1.0 + gap_m) + [0.0, 0.0, 1.0])


def test_a_path_that_rides_along_is_clear_only_beyond_the_clearance():
    mover, clock = cart(), Clock(3.0)
    assert keeps_clear((mover,), clock, beside(mover, 1.1), TIMES, 1.0)
    assert not keeps_clear((mover,), clock, beside(mover, 0.9), TIMES, 1.0)


def test_it_depends_on_the_time_of_the_world():
    mover = cart()
    assert keeps_clear((mover,), Clock(15.0), beside(mover, 0.0), TIMES, 1.0)
    still = np.repeat(mover.route.pose(0.0)[None, :3, 3] + [0.0, 0.0, 1.0], len(TIMES), axis=0)
    assert not keeps_clear((mover,), Clock.stopped(), still, TIMES, 1.0)
    assert keeps_clear((mover,), Clock(5.0), still, TIMES, 1.0)


def test_a_mover_that_passes_between_two_poses_is_seen():
    mover = cart(30.0)
    times = np.array([-1.0, 0.0, 1.0])
    here = mover.route.pose(2.5)[:3, 3]
    hover = np.repeat((here + np.array([0.0, 1.5, 1.0]))[None], 3, axis=0)
    apart = [np.linalg.norm(mover.route.pose(2.0 + t)[:3, 3] - here) for t in times]
    assert min(apart) > 8.0  # far away at every pose
    assert not keeps_clear((mover,), Clock(2.0), hover, times, 1.0)


def test_movers_elsewhere_do_not_matter():
    path = beside(cart(), 0.0) + np.array([0.0, 500.0, 0.0])
    assert keeps_clear((cart(),), Clock(3.0), path, TIMES, 1.0)
    assert keeps_clear((), Clock(), path, TIMES, 1.0)


def test_a_mover_never_leaves_the_box_of_its_whole_round():
    mover = cart()
    (low, high) = reaches_of((mover,))[0]
    for second in np.arange(0.0, 40.0, 0.7):
        pose = mover.route.pose(float(second))
        corners = mover.body.vertices @ pose[:3, :3].T + pose[:3, 3]
        assert (corners >= low).all()
        assert (corners <= high).all()
    assert reaches_of(()).shape == (0, 2, 3)
