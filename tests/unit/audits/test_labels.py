"""Label consistency against a wall whose flow is known by hand."""

from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from scenegen_datasets.audits.labels import LabelAudit, LabelConsistency
from scenegen_datasets.audits.steps import Step


def judged(rng: np.random.Generator, step: Step) -> LabelConsistency:
    audit = LabelAudit(rng)
    audit.see(step)
    return audit.result()


@pytest.mark.parametrize(("right_m", "ahead_m"), [(0.5, 0.0), (0.0, 2.0), (-0.4, 1.5)])
def test_true_labels_agree(
    staged: ModuleType, rng: np.random.Generator, right_m: float, ahead_m: float
) -> None:
    found = judged(rng, staged.wall(right_m=right_m, ahead_m=ahead_m))
    assert found.verdict.level == "fine"
    assert found.flow_px.top is not None and found.flow_px.top < 1e-4
    assert found.depth_share.top is not None and found.depth_share.top < 1e-5
    assert found.cycle_px.top is not None and found.cycle_px.top < 1e-3
    assert found.warped_mK.median is not None and found.still_mK.median is not None
    assert found.warped_mK.median < 0.2 * found.still_mK.median


def test_a_shifted_flow_shows_its_residual(staged: ModuleType, rng: np.random.Generator) -> None:
    step = staged.wall()
    assert step.now.flow is not None
    moved = replace(step.now, flow=step.now.flow + np.float32([1.5, -2.0]))
    found = judged(rng, replace(step, now=moved))
    assert found.verdict.level == "fault" and "2.50 px" in found.verdict.words
    for spread in (found.flow_px, found.cycle_px):
        assert spread.median == pytest.approx(2.5, abs=1e-3)


def test_a_scaled_depth_is_seen_by_depth_and_flow(staged: ModuleType, rng: np.random.Generator) -> None:
    step = staged.wall(ahead_m=2.0)
    found = judged(rng, replace(step, now=replace(step.now, depth=np.float32(1.1) * step.now.depth)))
    # 22 m - 2 m = 20 m is expected where 18 m stand
    assert found.depth_share.median == pytest.approx(0.1, abs=1e-3)
    assert found.verdict.level == "fault"


def test_a_flow_towards_the_past_explains_the_picture_worse_than_none(
    staged: ModuleType, rng: np.random.Generator
) -> None:
    step = staged.wall()
    assert step.now.flow is not None
    found = judged(rng, replace(step, now=replace(step.now, flow=-step.now.flow)))
    assert "worse than not following it" in found.verdict.words


def test_what_moves_of_itself_is_not_held_against_the_poses(
    staged: ModuleType, rng: np.random.Generator
) -> None:
    step = staged.wall()
    assert step.now.flow is not None and step.now.semantic is not None
    flow, classes = step.now.flow.copy(), step.now.semantic.copy()
    flow[40:50, 40:60, 0] += 5.0
    classes[40:50, 40:60] = 20  # a car
    found = judged(rng, replace(step, now=replace(step.now, flow=flow, semantic=classes)))
    assert found.flow_px.top is not None and found.flow_px.top < 1e-4


def test_sky_flows_by_rotation_alone(staged: ModuleType, rng: np.random.Generator) -> None:
    step = staged.wall()
    sky = np.full(staged.SHAPE, np.inf, np.float32)
    still = replace(step.now, depth=sky, flow=np.zeros((*staged.SHAPE, 2), np.float32))
    found = judged(rng, replace(step, now=still, next=replace(step.next, depth=sky)))
    assert found.sky_px.top == pytest.approx(0.0, abs=1e-6) and found.flow_px.count == 0


def test_without_flow_it_says_so(staged: ModuleType, rng: np.random.Generator) -> None:
    step = staged.wall()
    assert judged(rng, replace(step, now=replace(step.now, flow=None))).verdict.level == "skipped"
