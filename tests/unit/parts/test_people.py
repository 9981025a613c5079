"""People: feet on the ground, heights of people, limbs that move in step, clothes for the season."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.geometry.part import face_areas
from scenegen.parts.people.body import BOTTOM, HAIR, SHIN, SHOE, SKIN, SLEEVE, TOP, body
from scenegen.parts.people.outfit import outfits
from scenegen.parts.people.posture import HEIGHT_M, POSTURES, SEAT_M, SHIN_M, THIGH_M, pose
from scenegen.parts.people.stand import stand

PHASES = np.arange(10) / 10
SLOTS = (SKIN, HAIR, TOP, SLEEVE, BOTTOM, SHIN, SHOE)


@pytest.mark.parametrize("posture", POSTURES)
def test_somebody_touches_the_ground(posture):
    for phase in PHASES:
        assert body(posture, float(phase)).vertices[:, 2].min() == pytest.approx(0.0, abs=0.03)


def test_standing_is_as_tall_as_a_person_and_sitting_fits_a_seat():
    standing, sitting = body("standing"), body("sitting")
    assert np.ptp(standing.vertices[:, 2]) == pytest.approx(HEIGHT_M, abs=0.02)
    assert 0.4 < np.ptp(standing.vertices[:, 1]) < 0.62
    seat = sitting.vertices[np.unique(sitting.faces[sitting.slot == BOTTOM])]
    assert seat[seat[:, 0] < 0.1, 2].min() == pytest.approx(SEAT_M, abs=0.05)
    assert 1.25 < sitting.vertices[:, 2].max() < 1.45


@pytest.mark.parametrize("posture", POSTURES)
def test_bones_keep_their_length(posture):
    for phase in PHASES:
        joints = pose(posture, float(phase))
        assert np.allclose(np.linalg.norm(joints.knee - joints.hip, axis=1), THIGH_M)
        assert np.allclose(np.linalg.norm(joints.ankle - joints.knee, axis=1), SHIN_M)


@pytest.mark.parametrize("posture", ["walking", "running"])
def test_legs_take_turns_and_arms_swing_against_them(posture):
    now, later = pose(posture, 0.2), pose(posture, 0.7)
    assert np.allclose(now.ankle[0, [0, 2]], later.ankle[1, [0, 2]])
    assert np.ptp([pose(posture, float(p)).ankle[0, 0] for p in PHASES]) > 0.5
    leg = np.array([pose(posture, float(p)).knee[0, 0] for p in PHASES])
    arm = np.array([pose(posture, float(p)).elbow[0, 0] for p in PHASES])
    assert np.corrcoef(leg, arm)[0, 1] < -0.7


@pytest.mark.parametrize("posture", POSTURES)
def test_all_phases_share_their_triangles(posture):
    first = body(posture, 0.0)
    for phase in PHASES[1:]:
        other = body(posture, float(phase))
        assert np.array_equal(first.faces, other.faces) and np.array_equal(first.slot, other.slot)
        assert face_areas(other.vertices, other.faces).min() > 1e-5


def test_a_body_is_closed_cheap_and_looks_outwards(facing_inside):
    template = body("standing")
    corner = template.vertices[template.faces]
    volume = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() / 6
    assert 0.04 < volume < 0.09  # a cubic metre weighs a tonne: 40 to 90 kg
    assert facing_inside(template, SLOTS) < 0.12  # the ends of limbs inside the trunk
    assert 250 <= len(template.faces) <= 700 and len(template.site_position) <= 12
    assert set(np.unique(template.slot)) == set(SLOTS)
    assert set(np.unique(template.semantic)) == {int(Semantic.PERSON)}


def test_standing_people_are_people_of_many_sizes(workshop, row):
    shop = workshop()
    parts = stand(row(200), np.zeros(200), "standing", shop, np.random.default_rng(1), children=0.25)
    height = {}
    for part in parts:
        for k in np.unique(part.object):
            height[int(k)] = part.vertices[np.unique(part.faces[part.object == k]), 2].max()
    tall = np.array([height[k] for k in sorted(height)])
    assert len(tall) == 200 and tall.min() > 0.95 and tall.max() < 2.0
    assert 0.15 < (tall < 1.47).mean() < 0.35
    assert 1.66 < np.median(tall[tall > 1.47]) < 1.78


@pytest.mark.parametrize(
    ("season", "coats", "bare"),
    [(Season(60.0, 1, 15), (0.9, 1.0), 0.0), (Season(30.0, 7, 15), (0.0, 0.0), 0.8)],
)
def test_people_dress_for_the_season(season, coats, bare, workshop):
    shop = workshop(season=season)
    rows = outfits(400, shop, np.random.default_rng(2))
    names = np.array([s.material.name for s in shop.palette.surfaces()])
    assert coats[0] <= (names[rows[:, TOP]] == "clothing_winter").mean() <= coats[1]
    assert (names[rows[:, SLEEVE]] == "human_skin").mean() >= bare
    assert (names[rows[:, SKIN]] == "human_skin").all()
    if bare == 0.0:
        assert not (names[rows[:, SLEEVE]] == "human_skin").any()
    counts = [list(names).count(n) for n in names]
    assert max(counts) <= 4


def test_the_same_generator_makes_the_same_people(workshop, row, same):
    first, second = (
        stand(row(9), np.zeros(9), "walking", workshop(), np.random.default_rng(3)) for _ in range(2)
    )
    assert same(first, second)


def test_unknown_postures_are_refused(workshop, row):
    with pytest.raises(InputError, match="sitting"):
        stand(row(1), np.zeros(1), "siting", workshop(), np.random.default_rng(0))
    assert stand(row(0), np.zeros(0), "sitting", workshop(), np.random.default_rng(0)) == []
