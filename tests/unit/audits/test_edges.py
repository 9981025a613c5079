"""The edge map of steps whose blur and shift are known."""

from dataclasses import replace
from types import ModuleType

import cv2
import numpy as np
import pytest

from scenegen_datasets.audits.edges import EdgeAudit, EdgeMap, silhouettes
from scenegen_datasets.audits.steps import Still


def posts(staged: ModuleType, blur_px: float = 0.0, shift_px: int = 0, warm: bool = True) -> Still:
    """Upright posts before a wall far away, their heat blurred and shifted against their depth."""
    post = np.broadcast_to((np.arange(staged.SHAPE[1]) // 16) % 2 == 1, staged.SHAPE)
    counts = np.where(post, 5200.0, 4000.0) if warm else np.where(post, 4000.0, 5200.0)
    counts = np.roll(counts, shift_px, axis=1)
    if blur_px:
        counts = cv2.GaussianBlur(counts, (0, 0), blur_px, sigmaY=1e-3)
    return replace(
        staged.wall().now,
        counts=np.rint(counts).astype(np.uint16),
        depth=np.where(post, 5.0, 60.0).astype(np.float32),
        instance=(post + 1).astype(np.uint32),
        radiance=None,
    )


def judged(staged: ModuleType, still: Still, times: int = 1) -> EdgeMap:
    audit = EdgeAudit(np.random.default_rng(2))
    for _ in range(times):
        audit.see(staged.step(still, staged.wall().next))
    return audit.result()


@pytest.mark.parametrize("warm", [True, False])
def test_a_sharp_edge_has_no_mixed_pixel(staged: ModuleType, warm: bool) -> None:
    found = judged(staged, posts(staged, warm=warm))
    assert found.verdict.level == "fine"
    assert found.mixed_pixels == 0.0
    np.testing.assert_allclose(found.profile, [1, 1, 1, 1, 0, 0, 0, 0], atol=1e-9)
    assert found.offset_right_px == pytest.approx(0.0, abs=1e-9)
    assert found.offset_down_px is None  # there is no level edge
    # every 16 px an edge with one pixel on either side: 2 of 16, less the border of the picture
    assert found.silhouette_share == pytest.approx(7 * 2 / 128)


def test_the_width_is_that_of_the_blur(staged: ModuleType) -> None:
    found = judged(staged, posts(staged, blur_px=0.8))
    weight = np.exp(-0.5 * (np.arange(-4, 5) / 0.8) ** 2)
    near, next_ = (
        weight[k:].sum() / weight.sum() for k in (5, 6)
    )  # half and one and a half pixels beyond the edge
    assert found.width_px == pytest.approx(2.0 * (0.5 + (near - 0.1) / (near - next_)), abs=0.01)
    assert found.offset_right_px == pytest.approx(0.0, abs=0.02)


def test_heat_beside_its_depth_is_a_fault(staged: ModuleType) -> None:
    still = posts(staged)
    step = np.broadcast_to(np.arange(staged.SHAPE[1]) >= 64, staged.SHAPE)
    depth = np.where(step, 60.0, 5.0).astype(np.float32)
    heat = np.where(np.roll(step, 1, axis=1) & step, 4000, 5200).astype(np.uint16)  # one pixel late
    aside = replace(still, depth=depth, counts=heat, instance=(step + 1).astype(np.uint32))
    found = judged(staged, aside, times=8)
    assert found.offset_right_px == pytest.approx(1.0, abs=1e-9)
    assert found.edges >= 400 and found.verdict.level == "fault"
    few = judged(staged, aside)
    assert few.edges < 400 and few.verdict.level == "note"  # a handful may all be of one thing


def test_level_edges_are_read_too(staged: ModuleType) -> None:
    step = np.broadcast_to((np.arange(staged.SHAPE[0]) >= 40)[:, None], staged.SHAPE)
    still = replace(
        posts(staged),
        counts=np.where(step, 5200, 4000).astype(np.uint16),
        depth=np.where(step, 5.0, np.inf).astype(np.float32),
        instance=step.astype(np.uint32),
    )
    found = judged(staged, still)
    assert found.offset_down_px == pytest.approx(0.0, abs=1e-9) and found.offset_right_px is None


def test_a_slope_is_no_silhouette(staged: ModuleType) -> None:
    rows = np.broadcast_to(np.geomspace(400.0, 4.0, staged.SHAPE[0])[:, None], staged.SHAPE)
    still = replace(staged.wall().now, depth=rows.astype(np.float32))
    assert not silhouettes(still).any()
    assert judged(staged, still).verdict.level == "skipped"
