"""Data, recipes and machines no network can learn from or be judged on: refused in one line, before time is spent."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenegen.foundation.errors import InputError
from scenegen_datasets.resolve import Source
from scenegen_trainers.evaluation.evaluate import evaluate
from scenegen_trainers.inputs.knobs import TargetKnobs
from scenegen_trainers.models.checkpoint import Checkpoint, read_checkpoint
from scenegen_trainers.models.network import DepthNetwork
from scenegen_trainers.models.pix2pix import Pix2PixLearner, absolute
from scenegen_trainers.tables.worker import worker
from scenegen_trainers.training.loop import train
from scenegen_trainers.training.machine import Machine
from scenegen_trainers.training.recipe import TrainingRecipe, resolve_training
from scenegen_trainers.training.samples import Samples, Shown, collate
from scenegen_trainers.training.source import TrainingData

TINY: dict[str, Any] = {
    "pix2pix": {"width": 2, "judge_width": 2, "downs": 3},
    "training": {"steps": 2, "judge": 1, "judge_pairs": 2, "keep": 2, "log": 1},
}


def recipe(model: str = "pix2pix", **more: Any) -> TrainingRecipe:
    return resolve_training(model, "ci", [Source("", TINY), Source("", more)])


def spoil(monkeypatch: pytest.MonkeyPatch, **layers: Any) -> None:
    """Let every sample of a dataset hold something else than it stores."""
    whole = Samples.raw

    def raw(self: Samples, position: int) -> dict[str, Any]:
        sample = whole(self, position)
        for name, change in layers.items():
            sample[name] = change(np.array(sample[name]))
        return sample

    monkeypatch.setattr(Samples, "raw", raw)


def with_first(value: float) -> Any:
    def change(depth: np.ndarray) -> np.ndarray:
        depth[0, 0] = value
        return depth

    return change


@pytest.mark.parametrize("bad", [np.nan, -np.inf, 0.0, -3.0])
@pytest.mark.parametrize("model", ["pix2pix", "fastdepth"])
def test_depth_that_is_none_stops_a_training_at_once(
    toy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, model: str, bad: float
) -> None:
    spoil(monkeypatch, depth=with_first(bad))
    with pytest.raises(
        InputError, match=r"city.*: true depth is NaN or not positive in 1 pixels; run `scenegen"
    ):
        train(recipe(model), TrainingData.at(toy), tmp_path / "a", Machine())
    assert not (tmp_path / "a" / "model.pt").exists()


def test_depth_that_is_none_stops_judging_and_names_the_sample(
    toy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = TrainingData.at(toy)
    network = DepthNetwork(**recipe().network_config()).eval()
    spoil(monkeypatch, depth=with_first(np.nan))
    with pytest.raises(InputError, match=r"city.*: true depth is NaN"):
        evaluate(Checkpoint(network, data.camera(), {}), data, thorough=False)


def test_sky_alone_can_be_learned_and_cannot_be_judged(
    toy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No pixel is valid: the scores of a step stay empty, those of an evaluation are refused."""
    spoil(monkeypatch, depth=lambda depth: np.full_like(depth, np.inf))
    data = TrainingData.at(toy)
    for model, sky in (("pix2pix", "cap"), ("fastdepth", "ignore")):
        path = train(recipe(model, target={"sky": sky}), data, tmp_path / model, Machine())
        assert "val_rmse_m" not in (tmp_path / model / "log.csv").read_text()
        checkpoint = read_checkpoint(path)
        assert all(torch.isfinite(value).all() for value in checkpoint.network.state_dict().values())
        with pytest.raises(InputError, match=r"no pixel with a true depth .* in 8 images"):
            evaluate(checkpoint, data, thorough=False)


def test_a_mask_without_a_pixel_teaches_nothing() -> None:
    painted = torch.zeros(1, 1, 4, 4, requires_grad=True)
    loss = absolute(painted, torch.ones(1, 1, 4, 4), torch.zeros(1, 1, 4, 4, dtype=torch.bool))
    loss.backward()
    assert loss.item() == 0.0 and painted.grad is not None and not painted.grad.any()


def test_samples_of_two_sizes_are_refused() -> None:
    shown = [
        Shown(np.zeros((1, size, size), np.uint8), np.ones((size, size), np.float32)) for size in (16, 32)
    ]
    with pytest.raises(InputError, match="samples of one batch differ in size"):
        collate(TargetKnobs(), shown)


def test_frames_of_two_sizes_name_the_sample(
    toy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spoil(monkeypatch, previous_thermal=lambda frame: frame[:16])
    with pytest.raises(InputError, match=r"city.*\(32, 32\) pixels follows one of \(16, 32\)"):
        train(recipe(), TrainingData.at(toy), tmp_path / "a", Machine())


def test_a_table_refuses_a_split_it_could_not_judge_before_it_teaches(bare: Path, tmp_path: Path) -> None:
    handle = worker({"data": str(bare), "split": "test"})
    task = {"recipe": recipe().model_dump(mode="json"), "out": str(tmp_path / "a")}
    with pytest.raises(InputError, match="'test' has no pairs"):
        handle(task, lambda said: None)
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize(
    ("machine", "said"),
    [
        (Machine(devices=0), "--devices 0: at least 1"),
        (Machine(threads=0), "--threads 0: at least 1"),
        (Machine(devices=3), "a batch of 4 cannot be shared evenly by 3 devices"),
        (Machine("gpu"), "no GPU that torch can use"),
    ],
)
def test_a_machine_that_is_none_is_one_line(
    machine: Machine, said: str, toy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(InputError, match=said):
        train(recipe(), TrainingData.at(toy), tmp_path / "a", machine)
    assert not (tmp_path / "a").exists()


def test_a_dataset_that_does_not_fit_is_refused(bare: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'val' has no pairs"):
        train(recipe(), TrainingData.at(bare), tmp_path / "a", Machine())
    with pytest.raises(InputError, match=r"no layer 'flow_back'.*--layers"):
        train(recipe(inputs={"flow": "truth"}), TrainingData.at(bare), tmp_path / "b", Machine())
    with pytest.raises(InputError, match=r"no layer 'radiance'.*--layers"):
        train(recipe(training={"noise": "redrawn"}), TrainingData.at(bare), tmp_path / "c", Machine())


def test_frames_of_several_cameras_teach_nobody_and_judge_nobody(zooming: Path, tmp_path: Path) -> None:
    data = TrainingData.at(zooming)
    with pytest.raises(
        InputError, match="holds frames of several cameras; a network learns and is judged with one"
    ):
        train(recipe(), data, tmp_path / "a", Machine())
    assert not list((tmp_path / "a").glob("*.pt"))
    checkpoint = Checkpoint(DepthNetwork(**recipe().network_config()).eval(), {"width_px": 32}, {})
    with pytest.raises(InputError, match="several cameras"):
        evaluate(checkpoint, data, thorough=False)


@pytest.mark.parametrize(
    ("model", "keys", "message"),
    [
        ("pix2pix-flwo", {}, "perhaps you meant 'pix2pix-flow'"),
        ("pix2pix", {"inputs": {"intervall": 3}}, "perhaps you meant 'interval'"),
        ("pix2pix", {"pix2pix": {"w_l1": -1.0}}, r"--pix2pix\.w_l1"),
        ("pix2pix", {"inputs": {"gain_percent": [0.5, 0.5]}}, "two different shares"),
        (
            "pix2pix",
            {"training": {"mirror": "embeded"}},
            "unknown value 'embeded'; perhaps you meant 'embedded'",
        ),
    ],
)
def test_bad_recipes_are_refused_in_one_line(model: str, keys: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        resolve_training(model, "ci", [Source("", keys)])


def test_a_dataset_that_still_grows_is_refused(toy: Path, tmp_path: Path) -> None:
    growing = shutil.copytree(toy, tmp_path / "growing")
    (growing / "dataset.json").unlink()
    with pytest.raises(InputError, match="is still growing; finish it with `scenegen render` first"):
        TrainingData.at(growing)


def test_losses_that_are_no_numbers_say_so(
    toy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Pix2PixLearner, "step", lambda self, batch: {"l1": torch.tensor(float("nan"))})
    with pytest.raises(InputError, match="no longer numbers at step 1"):
        train(recipe(), TrainingData.at(toy), tmp_path / "a", Machine())
