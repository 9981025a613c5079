"""Many views in one launch, against the tracer's frames of the same poses: equal to the bit, whoever flies along."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from scenegen.movers.company import Company
from scenegen.thermal_state import ThermalState
from scenegen.world import World
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace import Tracer
from scenegen_render.trace.casting import around
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.scenery import Scenery, scenery
from scenegen_render.trace.views import Seen, Views

CAMERA = Camera.from_fov(112, 72, 90.0)
EVERYTHING = ("depth", "radiance", "semantic", "instance")
TIMES = (0.0, 7.3, 1234.5)


@pytest.fixture(scope="module")
def lit(peopled_loaded: LoadedWorld, peopled_state: ThermalState, sky_light: np.ndarray) -> Lit:
    tracer = Tracer(CAMERA, RenderKnobs())
    return tracer.light(peopled_loaded, peopled_state, sky_light, range(len(peopled_loaded.world.movers)))


@pytest.fixture(scope="module")
def shape(peopled_loaded: LoadedWorld) -> Scenery:
    return scenery(peopled_loaded)


def flock() -> np.ndarray:
    """Low over streets with traffic, high over the roofs, up into the sky, straight down, far away."""
    return np.stack(
        [
            looking((-5.0, -6.0, 4.0), 80.0, -20.0),
            looking((54.0, 20.0, 5.0), 100.0, -20.0),
            looking((20.0, -7.0, 2.0), 20.0, 0.0),
            looking((25.0, 55.0, 7.0), -170.0, -25.0),
            looking((0.0, 0.0, 80.0), 45.0, -30.0),
            looking((10.0, -6.0, 6.0), 0.0, 85.0),
            looking((25.0, -4.0, 12.0), 0.0, -90.0),
            looking((-150.0, -150.0, 20.0), 45.0, -5.0),
        ]
    )


def same(ours: Seen, k: int, other: object, names: Sequence[str], j: int | None = None) -> None:
    for name in names:
        theirs = getattr(other, name)
        theirs = theirs if j is None else theirs[j]
        assert getattr(ours, name)[k].tobytes() == np.ascontiguousarray(theirs).tobytes(), name


@pytest.mark.parametrize("sub_samples", [1, 4, 6])
def test_views_are_the_frames_of_their_poses(lit: Lit, shape: Scenery, sub_samples: int) -> None:
    knobs = RenderKnobs(sub_samples=sub_samples)
    views, tracer, poses = Views(CAMERA, knobs), Tracer(CAMERA, knobs), flock()
    moving = 0
    for time_s in TIMES:
        photographed = views.look(lit, poses, time_s, EVERYTHING)
        measured = views.look(shape, poses, time_s, ("depth", "semantic", "instance"))
        assert measured.radiance is None
        for k, pose in enumerate(poses):
            frame = tracer.frame(lit, pose, pose, None, (time_s,) * 3)
            same(photographed, k, frame, EVERYTHING)
            same(measured, k, frame, ("depth", "semantic", "instance"))
            moving += int(np.isin(frame.instance, [m.object for m in lit.loaded.world.movers]).sum())
    assert moving > 2_000
    assert np.isinf(measured.depth[5]).mean() > 0.5


def test_images_that_do_not_fill_packets_of_rays_are_the_frames_too(lit: Lit, shape: Scenery) -> None:
    """With 37 x 27 pixels, rays of two views share packets and tiles are cut; only a last bit may differ."""
    odd = Camera.from_fov(37, 27, 75.0)
    views, tracer, poses = Views(odd), Tracer(odd, RenderKnobs()), flock()
    photographed, measured = views.look(lit, poses, 7.3, EVERYTHING), views.look(shape, poses, 7.3)
    for k, pose in enumerate(poses):
        frame = tracer.frame(lit, pose, pose, None, (7.3,) * 3)
        np.testing.assert_array_equal(photographed.instance[k], frame.instance)
        np.testing.assert_allclose(photographed.radiance[k], frame.radiance, rtol=1e-6)
        for seen in (photographed, measured):
            np.testing.assert_allclose(seen.depth[k], frame.depth, rtol=3e-7)


def test_a_view_does_not_depend_on_who_flies_along(lit: Lit, shape: Scenery) -> None:
    views, poses = Views(CAMERA), flock()
    for place, want in ((shape, ("depth",)), (lit, ("depth", "radiance"))):
        together = views.look(place, poses, 3.0, want)
        backwards = views.look(place, poses[::-1].copy(), 3.0, want)
        for k in range(len(poses)):
            alone = views.look(place, poses[k : k + 1], 3.0, want)
            same(together, k, alone, want, 0)
            same(together, k, backwards, want, len(poses) - 1 - k)


def test_more_views_than_one_launch_may_hold_are_traced_in_several(
    lit: Lit, shape: Scenery, monkeypatch: pytest.MonkeyPatch
) -> None:
    views, poses = Views(CAMERA), flock()
    for place, want in ((shape, ("depth", "semantic")), (lit, EVERYTHING)):
        at_once = views.look(place, poses, 3.0, want)
        rays = CAMERA.width_px * CAMERA.height_px * (4 if "radiance" in want else 1)
        monkeypatch.setattr("scenegen_render.trace.views._MOST_RAYS", 3 * rays + 1)
        in_parts = views.look(place, poses, 3.0, want)
        monkeypatch.undo()
        for k in range(len(poses)):
            same(in_parts, k, at_once, want, k)
        assert (in_parts.radiance is None) == ("radiance" not in want)


def test_only_movers_that_somebody_sees_are_placed_and_they_are_where_the_company_has_them(
    peopled: World, shape: Scenery
) -> None:
    company = Company.of(peopled.movers)
    _, who = around(company, 3.0, CAMERA, flock()[:2])
    seen = np.isin(np.arange(len(company.movers)), who)
    assert 0 < len(who) < len(seen)
    some, all_ = company.vertices_of(who, 3.0), company.vertices(3.0)
    there = seen[company.owner]
    np.testing.assert_array_equal(some[there], all_[there])
    assert np.isnan(some[~there]).all()
    view = shape.troupe.seen_by_all(3.0, CAMERA, flock()[:2], mirrors=False)
    placed = view.instant.vertices.numpy().reshape(-1, 3)[-len(there) :]
    np.testing.assert_array_equal(np.isfinite(placed).all(axis=1), there)


def test_neither_the_number_of_views_nor_time_nor_movers_compile_a_kernel(
    lit: Lit, shape: Scenery, peopled_loaded: LoadedWorld
) -> None:
    _, dr = backend.modules()
    views, empty = Views(CAMERA), scenery(peopled_loaded, ())

    def kernels(place: Scenery, counts: Sequence[int], want: Sequence[str]) -> set[object]:
        dr.kernel_history_clear()
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            for k, count in enumerate(counts):
                views.look(place, flock()[:count], 2.0 * k, want)
            history = [entry for entry in dr.kernel_history() if entry["type"] == dr.KernelType.JIT]
        if "radiance" not in want:
            assert sum(entry["size"] >= CAMERA.width_px * CAMERA.height_px for entry in history) == len(
                counts
            )
        return {entry["hash"] for entry in history}

    one = kernels(shape, (3,), ("depth",))
    assert kernels(shape, (1, 2, 8), ("depth",)) == kernels(empty, (1, 5), ("depth",)) == one
    few = kernels(lit, (2,), EVERYTHING)
    assert kernels(lit, (1, 4, 8), EVERYTHING) == few


def test_radiance_of_a_world_without_heat_is_refused(shape: Scenery) -> None:
    with pytest.raises(ValueError, match="lit world"):
        Views(CAMERA).look(shape, flock()[:1], 0.0, ("radiance",))
