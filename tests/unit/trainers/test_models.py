"""Networks against published sizes, losses against hand calculation."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from torch import nn

from scenegen_trainers.models.fastdepth import FastDepth
from scenegen_trainers.models.litemono import LiteMono, dropped
from scenegen_trainers.models.pix2pix import PatchGAN, UNet, absolute, adversarial
from scenegen_trainers.models.silog import silog


def size(network: nn.Module) -> int:
    return sum(p.numel() for p in network.parameters())


def test_generator_has_seven_convolutions_and_seven_deconvolutions() -> None:
    network = UNet(1, width=8)
    assert sum(isinstance(m, nn.Conv2d) for m in network.modules()) == 7
    assert sum(isinstance(m, nn.ConvTranspose2d) for m in network.modules()) == 7
    assert all(
        m.kernel_size == (4, 4) and m.stride == (2, 2)
        for m in network.modules()
        if isinstance(m, nn.Conv2d | nn.ConvTranspose2d)
    )


def test_sizes_as_published() -> None:
    assert size(UNet(1)) == pytest.approx(41.8e6, rel=2e-3)
    assert size(PatchGAN(2)) == pytest.approx(2.77e6, rel=5e-3)
    assert size(FastDepth(3)) == pytest.approx(3.96e6, rel=5e-3)


def test_generator_joins_levels() -> None:
    """Every level of the encoder reaches the output past the bottleneck: its weights get gradients without it."""
    network = UNet(1, width=4, downs=4, dropout=0.0).eval()
    first_up = network.ups[0]
    first_up.register_forward_hook(lambda module, given, result: torch.zeros_like(result))
    network(torch.randn(1, 1, 32, 32)).sum().backward()
    gradients = [down[-1 if k in (0, 3) else 1].weight.grad for k, down in enumerate(network.downs)]
    assert [g is not None and bool(g.any()) for g in gradients] == [True, True, True, False]


def test_a_logit_sees_70_by_70_pixels() -> None:
    judge = PatchGAN(2, width=4).eval()
    image = torch.randn(1, 1, 160, 160, requires_grad=True)
    logits = judge(image, torch.randn(1, 1, 160, 160))
    logits[0, 0, 9, 9].backward()
    assert image.grad is not None
    seen = image.grad[0, 0].nonzero()
    extent = (seen.max(dim=0).values - seen.min(dim=0).values + 1).tolist()
    assert extent == [70, 70]


@pytest.mark.parametrize(
    "network", [UNet(2, 4), FastDepth(2, 0.125), LiteMono(2, 0.25)], ids=lambda n: type(n).__name__
)
@pytest.mark.parametrize("shape", [(64, 64), (50, 70), (1, 33)])
def test_any_image_size_comes_back(network: nn.Module, shape: tuple[int, int]) -> None:
    network.eval()
    with torch.inference_mode():
        depth = network(torch.randn(3, 2, *shape))
    assert depth.shape == (3, 1, *shape)
    assert float(depth.abs().max()) <= 1.0


def test_adversarial_loss_by_hand() -> None:
    logits = torch.tensor([[[[0.0, 2.0], [-1.0, 3.0]]]])
    chance = [1.0 / (1.0 + math.exp(-x)) for x in (0.0, 2.0, -1.0, 3.0)]
    true = -sum(math.log(p) for p in chance) / 4
    false = -sum(math.log(1.0 - p) for p in chance) / 4
    assert float(adversarial(logits, True)) == pytest.approx(true, rel=1e-6)
    assert float(adversarial(logits, False)) == pytest.approx(false, rel=1e-6)


def test_absolute_loss_looks_at_judged_pixels_only() -> None:
    painted = torch.tensor([[[[0.0, 0.5, 1.0]]]])
    truth = torch.tensor([[[[0.5, 0.5, -1.0]]]])
    assert float(absolute(painted, truth, torch.ones_like(truth, dtype=torch.bool))) == pytest.approx(2.5 / 3)
    some = torch.tensor([[[[True, True, False]]]])
    assert float(absolute(painted, truth, some)) == pytest.approx(0.25)
    assert float(absolute(painted, truth, torch.zeros_like(some))) == 0.0


def test_silog_by_hand() -> None:
    rng = np.random.default_rng(0)
    truth, estimate = rng.uniform(1, 90, (2, 1, 4, 5)), rng.uniform(1, 90, (2, 1, 4, 5))
    judged = rng.uniform(size=truth.shape) < 0.7
    g = np.log(estimate[judged]) - np.log(truth[judged])
    wanted = 10.0 * math.sqrt((g**2).mean() - 0.85 * g.mean() ** 2)
    tensors = [torch.from_numpy(x) for x in (estimate, truth, judged)]
    assert float(silog(*tensors)) == pytest.approx(wanted, rel=1e-9)


def test_silog_of_nothing_is_a_number_with_a_gradient() -> None:
    estimate = torch.zeros(1, 1, 2, 2, requires_grad=True)
    loss = silog(estimate, torch.full((1, 1, 2, 2), torch.inf), torch.zeros(1, 1, 2, 2, dtype=torch.bool))
    loss.backward()
    assert (
        estimate.grad is not None and bool(torch.isfinite(loss)) and bool(torch.isfinite(estimate.grad).all())
    )


def test_dropped_paths_keep_the_mean() -> None:
    torch.manual_seed(0)
    branch = torch.ones(20_000, 1)
    assert dropped(branch, 0.3, training=False) is branch
    kept = dropped(branch, 0.3, training=True)
    assert float(kept.mean()) == pytest.approx(1.0, abs=0.02)
    assert sorted(set(kept.flatten().tolist())) == pytest.approx([0.0, 1.0 / 0.7])
