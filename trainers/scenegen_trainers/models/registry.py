"""The networks by name, and how each is built and taught. Adding one: its file, its keys, a line here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from scenegen.foundation.section import Section
from scenegen_trainers.inputs.knobs import TargetKnobs
from scenegen_trainers.models import fastdepth, litemono, pix2pix
from scenegen_trainers.models.knobs import FastDepthKnobs, LiteMonoKnobs, Pix2PixKnobs
from scenegen_trainers.models.learner import Learner
from scenegen_trainers.models.silog import SilogLearner


@dataclass(frozen=True)
class Architecture:
    """A kind of network.

    Attributes
    ----------
    knobs : type of Section
        Its keys.
    build : callable
        Channels of the input and knobs to the network that estimates.
    teach : callable
        Channels, knobs, target and learning rate to what learns.
    """

    knobs: type[Section]
    build: Callable[[int, Any], Any]
    teach: Callable[[int, Any, TargetKnobs, float], Learner]


ARCHITECTURES: Mapping[str, Architecture] = {
    "pix2pix": Architecture(
        Pix2PixKnobs,
        lambda channels, knobs: pix2pix.UNet(channels, knobs.width, knobs.downs, knobs.dropout),
        lambda channels, knobs, _, rate: pix2pix.Pix2PixLearner(channels, knobs, rate),
    ),
    "fastdepth": Architecture(
        FastDepthKnobs,
        fastdepth.build,
        lambda channels, knobs, target, rate: SilogLearner(fastdepth.build(channels, knobs), target, rate),
    ),
    "litemono": Architecture(
        LiteMonoKnobs,
        litemono.build,
        lambda channels, knobs, target, rate: SilogLearner(litemono.build(channels, knobs), target, rate),
    ),
}
