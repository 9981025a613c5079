"""The depth-leak audit against worlds where depth is, or is not, a function of brightness."""

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from scenegen_datasets.audits.information import BINS, mutual_information, unrelated_information
from scenegen_datasets.audits.leak import DepthLeak, LeakAudit
from scenegen_datasets.audits.regressors import Curve, Plane, Sum

Paint = Callable[[np.random.Generator, tuple[int, int]], tuple[np.ndarray, np.ndarray]]


def judged(staged: ModuleType, paint: Paint, worlds: int = 6) -> DepthLeak:
    audit = LeakAudit(np.random.default_rng(1))
    for world in range(worlds):
        rng = np.random.default_rng(world)
        for _ in range(3):
            counts, depth = paint(rng, staged.SHAPE)
            base = staged.wall()
            still = replace(base.now, counts=counts.astype(np.uint16), depth=depth.astype(np.float32))
            audit.see(staged.step(still, base.next, f"wall-{world:05d}"))
    return audit.result()


def by_brightness(rng: np.random.Generator, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """The hotter the nearer, in every world alike."""
    counts = rng.integers(3000, 6000, shape)
    return counts, np.exp(6.0 - counts / 1500.0)


def by_row(rng: np.random.Generator, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """A flat ground, painted at random."""
    rows = np.broadcast_to(np.arange(shape[0])[:, None], shape)
    return rng.integers(3000, 6000, shape), 200.0 / (rows + 2.0)


def by_chance(rng: np.random.Generator, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    return rng.integers(3000, 6000, shape), np.exp(rng.normal(3.0, 1.0, shape))


def test_depth_as_a_function_of_brightness_is_called_leaky(staged: ModuleType) -> None:
    found = judged(staged, by_brightness)
    assert found.verdict.level == "fault" and found.verdict.headline.startswith("Yes")
    assert found.explained is not None and found.information is not None
    assert found.explained.one_pixel == pytest.approx(1.0, abs=1e-3)
    assert found.explained.linear == pytest.approx(1.0, abs=1e-6)
    assert found.information.grey > 4.0  # of log2(32) = 5 bit


def test_any_curve_is_found_not_only_a_line(staged: ModuleType) -> None:
    def bent(rng: np.random.Generator, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
        counts = rng.integers(3000, 6000, shape)
        return counts, np.exp(3.0 + np.sin(counts / 300.0))

    explained = judged(staged, bent).explained
    assert explained is not None
    assert explained.one_pixel > 0.98 and explained.linear < 0.3


def test_a_ground_is_told_by_its_row_and_is_no_leak(staged: ModuleType) -> None:
    found = judged(staged, by_row)
    assert found.verdict.level == "fine" and found.explained is not None and found.information is not None
    assert found.explained.row > 0.999
    assert abs(found.explained.brightness) < 0.01
    assert found.information.grey < 0.02 < 4.0 < found.information.row


def test_chance_explains_nothing(staged: ModuleType) -> None:
    found = judged(staged, by_chance)
    assert found.verdict.level == "fine" and found.explained is not None
    assert max(found.explained.brightness, found.explained.row, found.explained.row_and_grey) < 0.02


def test_what_holds_in_one_world_only_is_no_leak(staged: ModuleType) -> None:
    """In every second world the other way round."""
    audit = LeakAudit(np.random.default_rng(1))
    for world in range(6):
        counts = np.random.default_rng(world).integers(3000, 6000, staged.SHAPE)
        depth = np.exp(3.0 + (-1.0) ** world * (counts - 4500.0) / 1500.0)
        base = staged.wall()
        still = replace(base.now, counts=counts.astype(np.uint16), depth=depth.astype(np.float32))
        audit.see(staged.step(still, base.next, f"wall-{world:05d}"))
    found = audit.result()
    assert found.explained is not None and found.explained.brightness < 0.1


def test_one_clip_cannot_be_judged(staged: ModuleType) -> None:
    assert judged(staged, by_chance, worlds=1).verdict.level == "skipped"


def test_information_of_closed_forms() -> None:
    rng = np.random.default_rng(3)
    x = rng.uniform(size=200_000)
    assert mutual_information(x, x) == pytest.approx(np.log2(BINS), abs=0.01)
    assert mutual_information(x, rng.uniform(size=x.size)) < 1e-3
    z, noise, r = rng.normal(size=x.size), rng.normal(size=x.size), 0.8
    y = r * z + np.sqrt(1.0 - r**2) * noise
    # of two normal quantities: -log2(1 - r^2) / 2
    assert mutual_information(z, y) == pytest.approx(-0.5 * np.log2(1.0 - r**2), abs=0.03)
    # y is z and noise: once z is known in bands, little of z is left to tell, the noise tells the rest
    assert mutual_information(noise, y, given=z) > mutual_information(noise, y) + 0.3


def test_what_unrelated_pictures_seem_to_tell() -> None:
    """Pictures that differ as a whole tell of each other by chance, and the fewer there are the more."""
    rng = np.random.default_rng(4)
    found = []
    for pictures in (6, 600):
        picture = np.repeat(np.arange(pictures), 60_000 // pictures)
        warm, far = rng.normal(size=(2, pictures))[
            :, picture
        ]  # one draw a picture: nothing to do with each other
        a, b = warm + 0.3 * rng.normal(size=picture.size), far + 0.3 * rng.normal(size=picture.size)
        by_chance = unrelated_information(a, b, picture)
        assert by_chance == pytest.approx(mutual_information(a, b), rel=0.35, abs=0.01)
        found.append(by_chance)
    assert found[0] > 0.3 > 0.05 > found[1]
    a, noise, single = rng.normal(size=60_000), rng.normal(size=60_000), np.arange(60_000)
    b = a + 0.1 * noise  # each sample a picture of its own: a plain shuffle
    assert unrelated_information(a, b, single) < 2e-3 < 1.0 < mutual_information(a, b)


def test_samples_of_a_picture_need_not_be_equally_many() -> None:
    rng = np.random.default_rng(6)
    picture = np.repeat(np.arange(40), rng.integers(1, 400, 40))
    a = rng.normal(size=picture.size)
    assert 0.0 <= unrelated_information(a, a, picture) < 0.2 < mutual_information(a, a)


def test_regressors_find_what_they_can_express() -> None:
    rng = np.random.default_rng(5)
    x = rng.uniform(size=(20_000, 2))
    line = 3.0 * x[:, 0] - 2.0 * x[:, 1] + 1.0
    np.testing.assert_allclose(Plane.fit(x, line, (0, 1))(x), line, atol=1e-9)
    bend = np.sin(6.0 * x[:, 0])
    assert np.abs(Curve.fit(x, bend, 0)(x) - bend).max() < 0.03
    product = np.sign(x[:, 0] - 0.5) * np.sign(x[:, 1] - 0.5)  # nothing either tells alone
    assert (
        np.var(product - Sum.fit(x, product, (0, 1))(x))
        < 0.1
        < 0.95
        < np.var(product - Curve.fit(x, product, 0)(x))
    )
