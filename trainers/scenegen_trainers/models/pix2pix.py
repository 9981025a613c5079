"""Pix2Pix: a U-Net paints depth from a thermal image, a PatchGAN judges it.

P. Isola et al., Image-to-Image Translation with Conditional Adversarial Networks, CVPR 2017. Top down: the generator,
the discriminator, the losses, one step of training.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from scenegen_trainers.models.knobs import Pix2PixKnobs
from scenegen_trainers.models.learner import Batch, Learner
from scenegen_trainers.models.padding import padded

_DROPPED_UPS = 3
_SPREAD = 0.02


class UNet(nn.Module):  # type: ignore[misc]
    """Generator: `downs` convolutions down, as many deconvolutions up, 4x4 with stride 2, joined level by level.

    Parameters
    ----------
    channels : int
        Of the input; the output has one.
    width : int
        Channels after the first convolution.
    downs : int
    dropout : float
    """

    def __init__(self, channels: int, width: int = 64, downs: int = 7, dropout: float = 0.5) -> None:
        super().__init__()
        self.multiple = 2**downs
        widths = [width * min(2**k, 8) for k in range(downs)]
        self.downs = nn.ModuleList()
        for level, (before, after) in enumerate(zip([channels, *widths], widths, strict=False)):
            inner = 0 < level < downs - 1
            layers = [nn.LeakyReLU(0.2)] if level else []
            layers += [nn.Conv2d(before, after, 4, 2, 1, bias=not inner)]
            self.downs.append(nn.Sequential(*layers, *([nn.BatchNorm2d(after)] if inner else [])))
        self.ups = nn.ModuleList()
        for step, level in enumerate(reversed(range(1, downs))):
            before = widths[level] if step == 0 else 2 * widths[level]
            layers = [nn.ReLU(), nn.ConvTranspose2d(before, widths[level - 1], 4, 2, 1, bias=False)]
            layers += [nn.BatchNorm2d(widths[level - 1])]
            layers += [nn.Dropout(dropout)] if step < _DROPPED_UPS and dropout else []
            self.ups.append(nn.Sequential(*layers))
        self.paint = nn.Sequential(nn.ReLU(), nn.ConvTranspose2d(2 * widths[0], 1, 4, 2, 1), nn.Tanh())
        self.apply(start)

    def forward(self, image: Float[Tensor, "n channels rows columns"]) -> Float[Tensor, "n 1 rows columns"]:
        """Painted depth in -1..1. Sides that are no multiple of 2^downs are padded with their border, then cut."""
        rows, columns = image.shape[-2:]
        here = padded(image, self.multiple)
        skips = []
        for down in self.downs:
            here = down(here)
            skips.append(here)
        skips.pop()
        for up in self.ups:
            here = torch.cat([up(here), skips.pop()], dim=1)
        return self.paint(here)[..., :rows, :columns]


class PatchGAN(nn.Module):  # type: ignore[misc]
    """Discriminator: one logit for each 70x70 patch of an image beside its depth.

    Parameters
    ----------
    channels : int
        Of image and depth together.
    width : int
    """

    def __init__(self, channels: int, width: int = 64) -> None:
        super().__init__()
        widths = [width, 2 * width, 4 * width, 8 * width]
        layers: list[Any] = [nn.Conv2d(channels, width, 4, 2, 1), nn.LeakyReLU(0.2)]
        for before, after, stride in zip(widths[:-1], widths[1:], (2, 2, 1), strict=True):
            layers += [nn.Conv2d(before, after, 4, stride, 1, bias=False), nn.BatchNorm2d(after)]
            layers += [nn.LeakyReLU(0.2)]
        self.layers = nn.Sequential(*layers, nn.Conv2d(widths[-1], 1, 4, 1, 1))
        self.apply(start)

    def forward(
        self, image: Float[Tensor, "n channels rows columns"], depth: Float[Tensor, "n 1 rows columns"]
    ) -> Float[Tensor, "n 1 patch_rows patch_columns"]:
        """Logits: above 0 where the depth is taken for true."""
        return self.layers(torch.cat([image, depth], dim=1))


def start(module: Any) -> None:
    """Initial weights: N(0, 0.02), normalisation gains N(1, 0.02), as published."""
    if isinstance(module, nn.Conv2d | nn.ConvTranspose2d):
        nn.init.normal_(module.weight, 0.0, _SPREAD)
    elif isinstance(module, nn.BatchNorm2d):
        nn.init.normal_(module.weight, 1.0, _SPREAD)
    if getattr(module, "bias", None) is not None:
        nn.init.zeros_(module.bias)


def adversarial(logits: Float[Tensor, "..."], taken_for_true: bool) -> Float[Tensor, ""]:
    """Eq. (2): mean of -log D where depth should pass for true, of -log(1 - D) where not."""
    return functional.binary_cross_entropy_with_logits(logits, torch.full_like(logits, float(taken_for_true)))


def absolute(
    painted: Float[Tensor, "n 1 rows columns"],
    truth: Float[Tensor, "n 1 rows columns"],
    judged: Bool[Tensor, "n 1 rows columns"],
) -> Float[Tensor, ""]:
    """Eq. (3): mean absolute error of the painted depth over judged pixels; 0 where there are none."""
    error = (painted - truth).abs() * judged
    return error.sum() / judged.sum().clamp(min=1)


class Pix2PixLearner(Learner):
    """Generator and discriminator, taught in turn, Eq. (4).

    Parameters
    ----------
    channels : int
        Of the generator's input.
    knobs : Pix2PixKnobs
    learning_rate : float
    """

    def __init__(self, channels: int, knobs: Pix2PixKnobs, learning_rate: float) -> None:
        generator = UNet(channels, knobs.width, knobs.downs, knobs.dropout)
        judge = PatchGAN(channels + 1, knobs.judge_width)
        networks = {"generator": generator, "judge": judge}
        super().__init__(networks, lambda network: adam(network, learning_rate), learning_rate)
        self._w_l1 = knobs.w_l1

    @property
    def network(self) -> Any:
        """The generator."""
        return self.networks["generator"]

    def step(self, batch: Batch) -> Mapping[str, Tensor]:
        """Teach the discriminator by half its loss, then the generator."""
        generator, judge = self.networks["generator"], self.networks["judge"]
        painted = generator(batch.image)
        true_logits, false_logits = judge(batch.image, batch.code), judge(batch.image, painted.detach())
        judging = 0.5 * (adversarial(true_logits, True) + adversarial(false_logits, False))
        self.descend("judge", judging)

        judge.requires_grad_(False)
        # The bare module: gradients of the judge are of no use here, and a distributed wrapper would wait for them.
        with self.precision():
            verdict = judge.module(batch.image, painted)
        passing = adversarial(verdict, True)
        distance = absolute(painted, batch.code, batch.judged)
        self.descend("generator", passing + self._w_l1 * distance)
        judge.requires_grad_(True)
        return {"judge": judging, "gan": passing, "l1": distance}


def adam(network: Any, learning_rate: float) -> Any:
    """Adam as published: first moment 0.5."""
    return torch.optim.Adam(network.parameters(), lr=learning_rate, betas=(0.5, 0.999))
