"""Strata, intervals, trivial baselines and pages of an evaluation."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from scenegen.foundation.errors import InputError
from scenegen_datasets.loader import PairDataset
from scenegen_trainers.evaluation.baselines import fit_baselines
from scenegen_trainers.evaluation.bootstrap import Judged, intervals
from scenegen_trainers.evaluation.evaluate import evaluate
from scenegen_trainers.evaluation.report import write_report
from scenegen_trainers.metrics import DepthMeter, DepthScores
from scenegen_trainers.models.checkpoint import Checkpoint
from scenegen_trainers.models.network import DepthNetwork
from scenegen_trainers.training.recipe import TrainingRecipe, resolve_training
from scenegen_trainers.training.source import TrainingData


class Oracle(torch.nn.Module):
    """Answers the same picture to everything."""

    def __init__(self, code: torch.Tensor) -> None:
        super().__init__()
        self.code = torch.nn.Parameter(code)

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        return self.code.expand(len(image), 1, *self.code.shape)


def checkpoint(data: TrainingData, code: torch.Tensor) -> Checkpoint:
    recipe: TrainingRecipe = resolve_training("pix2pix", "ci", [])
    network = DepthNetwork(**recipe.network_config())
    network.model = Oracle(code)
    return Checkpoint(network.eval(), data.camera(), {"model": "oracle", "seed": 0})


def test_scores_strata_and_baselines_of_a_known_answer(toy: Path, tmp_path: Path) -> None:
    """Every pixel is answered 20 m: everything else can be worked out from the dataset alone."""
    data = TrainingData.at(toy)
    answer = checkpoint(data, torch.full((32, 32), -0.6))
    found = evaluate(answer, data, "test")
    meter, near = DepthMeter(), []
    for sample in PairDataset(toy, "test", ("depth",)):
        meter.add(np.full((32, 32), 20.0, np.float32), sample["depth"])
        near.append(sample["depth"][(sample["depth"] >= 0.5) & (sample["depth"] < 100.0)])
    assert found.report.pooled.rmse_m == pytest.approx(meter.report().pooled.rmse_m, rel=1e-6)
    assert found.report.pixels == sum(map(len, near)) == sum(j.pixels for _, j in found.images)
    assert set(found.strata) == {"map city", "night", "class road", "class sidewalk"}
    classes = [r for name, r in found.strata.items() if name.startswith("class")]
    assert sum(r.pixels for r in classes) == found.report.pixels
    assert found.painted.pixels > found.report.pixels
    low, high = found.interval["rel"]
    assert low <= found.report.pooled.rel <= high
    assert set(found.baselines) == {"constant", "row mean", "row mean, sky as cap"}
    assert found.baselines["row mean"].report.pooled.rmse_m < found.baselines["constant"].report.pooled.rmse_m
    paths = write_report(found, answer, data, tmp_path / "report")
    page = json.loads(paths[0].read_text())
    assert page["scores"]["pooled"]["rmse_m"] == found.report.pooled.rmse_m
    assert "## Trivial answers" in paths[1].read_text()
    for path in paths[2:]:
        with Image.open(path) as picture:
            assert picture.size[1] > 500


def test_a_perfect_answer_scores_perfectly(toy: Path) -> None:
    depth = PairDataset(toy, "test", ("depth",))[0]["depth"]
    data = TrainingData.at(toy)
    code = torch.from_numpy(2.0 * np.minimum(depth, 100.0) / 100.0 - 1.0)
    found = evaluate(checkpoint(data, code), data, "test", pairs=1, thorough=False)
    assert found.report.pooled.rmse_m == pytest.approx(0.0, abs=1e-4)
    assert found.report.pooled.delta == (1.0, 1.0, 1.0)
    assert found.painted.pooled.delta == (1.0, 1.0, 1.0)
    assert found.strata == {} and found.baselines == {}


def test_frames_of_another_camera_are_refused(toy: Path) -> None:
    data = TrainingData.at(toy)
    answer = checkpoint(data, torch.zeros(32, 32))
    for change in ({"width_px": 64}, {"hfov_deg": 60.0}):
        other = Checkpoint(answer.network, {**answer.camera, **change}, answer.record)
        with pytest.raises(InputError, match="a dataset of its own camera"):
            evaluate(other, data)


def test_baselines_by_hand(toy: Path) -> None:
    training = PairDataset(toy, "train", ("depth",))
    depths = np.stack([sample["depth"] for sample in training])
    found = fit_baselines(training, 100.0)
    for row in range(32):
        seen = depths[:, row][depths[:, row] < 100.0]
        assert found.row_m[row] == pytest.approx(seen.mean() if len(seen) else 100.0, rel=1e-6)
        assert found.painted_row_m[row] == pytest.approx(np.minimum(depths[:, row], 100.0).mean(), rel=1e-6)
    assert found.constant_m == pytest.approx(np.median(depths[depths < 100.0]), abs=0.03)
    answers = found.answers((32, 32))
    assert (answers["row mean"] == answers["row mean"][:, :1]).all()


def judged(group: str, rel: float, pixels: int = 10, index: int = 0) -> Judged:
    return Judged(index, group, pixels, DepthScores(3.0, rel, (0.5, 0.6, 0.7)))


def test_intervals_are_drawn_by_clip() -> None:
    rng = np.random.default_rng(0)
    one = [judged("a", rel) for rel in (0.1, 0.2, 0.9)]
    low, high = intervals(one, rng)["rel"]
    assert low == high == pytest.approx(0.4)
    many = [judged(f"clip {k}", rel) for k, rel in enumerate(rng.normal(0.5, 0.1, 200))]
    low, high = intervals(many, rng, draws=4000)["rel"]
    standard_error = 0.1 / np.sqrt(200)
    assert high - low == pytest.approx(2 * 1.96 * standard_error, rel=0.15)
    assert intervals(many, rng)["rmse_m"] == pytest.approx((3.0, 3.0))


def test_intervals_weigh_by_pixels() -> None:
    images = [judged("a", 0.1, pixels=1), judged("a", 0.4, pixels=2)]
    assert intervals(images, np.random.default_rng(0))["rel"][0] == pytest.approx(0.3)
