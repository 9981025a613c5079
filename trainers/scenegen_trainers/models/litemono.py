"""A network after Lite-Mono: dilated depthwise convolutions for detail, attention across channels for the whole view.

N. Zhang et al., Lite-Mono: A Lightweight CNN and Transformer Architecture for Self-Supervised Monocular Depth
Estimation, CVPR 2023. Written anew from the paper: three stages at 1/4, 1/8 and 1/16, each of consecutive dilated
convolutions closed by one local-global block; the shrunk image is shown to every stage again. It learns from true depth
here, on the finest scale only.
"""

from __future__ import annotations

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from scenegen_trainers.models.knobs import LiteMonoKnobs
from scenegen_trainers.models.padding import padded

_WIDTHS = (48, 80, 128)
_DILATIONS = ((1, 2, 3), (1, 2, 3), (1, 2, 3, 1, 2, 3, 2, 4, 6))
_HEADS = 8
_EXPANSION = 6
_MULTIPLE = 16


class LiteMono(nn.Module):  # type: ignore[misc]
    """Encoder and decoder.

    Parameters
    ----------
    channels : int
        Of the input; the output has one.
    width : float
        Factor on all numbers of channels.
    dropped_paths : float
        Share of residual branches left out in training, at the last block.
    """

    def __init__(self, channels: int, width: float = 1.0, dropped_paths: float = 0.2) -> None:
        super().__init__()
        widths = [max(_HEADS, round(w * width / _HEADS) * _HEADS) for w in _WIDTHS]
        blocks = sum(len(dilations) + 1 for dilations in _DILATIONS)
        drops = iter(torch.linspace(0.0, dropped_paths, blocks).tolist())
        first = widths[0]
        self.stem = nn.Sequential(_convolution(channels, first, 2), _convolution(first, first, 1))
        self.shrinks, self.stages = nn.ModuleList(), nn.ModuleList()
        for before, after, dilations in zip([first, *widths], widths, _DILATIONS, strict=False):
            self.shrinks.append(nn.Conv2d(before + channels, after, 3, 2, 1))
            stage = [DilatedBlock(after, dilation, next(drops)) for dilation in dilations]
            self.stages.append(nn.Sequential(*stage, LocalGlobalBlock(after, next(drops))))
        self.ups = nn.ModuleList()
        for before, after, skip in zip(widths[::-1], [*widths[-2::-1], first], (1, 1, 0), strict=True):
            joined = nn.Conv2d(after * (1 + skip), after, 3, 1, 1, padding_mode="replicate")
            self.ups.append(
                nn.ModuleList([nn.Conv2d(before, after, 3, 1, 1, padding_mode="replicate"), joined])
            )
        self.paint = nn.Sequential(nn.Conv2d(first, 1, 3, 1, 1, padding_mode="replicate"), nn.Tanh())

    def forward(self, image: Float[Tensor, "n channels rows columns"]) -> Float[Tensor, "n 1 rows columns"]:
        """Painted depth in -1..1. Sides that are no multiple of 16 are padded with their border, then cut."""
        rows, columns = image.shape[-2:]
        image = padded(image, _MULTIPLE)
        here, shown, skips = self.stem(image), image, []
        for shrink, stage in zip(self.shrinks, self.stages, strict=True):
            shown = functional.avg_pool2d(shown, 2)
            here = stage(shrink(torch.cat([here, shown], dim=1)))
            skips.append(here)
        skips.pop()
        for narrow, join in self.ups:
            here = functional.interpolate(functional.elu(narrow(here)), scale_factor=2, mode="nearest")
            here = torch.cat([here, skips.pop()], dim=1) if skips else here
            here = functional.elu(join(here))
        here = functional.interpolate(here, scale_factor=2, mode="nearest")
        return self.paint(here)[..., :rows, :columns]


class DilatedBlock(nn.Module):  # type: ignore[misc]
    """Sees far at no cost: a dilated filter per channel, then a mix of channels, added to what came in."""

    def __init__(self, width: int, dilation: int, drop: float) -> None:
        super().__init__()
        self.filter = nn.Conv2d(width, width, 3, 1, dilation, dilation, groups=width, bias=False)
        self.norm = nn.BatchNorm2d(width)
        self.mix = _mix(width)
        self.scale = nn.Parameter(torch.full((width,), 1e-2))
        self.drop = drop

    def forward(self, here: Float[Tensor, "n width rows columns"]) -> Float[Tensor, "n width rows columns"]:
        """Add the branch."""
        branch = self.mix(self.norm(self.filter(here)).permute(0, 2, 3, 1)) * self.scale
        return here + dropped(branch.permute(0, 3, 1, 2), self.drop, self.training)


class LocalGlobalBlock(nn.Module):  # type: ignore[misc]
    """Cross-covariance attention (El-Nouby et al., NeurIPS 2021): channels attend to channels, over all pixels."""

    def __init__(self, width: int, drop: float) -> None:
        super().__init__()
        self.before_attention, self.before_mix = nn.LayerNorm(width), nn.LayerNorm(width)
        self.queries = nn.Linear(width, 3 * width)
        self.out = nn.Linear(width, width)
        self.temperature = nn.Parameter(torch.ones(_HEADS, 1, 1))
        self.mix = _mix(width)
        self.scales = nn.Parameter(torch.full((2, width), 1e-2))
        self.drop = drop

    def forward(self, here: Float[Tensor, "n width rows columns"]) -> Float[Tensor, "n width rows columns"]:
        """Attend, then mix."""
        count, width, rows, columns = here.shape
        pixels = here.flatten(2).transpose(1, 2)
        attended = self._attend(self.before_attention(pixels))
        pixels = pixels + dropped(self.scales[0] * attended, self.drop, self.training)
        mixed = self.mix(self.before_mix(pixels))
        pixels = pixels + dropped(self.scales[1] * mixed, self.drop, self.training)
        return pixels.transpose(1, 2).reshape(count, width, rows, columns)

    def _attend(self, pixels: Float[Tensor, "n pixels width"]) -> Float[Tensor, "n pixels width"]:
        count, size, width = pixels.shape
        split = self.queries(pixels).reshape(count, size, 3, _HEADS, width // _HEADS).permute(2, 0, 3, 4, 1)
        query, key, value = (
            functional.normalize(split[0], dim=-1),
            functional.normalize(split[1], dim=-1),
            split[2],
        )
        weights = (query @ key.transpose(-2, -1) * self.temperature).softmax(dim=-1)
        return self.out((weights @ value).permute(0, 3, 1, 2).reshape(count, size, width))


def dropped(branch: Tensor, share: float, training: bool) -> Tensor:
    """Leave a residual branch out for some of the samples, and scale it up for the others."""
    if not training or share == 0.0:
        return branch
    kept = torch.rand(len(branch), *[1] * (branch.ndim - 1), device=branch.device) >= share
    return branch * kept / (1.0 - share)


def _mix(width: int) -> nn.Sequential:
    return nn.Sequential(
        nn.Linear(width, _EXPANSION * width), nn.GELU(), nn.Linear(_EXPANSION * width, width)
    )


def _convolution(before: int, after: int, stride: int) -> nn.Sequential:
    return nn.Sequential(nn.Conv2d(before, after, 3, stride, 1, bias=False), nn.BatchNorm2d(after), nn.GELU())


def build(channels: int, knobs: LiteMonoKnobs) -> LiteMono:
    """Of a recipe."""
    return LiteMono(channels, knobs.width, knobs.dropped_paths)
