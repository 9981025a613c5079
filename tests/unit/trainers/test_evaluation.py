"""Strata, intervals, trivial baselines and pages of an evaluation."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from scenegen.foundation.errors import InputError
from scenegen_datasets.loader import PairDataset
from scenegen_trainers.evaluation import words
from scenegen_trainers.evaluation.baselines import fit_baselines
from scenegen_trainers.evaluation.bootstrap import intervals, margins, sums_of
from scenegen_trainers.evaluation.evaluate import evaluate
from scenegen_trainers.evaluation.judge import PAINTED, WHOLE, Standings
from scenegen_trainers.evaluation.report import write_report
from scenegen_trainers.evaluation.trend import TrendMeter
from scenegen_trainers.metrics import DepthMeter, DepthScores, ValidDepth
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
    assert found.report.pixels == sum(map(len, near))
    families = {name.partition(" ")[0] for name in found.network} - {WHOLE, PAINTED}
    assert families == {"distance", "light", "map", "class"}
    for family in families:
        parts = [s.report.pixels for name, s in found.network.items() if name.startswith(family)]
        assert sum(parts) == found.report.pixels
    assert {"light night", "map city", "class road", "distance 0.5 to 20 m"} < set(found.network)
    assert found.painted.pixels > found.report.pixels
    low, high = found.interval["rel"]
    assert low <= found.report.pooled.rel <= high
    assert set(found.baselines) == {"constant", "row mean", "row mean, sky as cap"}
    assert rmse(found.baselines["row mean"]) < rmse(found.baselines["constant"])
    paths = write_report(found, answer, data, tmp_path / "report")
    assert [path.name for path in paths[:3]] == ["evaluation.html", "evaluation.md", "evaluation.json"]
    plain = json.loads(paths[2].read_text())
    assert plain["scores"]["pooled"]["rmse_m"] == found.report.pooled.rmse_m
    assert set(plain["strata"]) == set(plain["better_by_95"]["constant"]) - {WHOLE, PAINTED}
    assert paths[0].read_bytes() == write_report(found, answer, data, tmp_path / "again")[0].read_bytes()
    for path in paths[3:]:
        with Image.open(path) as picture:
            assert picture.size[1] > 500


def rmse(standings: Standings) -> float:
    return standings[WHOLE].report.pooled.rmse_m


def test_the_page_shows_every_stratum_beside_a_trivial_answer(toy: Path, tmp_path: Path) -> None:
    data = TrainingData.at(toy)
    answer = checkpoint(data, torch.full((32, 32), -0.6))
    found = evaluate(answer, data, "test")
    page, markdown = (path.read_text() for path in write_report(found, answer, data, tmp_path)[:2])
    for heading in ("By true distance", "By day and by night", "By map", "By class"):
        assert f"<h2>{heading}</h2>" in page and f"## {heading}" in markdown
    for said in ("0.5 to 20 m", "night", "city", "road", "row mean", "sky as cap", "Best answers"):
        assert said in page
    assert page.count("data:image/webp") == 2 * 2 * 4  # best and worst of two clips, four tiles each
    assert 'src="http' not in page and 'href="http' not in page
    low, high = found.margins["row mean"][WHOLE]["rmse_m"]
    said = "better than" if low > 0 else "worse than" if high < 0 else "open against"
    assert f"{said} row mean {rmse(found.baselines['row mean']):.2f}" in page


def test_without_a_training_split_nothing_stands_beside(toy: Path, tmp_path: Path) -> None:
    data = TrainingData.at(toy)
    answer = checkpoint(data, torch.full((32, 32), -0.6))
    found = replace(evaluate(answer, data, "test"), baselines={}, margins={})
    page, markdown = (path.read_text() for path in write_report(found, answer, data, tmp_path)[:2])
    assert "row mean" not in markdown and "row mean" not in page


def test_a_perfect_answer_scores_perfectly(toy: Path) -> None:
    depth = PairDataset(toy, "test", ("depth",))[0]["depth"]
    data = TrainingData.at(toy)
    code = torch.from_numpy(2.0 * np.minimum(depth, 100.0) / 100.0 - 1.0)
    found = evaluate(checkpoint(data, code), data, "test", pairs=1, thorough=False)
    assert found.report.pooled.rmse_m == pytest.approx(0.0, abs=1e-4)
    assert found.report.pooled.delta == (1.0, 1.0, 1.0)
    assert found.painted.pooled.delta == (1.0, 1.0, 1.0)
    assert set(found.network) == {WHOLE, PAINTED} and found.baselines == {}


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


def scores(rel: float) -> DepthScores:
    return DepthScores(3.0, rel, (0.5, 0.6, 0.7))


def test_intervals_are_drawn_by_clip() -> None:
    rng = np.random.default_rng(0)
    one = {"a": sum((sums_of(scores(rel), 10) for rel in (0.1, 0.2, 0.9)), np.zeros(6))}
    low, high = intervals(one, rng)["rel"]
    assert low == high == pytest.approx(0.4)
    many = {f"clip {k}": sums_of(scores(rel), 10) for k, rel in enumerate(rng.normal(0.5, 0.1, 200))}
    low, high = intervals(many, rng, draws=4000)["rel"]
    standard_error = 0.1 / np.sqrt(200)
    assert high - low == pytest.approx(2 * 1.96 * standard_error, rel=0.15)
    assert intervals(many, rng)["rmse_m"] == pytest.approx((3.0, 3.0))


def test_intervals_weigh_by_pixels() -> None:
    clips = {"a": sums_of(scores(0.1), 1) + sums_of(scores(0.4), 2)}
    assert intervals(clips, np.random.default_rng(0))["rel"][0] == pytest.approx(0.3)


def test_margins_are_drawn_on_the_same_clips() -> None:
    """Clips differ by far more than the contenders do; only a paired draw sees the difference. Above 0 is better."""
    rng = np.random.default_rng(0)
    hard = rng.uniform(0.2, 2.0, 40)
    ours = {str(k): sums_of(DepthScores(3.0, rel, (0.6, 0.7, 0.8)), 10) for k, rel in enumerate(hard)}
    theirs = {
        str(k): sums_of(DepthScores(3.0, rel + 0.05, (0.5, 0.7, 0.8)), 10) for k, rel in enumerate(hard)
    }
    found = margins(ours, theirs, np.random.default_rng(1))
    assert found["rel"] == pytest.approx((0.05, 0.05)) and found["delta1"] == pytest.approx((0.1, 0.1))
    assert found["rmse_m"] == (0.0, 0.0)
    assert margins(theirs, ours, np.random.default_rng(1))["rel"][1] < 0.0
    low, high = intervals(ours, np.random.default_rng(1))["rel"]
    assert high - low > 0.2


def test_a_single_flight_tells_nothing_apart() -> None:
    assert [words.verdict(margin) for margin in ((0.1, 0.4), (-0.4, -0.1), (-0.1, 0.1), (0.2, 0.2))] == [
        "better",
        "worse",
        "open",
        "open",
    ]


def test_the_trend_of_answers_by_hand() -> None:
    """Twice the truth below 10 m, everything between 20 and 40 m above."""
    rng = np.random.default_rng(0)
    truth = np.exp(rng.uniform(np.log(1.0), np.log(80.0), (200, 200))).astype(np.float32)
    far = rng.uniform(20.0, 40.0, truth.shape).astype(np.float32)
    meter = TrendMeter(ValidDepth())
    meter.add(np.where(truth < 10.0, 2.0 * truth, far).astype(np.float32), truth)
    meter.add(np.full((2, 2), np.nan, np.float32), np.full((2, 2), 5.0, np.float32))
    found = meter.trend()
    for truth_m, low, median, high in zip(
        found.truth_m, found.low_m, found.median_m, found.high_m, strict=True
    ):
        if truth_m < 8.0:
            assert median == pytest.approx(2.0 * truth_m, rel=0.03)
        elif truth_m > 12.0:
            assert (low, median, high) == pytest.approx((22.0, 30.0, 38.0), rel=0.06)
