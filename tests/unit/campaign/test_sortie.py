"""What a batch does around its flights: telling pilots, hiding the truth, keeping the moment."""

import numpy as np
import pytest

import flown
from scenegen.climate.season import Season
from scenegen_flythrough.loop.missions import Missions
from scenegen_flythrough.loop.pilot import Command, Decision, Observation
from scenegen_render.camera import Camera
from scenegen_trainers.campaign.eyes import Images
from scenegen_trainers.campaign.moment import draw_moment
from scenegen_trainers.campaign.plan import batches
from scenegen_trainers.campaign.sortie import _began, _refused, _shown


class Hoverer:
    name = "hoverer"

    def __init__(self, *needs: str, fails: bool = False) -> None:
        self.needs, self.fails = frozenset(needs), fails

    def begin(self, flights: np.ndarray, seed: int) -> None:
        if self.fails:
            raise RuntimeError("not\ntoday")

    def act(self, seen: Observation) -> Decision:
        return Decision(Command(np.zeros((len(seen.flight), 3)), seen.yaw_rad))


TWO = np.zeros((2, 3))
MISSIONS = Missions(
    flight=np.array([4, 5]),
    start_m=TWO,
    goal_m=TWO,
    yaw_rad=TWO[:, 0],
    ceiling_m=TWO[:, 0],
    obstructed=np.zeros(2, np.bool_),
    wind=(),
)
SEEN = Observation(
    flight=MISSIONS.flight,
    time_s=0.0,
    position_m=TWO,
    velocity_mps=TWO,
    yaw_rad=np.array([0.1, 0.2]),
    goal_m=TWO,
    ceiling_m=TWO[:, 0],
    camera=Camera.from_fov(4, 3, 90.0),
    world_from_camera=np.zeros((2, 4, 4)),
)


IMAGES = Images(np.ones((2, 3, 4), np.float32), np.ones((2, 3, 4), np.uint16), np.zeros((2, 3, 4), np.uint16))


@pytest.mark.parametrize(
    ("needs", "shown"),
    [
        ((), set()),
        (("depth",), {"depth_m"}),
        (("thermal",), {"counts", "previous_counts"}),
        (("depth", "thermal"), {"depth_m", "counts", "previous_counts"}),
    ],
)
def test_nobody_is_shown_what_he_did_not_ask_for(needs: tuple[str, ...], shown: set[str]) -> None:
    """A replay traces everything; the pilot must fly as it did without."""
    assert set(_shown(Hoverer(*needs), IMAGES)) == shown
    assert _shown(Hoverer(*needs), None) == {}


def test_a_pilot_that_fails_at_the_start_fails_all_its_flights_with_the_reason() -> None:
    reason = _began(Hoverer(fails=True), MISSIONS, 1)
    assert reason == "raised RuntimeError at the start: not today"
    answer = _refused(SEEN, reason)
    assert answer.failed == {4: reason, 5: reason}
    assert not answer.command.velocity_mps.any()
    assert _began(Hoverer(), MISSIONS, 1) == ""


def test_batches_take_turns_at_the_hours_and_share_everything_else() -> None:
    season = Season(50.0, 7, 15)
    usual, asked = flown.recipe(), flown.recipe(campaign={"flights_per_batch": 4, "hours": [22.0, 4.0]})
    plan = batches("city", 16, usual.campaign)
    moments = [draw_moment(asked, season, batch) for batch in plan]
    assert [moment.hour for moment in moments] == [22.0, 4.0, 22.0, 4.0]
    drawn = [draw_moment(usual, season, batch) for batch in plan]
    assert len({moment.hour for moment in drawn}) == 4
    assert [m.weather for m in moments] == [m.weather for m in drawn]
    assert [m.clock for m in moments] == [m.clock for m in drawn]
    still = flown.recipe(movers=False)
    assert not draw_moment(still, season, plan[0]).clock.running
