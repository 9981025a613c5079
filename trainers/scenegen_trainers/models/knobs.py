"""Keys of the networks. Apart from the networks themselves, so that reading a recipe does not load torch."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Count, Number, Section


class Pix2PixKnobs(Section):
    """U-Net generator and PatchGAN discriminator (Isola et al., CVPR 2017)."""

    w_l1: Annotated[Number, Field(ge=0.0, le=1e6)] = 100.0
    """Weight of the mean absolute error of the painted depth (-1..1) beside the adversarial loss, Eq. (4)."""
    width: Annotated[Count, Field(ge=1, le=512)] = 64
    """Channels after the generator's first convolution; doubles up to eightfold."""
    downs: Annotated[Count, Field(ge=2, le=9)] = 7
    """Convolutions down, and deconvolutions up: 7 + 7 in the paper."""
    dropout: Annotated[Number, Field(ge=0.0, lt=1.0)] = 0.5
    """Share dropped after the first three deconvolutions: the noise n of Eq. (2). Off when it estimates."""
    judge_width: Annotated[Count, Field(ge=1, le=512)] = 64
    """Channels after the discriminator's first convolution."""


class FastDepthKnobs(Section):
    """MobileNet encoder, depthwise decoder, additive skips (Wofk et al., ICRA 2019)."""

    width: Annotated[Number, Field(ge=0.0625, le=4.0)] = 1.0
    """Factor on all numbers of channels; 1 as published, before pruning."""


class LiteMonoKnobs(Section):
    """Dilated convolutions and cross-covariance attention (Zhang et al., CVPR 2023)."""

    width: Annotated[Number, Field(ge=0.125, le=4.0)] = 1.0
    """Factor on all numbers of channels; 1 gives 48, 80 and 128."""
    dropped_paths: Annotated[Number, Field(ge=0.0, lt=1.0)] = 0.2
    """Share of residual branches left out in training, rising from 0 at the first block to this at the last."""
