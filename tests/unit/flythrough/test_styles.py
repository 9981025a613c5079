"""Each style does what its name says, in worlds whose boxes are known."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from pydantic import ValidationError

from scenegen.foundation.errors import RejectedDrawError
from scenegen.foundation.rng import stream
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.fly import fly
from scenegen_flythrough.knobs import STYLES, FlightKnobs
from scenegen_flythrough.trajectory import Trajectory


def flights(
    airspace: Airspace, style: str, count: int, frames: int = 65, **wishes: object
) -> list[Trajectory]:
    knobs = FlightKnobs.model_validate({"styles": style, **wishes})
    made = [fly(airspace.world, knobs, frames, stream(5, style, k), airspace) for k in range(count)]
    assert all(trajectory.style == style for trajectory in made)
    return made


def places(trajectory: Trajectory) -> np.ndarray:
    return trajectory.world_from_camera[:, :3, 3]


def course_deg(trajectory: Trajectory) -> np.ndarray:
    return np.degrees(np.unwrap(np.arctan2(trajectory.velocity_mps[:, 1], trajectory.velocity_mps[:, 0])))


def test_a_corridor_has_walls_on_both_sides_and_leads_between_them(city, city_air: Airspace) -> None:
    houses = city.boxes[::2]
    for trajectory in flights(city_air, "corridor", 6):
        path = places(trajectory)
        left = np.stack([-trajectory.velocity_mps[:, 1], trajectory.velocity_mps[:, 0]], axis=1)
        left /= np.linalg.norm(left, axis=1, keepdims=True)
        free = np.zeros((2, len(path)))
        for k, side in enumerate((1.0, -1.0)):
            reach = path[:, None, :2] + side * np.arange(0.0, 45.0, 0.25)[:, None] * left[:, None]
            low = (houses[:, 0, :2] <= reach[:, :, None]).all(axis=-1)
            hit = (low & (houses[:, 1, :2] >= reach[:, :, None]).all(axis=-1)).any(axis=2)
            free[k] = np.where(hit.any(axis=1), 0.25 * hit.argmax(axis=1), np.inf)
        walled = np.isfinite(free).all(axis=0)
        assert walled.mean() > 0.4
        assert free.sum(axis=0)[walled].min() > 6.0
        assert np.ptp(course_deg(trajectory)) < 60.0  # along, not around
        assert path[:, 2].max() < 16.0


def test_a_survey_goes_back_and_forth_on_parallel_lanes_at_one_height(hills_air: Airspace) -> None:
    wishes = {"survey": {"lane_m": 12, "length_m": 30}, "wind_mps": 0}
    for trajectory in flights(hills_air, "survey", 4, frames=200, height_m=(30, 40), **wishes):
        course = course_deg(trajectory)
        straight = np.abs(np.gradient(course)) < 0.5
        lanes = (course[straight] - course[straight][0]) / 180.0
        assert np.abs(lanes - np.round(lanes)).max() < 0.08  # forth or back, nothing between
        assert np.count_nonzero(np.diff(np.round(lanes))) >= 3  # turns
        across = np.radians(course[straight][0] + 90.0)
        offset = places(trajectory)[straight, :2] @ [np.cos(across), np.sin(across)]
        lane = np.round((offset - offset[0]) / 12.0)
        np.testing.assert_allclose(np.abs(offset - offset[0] - 12.0 * lane), 0.0, atol=1.0)
        look = np.degrees(np.arcsin(trajectory.body_from_camera[2, 2]))
        assert -40.0 <= look <= -15.0


def test_an_orbit_keeps_its_distance_and_its_eye_on_something_tall(city, city_air: Airspace) -> None:
    for trajectory in flights(city_air, "orbit", 6, wind_mps=0, orbit={"radius_m": (15, 40)}):
        xy = places(trajectory)[:, :2]
        design = np.column_stack([2 * xy, np.ones(len(xy))])
        east, north, rest = np.linalg.lstsq(design, (xy**2).sum(axis=1), rcond=None)[0]
        radius = np.sqrt(rest + east**2 + north**2)
        assert 14.0 < radius < 41.0
        np.testing.assert_allclose(np.hypot(*(xy - [east, north]).T), radius, atol=0.3)
        towards = np.array([east, north]) - xy
        ahead = trajectory.world_from_camera[:, :2, 2]
        cosine = (
            (towards * ahead).sum(axis=1) / np.linalg.norm(towards, axis=1) / np.linalg.norm(ahead, axis=1)
        )
        assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 20.0
        house = (
            (city.boxes[:, 0, :2] - 3 <= [east, north]) & (city.boxes[:, 1, :2] + 3 >= [east, north])
        ).all(axis=1)
        assert house.any()


def test_terrain_following_hops_over_a_wall_and_comes_down_again(build_city) -> None:
    wall = Airspace(build_city(np.array([[[-150.0, -4.0, -1.0], [150.0, 4.0, 12.0]]])).world)
    over = 0
    for trajectory in flights(
        wall, "terrain_follow", 8, wind_mps=0, terrain_follow={"height_m": 4}, height_m=(4, 40)
    ):
        path = places(trajectory)
        near = np.abs(path[:, 1]) < 4.0
        far = np.abs(path[:, 1]) > 64.0
        if near.any():
            over += 1
            assert path[near, 2].min() > 14.0  # four above twelve, to a layer
        if far.any():
            assert path[far, 2].max() < 5.0
        slope = trajectory.velocity_mps[:, 2] / np.linalg.norm(trajectory.velocity_mps[:, :2], axis=1)
        assert np.degrees(np.arctan(np.abs(slope).max())) < 16.0
    assert over >= 1


def test_waypoints_lead_up_and_down_and_around(city_air: Airspace) -> None:
    made = flights(city_air, "waypoints", 10)
    turned = [np.ptp(course_deg(trajectory)) for trajectory in made]
    climbed = [np.ptp(places(trajectory)[:, 2]) for trajectory in made]
    assert np.median(turned) > 40.0
    assert np.median(climbed) > 3.0
    for trajectory in made:  # faster on the legs than around the corners
        speed = np.linalg.norm(trajectory.velocity_mps, axis=1)
        turning = np.abs(np.gradient(course_deg(trajectory)))
        assert speed[np.argmax(turning)] < speed.max() + 1e-9
    slowed = [np.linalg.norm(t.velocity_mps, axis=1) for t in made]
    assert np.median([s.max() / s.min() for s in slowed]) > 1.3


def test_an_approach_ends_slowly_in_front_of_something(city, city_air: Airspace) -> None:
    made = flights(city_air, "approach", 8, height_m=(4, 12), approach={"stop_m": 4})
    heads_on = 0
    for trajectory in made:
        speed, path = np.linalg.norm(trajectory.velocity_mps, axis=1), places(trajectory)
        assert speed[-1] < 2.5
        assert speed[-1] == pytest.approx(speed.min(), rel=0.2)
        gap = np.maximum(np.maximum(city.boxes[:, 0] - path[-1], path[-1] - city.boxes[:, 1]), 0.0)
        assert 1.0 <= np.linalg.norm(gap, axis=1).min() < 9.0
        nearest = int(np.argmin(np.linalg.norm(gap, axis=1)))
        towards = np.clip(path[-1], *city.boxes[nearest]) - path[-1]
        cosine = towards @ trajectory.velocity_mps[-1] / np.linalg.norm(towards) / speed[-1]
        heads_on += cosine > np.cos(np.radians(35.0))
    assert heads_on >= 6


def test_the_default_mix_flies_every_style_about_as_often_as_it_is_named(city_air: Airspace) -> None:
    knobs = FlightKnobs(spacing_m=0.5)
    flown = Counter(fly(city_air.world, knobs, 20, stream(6, k), city_air).style for k in range(64))
    assert set(flown) == set(STYLES) - {"recorded"}
    assert flown["explore"] > 8  # named twice among eight
    assert max(flown.values()) < 32


def test_a_style_without_a_place_gives_way_and_alone_it_says_so(build_city) -> None:
    plain = Airspace(build_city(np.zeros((0, 2, 3))).world)
    wishes = {"max_draws": 400}
    trajectory = fly(plain.world, FlightKnobs(styles=("corridor", "orbit", "explore")), 20, stream(1), plain)
    assert trajectory.style == "explore"
    for style in ("corridor", "orbit", "approach"):
        with pytest.raises(
            RejectedDrawError, match=r"400 the coarse map had nothing to offer for.* other styles"
        ):
            fly(plain.world, FlightKnobs.model_validate({"styles": style, **wishes}), 20, stream(1), plain)


def test_limits_that_nothing_can_hold_are_the_reason_given(city_air: Airspace) -> None:
    wishes = {"styles": "explore", "max_draws": 40, "wind_mps": 15, "limits": {"tilt_deg": 5}}
    with pytest.raises(RejectedDrawError, match="asked for more than the drone's limits"):
        fly(city_air.world, FlightKnobs.model_validate(wishes), 20, stream(1), city_air)


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        ({"styles": "exlore"}, "unknown style 'exlore'; perhaps you meant 'explore'"),
        ({"styles": []}, "name at least one style"),
        ({"styles": "recorded"}, "needs a file"),
        ({"wind_mps": 16}, "outside 0 to 15"),
        ({"limits": {"tilt_deg": 85}}, "less than or equal to 80"),
        ({"survey": {"pitch_deg": -91}}, "outside -90 to 30"),
        ({"orbit": {"radius": 4}}, "Extra inputs"),
    ],
)
def test_bad_wishes_are_refused_in_words(wish: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        FlightKnobs.model_validate(wish)
