"""A network after FastDepth: MobileNet encoder, decoder of 5x5 depthwise convolutions, additive skips.

D. Wofk et al., FastDepth: Fast Monocular Depth Estimation on Embedded Systems, ICRA 2019. Written anew from the paper;
unpruned, without pretrained weights, and with a tanh behind it so that it paints depth in -1..1 as all models here do.
"""

from __future__ import annotations

from typing import Any

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from scenegen_trainers.models.knobs import FastDepthKnobs
from scenegen_trainers.models.padding import padded

# Stages of MobileNet (Howard et al., 2017): channels of the separable convolutions; the first of each halves the image.
_STAGES = ((128, 128), (256, 256), (512, 512, 512, 512, 512, 512), (1024, 1024))
_STEM = (32, 64)
_DECODER = (512, 256, 128, 64, 32)
_MULTIPLE = 32


class FastDepth(nn.Module):  # type: ignore[misc]
    """Encoder and decoder.

    Parameters
    ----------
    channels : int
        Of the input; the output has one.
    width : float
        Factor on all numbers of channels.
    """

    def __init__(self, channels: int, width: float = 1.0) -> None:
        super().__init__()

        def wide(count: int) -> int:
            return max(8, round(count * width / 8) * 8)

        first, second = (wide(count) for count in _STEM)
        self.stem = nn.Sequential(_convolution(channels, first, stride=2), _separable(first, second, 3))
        self.stages = nn.ModuleList()
        here = second
        for stage in _STAGES:
            layers = []
            for position, count in enumerate(stage):
                layers.append(_separable(here, wide(count), 3, stride=1 if position else 2))
                here = wide(count)
            self.stages.append(nn.Sequential(*layers))
        self.decoder = nn.ModuleList()
        for count in _DECODER:
            self.decoder.append(_separable(here, wide(count), 5))
            here = wide(count)
        self.paint = nn.Sequential(nn.Conv2d(here, 1, 1), nn.Tanh())

    def forward(self, image: Float[Tensor, "n channels rows columns"]) -> Float[Tensor, "n 1 rows columns"]:
        """Painted depth in -1..1. Sides that are no multiple of 32 are padded with their border, then cut."""
        rows, columns = image.shape[-2:]
        here = padded(image, _MULTIPLE)
        here = self.stem(here)
        skips = [here]
        for stage in self.stages:
            here = stage(here)
            skips.append(here)
        halves, quarters, eighths = skips[:3]
        for layer, skip in zip(self.decoder, (None, eighths, quarters, halves, None), strict=True):
            here = functional.interpolate(layer(here), scale_factor=2, mode="nearest")
            here = here if skip is None else here + skip
        return self.paint(here)[..., :rows, :columns]


def _convolution(before: int, after: int, kernel: int = 3, stride: int = 1, groups: int = 1) -> Any:
    return nn.Sequential(
        nn.Conv2d(before, after, kernel, stride, kernel // 2, groups=groups, bias=False),
        nn.BatchNorm2d(after),
        nn.ReLU(),
    )


def _separable(before: int, after: int, kernel: int, stride: int = 1) -> Any:
    """One filter per channel, then a mix of channels."""
    return nn.Sequential(_convolution(before, before, kernel, stride, before), _convolution(before, after, 1))


def build(channels: int, knobs: FastDepthKnobs) -> FastDepth:
    """Of a recipe."""
    return FastDepth(channels, knobs.width)
