"""Estimators that are perfect, backwards, or say near where it is far."""

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from scenegen_datasets.audits.flow_quality import FlowAudit, FlowQuality, grey_pair
from scenegen_datasets.audits.geometry import landing
from scenegen_datasets.audits.rank import spearman
from scenegen_datasets.audits.steps import Step

Answer = Callable[[np.ndarray, Step], np.ndarray]


def slanted(staged: ModuleType) -> Step:
    """A wall whose depth grows from left to right, passed sideways: flow is -f right / z exactly."""
    step = staged.wall()
    depth = np.broadcast_to(np.linspace(5.0, 40.0, staged.SHAPE[1]), staged.SHAPE).astype(np.float32)
    now = replace(step.now, depth=depth)
    return replace(step, now=replace(now, flow=landing(now, step.next, step.K).flow.astype(np.float32)))


def judged(step: Step, answer: Callable[[np.ndarray], np.ndarray]) -> FlowQuality:
    assert step.now.flow is not None
    flow = answer(step.now.flow).astype(np.float32)
    audit = FlowAudit(np.random.default_rng(4), {"told": lambda first, second: flow})
    audit.see(step)
    return audit.result()


def test_the_staged_flow_is_the_closed_form(staged: ModuleType) -> None:
    step = slanted(staged)
    assert step.now.flow is not None
    np.testing.assert_allclose(step.now.flow[..., 0], -64.0 * 0.5 / step.now.depth, rtol=1e-5)


def test_the_truth_is_judged_perfect(staged: ModuleType) -> None:
    found = judged(slanted(staged), lambda flow: flow)
    group = found.groups[0]
    assert found.verdict.level == "fine"
    assert (group.error_px, group.inverted_share) == (0.0, 0.0)
    assert group.order == pytest.approx(1.0) and group.heading == pytest.approx(1.0)


def test_a_constant_error_is_its_length(staged: ModuleType) -> None:
    assert judged(slanted(staged), lambda flow: flow + np.float32([3.0, 4.0])).groups[
        0
    ].error_px == pytest.approx(5.0)


def test_far_things_with_the_longer_flow_are_inverted(staged: ModuleType) -> None:
    found = judged(slanted(staged), lambda flow: flow[:, ::-1])
    group = found.groups[0]
    assert group.order == pytest.approx(-1.0) and group.true_order == pytest.approx(1.0)
    assert group.heading == pytest.approx(1.0)  # they point the right way all the same
    assert group.inverted_share == 1.0
    assert found.verdict.level == "note" and "near where it is far" in found.verdict.headline


def test_stored_flow_that_points_backwards_is_a_fault(staged: ModuleType) -> None:
    found = judged(slanted(staged), lambda flow: -flow)
    assert found.groups[0].heading == pytest.approx(-1.0)
    assert found.groups[0].inverted_share == 1.0
    assert found.verdict.level == "fault"


def test_opencv_finds_the_flow_of_a_textured_wall(staged: ModuleType) -> None:
    audit = FlowAudit(np.random.default_rng(4))
    audit.see(staged.wall())
    found = {group.estimator: group for group in audit.result().groups if group.frames == "all"}
    assert set(found) == {"Farneback", "DIS"}
    for group in found.values():
        assert group.true_px == pytest.approx(1.6, abs=1e-3)  # 64 px * 0.5 m / 20 m
        assert group.error_px is not None and group.error_px < 0.3
        assert group.heading is not None and group.heading > 0.95


def test_without_flow_it_says_so(staged: ModuleType) -> None:
    audit = FlowAudit(np.random.default_rng(4))
    step = staged.wall()
    audit.see(replace(step, now=replace(step.now, flow=None)))
    assert audit.result().verdict.level == "skipped"


def test_a_pair_shares_one_gain() -> None:
    now = np.tile(np.arange(3000, 3100, dtype=np.uint16), (50, 1))
    first, second = grey_pair(now, now + np.uint16(10))
    np.testing.assert_allclose(first[:, 30].astype(int), second[:, 20].astype(int))


def test_spearman_of_closed_forms() -> None:
    x = np.linspace(0.1, 5.0, 400)
    assert spearman(x, np.exp(x)) == pytest.approx(1.0)
    assert spearman(x, 1.0 / x) == pytest.approx(-1.0)
    assert spearman(x, np.ones_like(x)) is None
    # with ties, by hand: ranks 1.5 1.5 3 4 against 1 2 3 4
    assert spearman(np.array([1, 1, 2, 3]), np.array([1, 2, 3, 4])) == pytest.approx(4.5 / np.sqrt(4.5 * 5.0))
