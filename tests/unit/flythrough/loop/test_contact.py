"""First contact of swept spheres: closed forms, and brute force that shares no formula with the code."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from scenegen.geometry.modelling import Modeller
from scenegen.geometry.template import place
from scenegen.movers.company import Company
from scenegen.movers.gait import Gait
from scenegen.movers.mover import Mover
from scenegen.movers.rounds import Pace, ring_route
from scenegen.movers.route import Timetable, matrices
from scenegen_flythrough.loop.contact import Obstacles
from scenegen_flythrough.loop.moving_contact import TOLERANCE_M, MovingContact

RADIUS = 0.35


def cart(speed_mps: float = 10.0, corner_mps2: float = 50.0, number: int = 7) -> Mover:
    """A box of 4 x 2 x 1.5 m that drives round a square of 100 m, eastwards along y = 0 first."""
    model = Modeller()
    model.box((-2.0, -1.0, 0.0), (2.0, 1.0, 1.5), 0, 1)
    zero = np.zeros((1, 3))
    body = place(
        model.finish(), zero, zero[:, 0], np.ones((1, 3)), np.zeros((1, 1), np.int64), np.array([number])
    )
    ring = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
    pace = Pace(speed_mps, corner_mps2, 50.0, 0.5, leans=False)
    return Mover("cart", body, ring_route(ring, lambda xy: np.zeros(len(xy)), pace))


def strider() -> Mover:
    """A box whose vertices swing half a metre to and fro, twice a metre of way: a leg is never where it was."""
    one = cart(3.0)
    phase = 2.0 * np.pi * np.arange(16) / 16
    swing = 0.5 * np.sin(phase)[:, None] * np.sign(one.body.vertices[:, 1])
    cycle = np.repeat(one.body.vertices[None], 16, axis=0)
    cycle[..., 0] += swing
    return dataclasses.replace(one, gait=Gait(1.0, cycle.astype(np.float32)))


def to_box(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Distance of points to a box; 0 inside."""
    return np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=-1)


def followed(mover: Mover, start: np.ndarray, end: np.ndarray, t0: float, t1: float) -> tuple[float, float]:
    """Least distance to a rigid box on its route, and the share when the radius is first undercut; 0.1 ms steps."""
    share = np.linspace(0.0, 1.0, round((t1 - t0) / 1e-4) + 1)
    pose = matrices(Timetable.of([mover.route]).over(t0 + share * (t1 - t0))[:, 0])
    away = start + share[:, None] * (end - start) - pose[:, :3, 3]
    gap = to_box(np.einsum("ti,tij->tj", away, pose[:, :3, :3]), *mover.box_m)
    under = np.flatnonzero(gap < RADIUS)
    return float(gap.min()), float(share[under[0]]) if len(under) else np.inf


def test_what_stands_is_named(city, city_obstacles):
    labelled = dataclasses.replace(
        city.world,
        face_object=np.arange(len(city.world.mesh.faces), dtype=np.uint32),
        face_semantic=np.full(len(city.world.mesh.faces), 10, np.uint8),
    )
    obstacles = Obstacles(labelled, city_obstacles.proximity)
    low, high = city.boxes[0]
    middle = 0.5 * (low + high)
    start = np.array([[low[0] - 3.0, middle[1], 4.0], [middle[0], middle[1], high[2] + 40.0]])
    end = np.array([[low[0] + 3.0, middle[1], 4.0], [middle[0], middle[1], high[2] + 39.0]])
    found = obstacles.first_contacts(start, end, 0.0, 0.1, RADIUS)
    assert found.share[0] == pytest.approx((3.0 - RADIUS) / 6.0, abs=1e-5)
    assert np.isinf(found.share[1])
    corner = city.world.mesh.vertices[city.world.mesh.faces[found.object[0]]]
    np.testing.assert_allclose(corner[:, 0], low[0], atol=1e-4)  # the western wall
    assert found.semantic.tolist() == [10, 0]


def test_spheres_swept_through_boxes_agree_with_brute_force(city, city_obstacles):
    """Densely sampled points against boxes and ground: no miss, no false hit beyond a centimetre."""
    rng = np.random.default_rng(5)
    starts = np.column_stack([rng.uniform(-140, 140, (4000, 2)), rng.uniform(0.4, 30.0, 4000)])
    low, high = city.boxes[:, 0], city.boxes[:, 1]
    inside = ((starts[:, None] > low - 0.4) & (starts[:, None] < high + 0.4)).all(axis=2).any(axis=1)
    starts = starts[~inside][:2000]
    ends = starts + rng.normal(size=(len(starts), 3)) * 1.5
    ends[:, 2] = np.maximum(ends[:, 2], -0.3)
    share = city_obstacles.first_contacts(starts, ends, 0.0, 0.1, RADIUS).share
    around = 0.5 + np.linalg.norm(ends - starts, axis=1)
    row, box = np.nonzero(
        (
            (starts[:, None] > low - around[:, None, None]) & (starts[:, None] < high + around[:, None, None])
        ).all(axis=2)
    )
    truth = np.minimum(starts[:, 2], ends[:, 2])
    for s in np.linspace(0.0, 1.0, 801):
        place = (starts + s * (ends - starts))[row]
        gap = np.maximum(np.maximum(low[box] - place, place - high[box]), 0.0)
        np.minimum.at(truth, row, np.sqrt((gap**2).sum(axis=1)))
    assert np.isfinite(share[truth < RADIUS]).all()
    assert np.isinf(share[truth > RADIUS + 0.01]).all()
    assert 100 < np.isfinite(share).sum() < 1900


@pytest.mark.parametrize("step_s", [0.02, 0.3])
def test_contact_with_a_vehicle_that_drives_and_turns(step_s):
    """Random spheres around a cart, in the straight and in its corners, against steps of a tenth of a millisecond."""
    mover = cart(8.0, 4.0)
    contact, rng = MovingContact(Company.of([mover])), np.random.default_rng(2)
    hits = 0
    for k in range(60):
        time_s = float(rng.uniform(0.0, mover.route.round_s))
        start = mover.route.pose(time_s)[:3, 3] + rng.normal(0.0, 1.0, 3) * (2.0, 1.5, 0.5) + [0.0, 0.0, 1.5]
        end = start + rng.normal(0.0, 1.0, 3) * 12.0 * step_s
        start[2], end[2] = max(start[2], 0.1), max(end[2], 0.1)  # the cart has no underside
        share, index = contact.first(start[None], end[None], time_s, time_s + step_s, RADIUS)
        least, first = followed(mover, start, end, time_s, time_s + step_s)
        pose = mover.route.pose(time_s)
        if to_box((start - pose[:3, 3]) @ pose[:3, :3], *mover.box_m) == 0.0:
            continue  # begun inside: the shell is what counts there, not the box
        if least < RADIUS:
            assert share[0] <= first + 1e-9, k
        elif least > RADIUS + 0.01:
            assert np.isinf(share[0]), k
        assert index[0] == (0 if np.isfinite(share[0]) else -1)
        hits += bool(np.isfinite(share[0]))
    assert 5 < hits < 55


def test_no_tunnelling_through_a_fast_thin_mover():
    """Two ends of a step far on both sides of a cart that crosses at right angles."""
    mover = cart(20.0)
    here = mover.route.pose(2.55)[:3, 3]
    start, end = np.add(here, [0.0, -4.0, 0.7]), np.add(here, [0.0, 4.0, 0.7])
    contact = MovingContact(Company.of([mover]))
    share, _ = contact.first(start[None], end[None], 2.5, 2.6, RADIUS)
    least, first = followed(mover, start, end, 2.5, 2.6)
    assert least < RADIUS
    assert first - 0.006 <= share[0] <= first
    far = np.array([0.0, 0.0, 30.0])
    assert np.isinf(contact.first((start + far)[None], (end + far)[None], 2.5, 2.6, RADIUS)[0][0])


def test_a_hovering_drone_is_run_over():
    mover = cart(10.0)
    hover = (mover.route.pose(3.0)[:3, 3] + [0.0, 0.0, 1.0])[None]
    contact = MovingContact(Company.of([mover]))
    share, _ = contact.first(hover, hover, 2.0, 3.0, RADIUS)
    truth = 1.0 - (2.0 + RADIUS) / 10.0
    assert truth - 2 * TOLERANCE_M / 10.0 <= share[0] <= truth + 1e-6
    assert np.isinf(contact.first(hover, hover, 2.0, 2.7, RADIUS)[0][0])


def test_limbs_count_where_they_are():
    """Against vertices of `Company.vertices` on the swinging side: the box of rest would be half a metre off."""
    mover = strider()
    company = Company.of([mover])
    contact, rng = MovingContact(company), np.random.default_rng(4)
    verdicts = set()
    for _ in range(16):
        t0 = float(rng.uniform(0.0, 30.0))
        t1 = t0 + 0.05
        tip = company.vertices(t0)
        nose = tip[np.argmax(tip[:, 0])] if mover.route.pose(t0)[0, 0] > 0.9 else tip[0]
        start = nose + rng.normal(0.0, 0.5, 3)
        end = start + rng.normal(0.0, 0.3, 3)
        share = contact.first(start[None], end[None], t0, t1, RADIUS)[0][0]
        least = min(
            float(hull_distance(start + s * (end - start), company, t0 + s * 0.05))
            for s in np.linspace(0.0, 1.0, 51)
        )
        if least < RADIUS - 1e-6:
            assert share <= 1.0
        elif least > RADIUS + 0.01:
            assert np.isinf(share)
        verdicts.add(bool(np.isfinite(share)))
    assert verdicts == {True, False}


def hull_distance(point: np.ndarray, company: Company, time_s: float) -> float:
    """Distance to triangles by dense sampling of their barycentric coordinates, then refined around the best."""
    corner = company.vertices(time_s)[company.body.faces]
    best = np.inf
    grid = np.array(
        [(u, v) for u in np.linspace(0, 1, 21) for v in np.linspace(0, 1, 21) if u + v <= 1 + 1e-9]
    )
    place = corner[:, :1] + grid[:, :1] * (corner[:, 1:2] - corner[:, :1])
    place = place + grid[None, :, 1:] * (corner[:, 2:] - corner[:, :1])
    gap = np.linalg.norm(place - point, axis=2)
    face, k = np.unravel_index(gap.argmin(), gap.shape)
    centre, width = grid[k], 0.05
    for _ in range(6):
        u, v = (centre[:, None] + np.linspace(-width, width, 11)).clip(0.0, 1.0)
        uv = np.array([(a, b) for a in u for b in v if a + b <= 1 + 1e-9])
        near = corner[face, 0] + uv[:, :1] * (corner[face, 1] - corner[face, 0])
        near = near + uv[:, 1:] * (corner[face, 2] - corner[face, 0])
        gaps = np.linalg.norm(near - point, axis=1)
        best, centre, width = min(best, float(gaps.min())), uv[gaps.argmin()], width / 4.0
    return best


def test_the_earlier_of_two_contacts_counts(city):
    """A cart in front of a wall is met before the wall."""
    low, high = city.boxes[0]
    mover = cart(0.5, number=77)
    here = mover.route.pose(0.0)[:3, 3]
    world = dataclasses.replace(city.world, movers=(mover,))
    obstacles = Obstacles(world)
    wall = np.array([low[0], 0.5 * (low[1] + high[1]), 1.0])
    start = np.stack([wall - [4.0, 0.0, 0.0], np.add(here, [-5.0, 0.0, 0.8])])
    end = np.stack([np.add(wall, [1.0, 0.0, 0.0]), np.add(here, [5.0, 0.0, 0.8])])
    found = obstacles.first_contacts(start, end, 0.0, 0.05, RADIUS)
    assert np.isfinite(found.share).all()
    assert found.object[1] == 77
    assert found.semantic[1] == 1
    assert obstacles.distance(here[None] + [0.0, 0.0, 2.5], 0.0, 3.0)[0] == pytest.approx(1.0, abs=0.05)
