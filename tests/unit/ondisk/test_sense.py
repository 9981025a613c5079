"""Render once, sense many: one camera gives the same counts again, coarser ones the truth of their own grid."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from scenegen.foundation.errors import InputError
from scenegen_cli.main import main
from scenegen_datasets import PairDataset
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.sensing.binning import binned, mean_radiance
from scenegen_datasets.sensing.camera import new_camera
from scenegen_datasets.sensing.retake import Retake
from scenegen_render.camera_knobs import CameraKnobs
from scenegen_render.frame import Frame
from scenegen_render.sensor.knobs import SensorKnobs

RECIPE: dict[str, Any] = {
    "camera": CameraKnobs().model_dump(mode="json"),
    "sensor": SensorKnobs().model_dump(mode="json"),
}


def plane(size: int) -> Frame:
    """A tilted plane that fills the image, in closed form, with flow that is linear over it."""
    v, u = np.mgrid[0:size, 0:size] + 0.5
    inverse = 0.02 + 0.001 * u / size + 0.003 * v / size
    ones = np.ones((size, size))
    return Frame(
        radiance=(30 + u / size).astype(np.float32),
        depth=(1 / inverse).astype(np.float32),
        temperature=(280 + v / size).astype(np.float32),
        semantic=ones.astype(np.uint8),
        instance=ones.astype(np.uint32),
        material=ones.astype(np.uint16),
        flow=np.stack([0.4 * u / size, -0.3 * v / size], axis=-1).astype(np.float32) * size / 8,
        covisible=ones.astype(bool),
    )


@pytest.mark.parametrize("side", [1, 2, 3, 4])
def test_a_plane_on_a_coarser_grid_is_the_plane(side: int) -> None:
    """What a coarse camera is told equals what the closed form says at the centres of its own pixels."""
    fine, coarse = binned(plane(24), side), plane(24 // side)
    np.testing.assert_allclose(fine.depth, coarse.depth, rtol=2e-6)
    np.testing.assert_allclose(fine.radiance, coarse.radiance, rtol=1e-6)
    np.testing.assert_allclose(fine.temperature, coarse.temperature, rtol=1e-6)
    np.testing.assert_allclose(fine.flow, coarse.flow, atol=2e-6)


def test_where_surfaces_meet_a_label_is_one_of_theirs_and_sky_stays_sky(fakes: ModuleType) -> None:
    frame = fakes.frame(np.random.default_rng(0), (12, 16), extra=True)
    half = binned(frame, 2)
    sky = half.semantic == 0
    assert sky.any() and (np.isinf(half.depth) == sky).all() and (half.temperature[sky] == 0).all()
    for name in ("depth", "temperature", "semantic", "instance", "material"):
        block = getattr(frame, name).reshape(6, 2, 8, 2).transpose(0, 2, 1, 3).reshape(6, 8, 4)
        joint = (
            frame.instance.reshape(6, 2, 8, 2).transpose(0, 2, 1, 3).reshape(6, 8, 4)
            == half.instance[..., None]
        ).all(-1)
        ours = getattr(half, name)
        assert ((block == ours[..., None]).any(-1) | joint).all()
        assert getattr(half, name).dtype == getattr(frame, name).dtype
    length = np.linalg.norm(half.normal, axis=-1)
    np.testing.assert_allclose(length, np.where(sky, 0, 1), atol=1e-6)


def test_what_a_camera_cannot_see_is_refused_and_says_why() -> None:
    def asked(**camera: Any) -> dict[str, Any]:
        return {"camera": camera}

    assert new_camera("d", RECIPE, {}).side == 1
    assert new_camera("d", RECIPE, asked(width_px=64, height_px=64)).side == 4
    found = new_camera("d", RECIPE, {"sensor": {"netd_mk": 30.0}})
    assert found.sensor.netd_mk == 30.0 and found.sensor.time_constant_ms == 10.0
    for camera, reason in (
        ({"preset": "boson640"}, "band 8-14 um; 7.5-13.5 um needs a new render"),
        ({"preset": "lepton35"}, "field of view 90 deg; 57 deg needs a new render"),
        ({"hfov_deg": 60.0}, "field of view"),
        ({"width_px": 512, "height_px": 512}, "image size 256x256"),
        ({"width_px": 128}, "image size"),
        ({"width_px": 100, "height_px": 100}, "100x100 needs a new render"),
        ({"widht_px": 128}, "perhaps you meant 'width_px'"),
        ({"preset": "tau641"}, "perhaps you meant 'tau640'"),
    ):
        with pytest.raises(InputError, match=reason):
            new_camera("d", RECIPE, asked(**camera))
    with pytest.raises(InputError, match="merged"):
        new_camera("d", {"merged": []}, {})


def test_radiance_of_a_block_is_its_mean() -> None:
    radiance = np.random.default_rng(0).uniform(10, 60, (6, 9)).astype(np.float32)
    coarse = mean_radiance(radiance, 3)
    assert coarse.shape == (2, 3) and coarse[1, 2] == pytest.approx(radiance[3:, 6:].mean(dtype=np.float64))


def retake(seed: int = 0, **sensor: Any) -> Retake:
    return Retake(SensorKnobs(**sensor), (8.0, 14.0), seed)


def test_loading_through_another_camera(pristine: Path) -> None:
    layers = ("thermal", "depth", "previous_thermal", "semantic")
    pairs = PairDataset(pristine, layers=layers, retake=retake(noise=False, pattern=False, lag=False))
    plain = PairDataset(pristine, layers=(*layers, "radiance"))
    sample = pairs[4]
    assert set(sample) == set(plain[4]) - {"radiance"}
    np.testing.assert_array_equal(sample["depth"], plain[4]["depth"])
    np.testing.assert_array_equal(sample["previous_thermal"], pairs[3]["thermal"])
    assert sample["thermal"].dtype == np.uint16 and (sample["thermal"] != plain[4]["thermal"]).any()
    order = np.argsort(plain[4]["radiance"], axis=None)
    sharp = PairDataset(
        pristine,
        layers=["thermal"],
        retake=retake(noise=False, pattern=False, lag=False, lens_mtf_nyquist=1.0),
    )
    assert (np.diff(sharp[4]["thermal"].ravel()[order].astype(int)) >= 0).all(), "counts follow radiance"


def test_noise_belongs_to_seed_epoch_and_key(pristine: Path) -> None:
    def counts(camera: Retake) -> np.ndarray:
        return np.asarray(PairDataset(pristine, layers=["thermal"], retake=camera)[4]["thermal"])

    np.testing.assert_array_equal(counts(retake(1)), counts(retake(1)))
    assert (counts(retake(1)) != counts(retake(2))).any()
    assert (counts(retake(1)) != counts(retake(1).at(1))).any()
    pairs = PairDataset(pristine, layers=["thermal"], retake=retake(1))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(pairs))[4]["thermal"], pairs[4]["thermal"])


def test_without_radiance_nothing_can_be_retaken(fakes: ModuleType, tmp_path: Path) -> None:
    root = fakes.make(tmp_path / "d", 1, layers=("thermal", "depth"))
    with pytest.raises(InputError, match="no layer 'radiance'"):
        PairDataset(root, retake=retake())
    assert main(["sense", str(root), "--out", str(tmp_path / "e")]) == 2
    assert not (tmp_path / "e").exists()


def test_default_layers_are_what_sensing_needs() -> None:
    assert {"radiance", "temperature", "instance"} <= set(DEFAULT_LAYERS)
    assert json.dumps(RECIPE)
