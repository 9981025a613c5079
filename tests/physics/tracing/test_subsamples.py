"""Any number of sub-samples gives the same picture up to its edges, mirrors and sky included."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.reference_scenes import looking
from scenegen_render.trace import Tracer

POSE = looking((-100.0, 2.0, 14.0), 4.0, -4.0)


@pytest.fixture(scope="module")
def shoot(loaded_city, warm_city, sky_light):
    plain = replace(warm_city, texture_K=np.zeros_like(warm_city.texture_K))

    def frame(count: int) -> Frame:
        tracer = Tracer(Camera.from_fov(160, 128, 70.0), RenderKnobs(sub_samples=count))
        return tracer.frame(tracer.light(loaded_city, plain, sky_light), POSE, POSE)

    return frame


@pytest.fixture(scope="module")
def finest(shoot) -> Frame:
    return shoot(64)


@pytest.mark.parametrize(
    ("count", "bound"), [(1, 0.07), (3, 0.04), (4, 0.03), (5, 0.025), (7, 0.02), (16, 0.012)]
)
def test_pictures_converge_without_bias(shoot, finest, count, bound):
    frame = shoot(count)
    error = frame.radiance / finest.radiance - 1.0
    assert np.sqrt((error**2).mean()) < bound
    assert abs(error.mean()) < 1e-3
    assert np.median(np.abs(error)) < 1e-3  # only edges differ


def test_labels_do_not_depend_on_the_number_of_sub_samples(shoot, finest):
    frame = shoot(4)
    for name in ("depth", "semantic", "instance", "material", "flow", "covisible", "temperature"):
        np.testing.assert_array_equal(getattr(frame, name), getattr(finest, name))


def test_the_scene_has_what_the_comparison_needs(finest):
    shown = {Semantic.SKY, Semantic.ROAD, Semantic.WALL, Semantic.WINDOW}
    assert shown <= set(np.unique(finest.semantic))
    assert min((finest.semantic == s).mean() for s in shown) > 0.03
