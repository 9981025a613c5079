"""Our scores against an implementation that others wrote and maintain."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from torchmetrics import MeanAbsolutePercentageError, MeanSquaredError

from scenegen_trainers.metrics import DepthMeter, ValidDepth


@pytest.mark.parametrize("seed", range(3))
def test_pooled_scores(seed: int) -> None:
    rng = np.random.default_rng(seed)
    meter = DepthMeter(ValidDepth(0.5, 100.0))
    square, relative = MeanSquaredError(squared=False), MeanAbsolutePercentageError()
    square.set_dtype(torch.float64)
    relative.set_dtype(torch.float64)
    hits, pixels = np.zeros(3), 0
    for _ in range(5):
        truth = rng.uniform(0.1, 140.0, (17, 23)).astype(np.float32)
        truth[:3] = np.inf
        estimate = (np.minimum(truth, 100.0) * rng.uniform(0.4, 2.2, truth.shape)).astype(np.float32)
        meter.add(estimate, truth)
        valid = (truth >= 0.5) & (truth < 100.0)
        p, g = (torch.from_numpy(x[valid].astype(np.float64)) for x in (estimate, truth))
        square.update(p, g)
        relative.update(p, g)
        worse = torch.maximum(p / g, g / p)
        hits += [int((worse < 1.25**n).sum()) for n in (1, 2, 3)]
        pixels += int(valid.sum())
    pooled = meter.report().pooled
    assert pooled.rmse_m == pytest.approx(float(square.compute()), abs=1e-6)
    assert pooled.rel == pytest.approx(float(relative.compute()), abs=1e-6)
    assert pooled.delta == pytest.approx(tuple(hits / pixels), abs=1e-12)
