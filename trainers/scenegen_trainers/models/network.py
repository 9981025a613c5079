"""A trained network with everything around it: counts of two frames in, metres out. What a checkpoint holds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor, nn

from scenegen.foundation.errors import InputError, nearest
from scenegen_trainers.inputs.knobs import InputKnobs, TargetKnobs
from scenegen_trainers.inputs.look import centred, compose, look
from scenegen_trainers.inputs.target import decode
from scenegen_trainers.models.registry import ARCHITECTURES


class DepthNetwork(nn.Module):  # type: ignore[misc]
    """Gain, flow, embedding, network, metres.

    Parameters
    ----------
    architecture : str
        Of `ARCHITECTURES`.
    knobs, inputs, target : mapping
        Keys of the architecture, of `InputKnobs` and of `TargetKnobs`, as plain data.

    Raises
    ------
    InputError
        If there is no such architecture.
    """

    def __init__(
        self,
        architecture: str,
        knobs: Mapping[str, Any],
        inputs: Mapping[str, Any],
        target: Mapping[str, Any],
    ) -> None:
        super().__init__()
        if architecture not in ARCHITECTURES:
            raise InputError(f"unknown network '{architecture}'{nearest(architecture, ARCHITECTURES)}")
        kind = ARCHITECTURES[architecture]
        self.architecture = architecture
        self.inputs = InputKnobs.model_validate(inputs)
        self.target = TargetKnobs.model_validate(target)
        self.model = kind.build(self.inputs.channels, kind.knobs.model_validate(knobs))

    def forward(
        self,
        counts: Float[Tensor, "n rows columns"],
        previous: Float[Tensor, "n rows columns"],
        true_flow: Float32[np.ndarray, "n rows columns 2"] | None = None,
    ) -> Float[Tensor, "n rows columns"]:
        """Planar depth [m] of each frame.

        Parameters
        ----------
        counts, previous : (n, rows, columns)
            Frames and their predecessors [counts].
        true_flow : float32 (n, rows, columns, 2), optional
            Flow towards the previous frame [px], for networks trained on it.
        """
        flows = [None] * len(counts) if true_flow is None else list(true_flow)
        pairs = zip(counts.cpu().numpy(), previous.cpu().numpy(), flows, strict=True)
        images = [
            centred(compose(look(now, before, self.inputs, flow), self.inputs)) for now, before, flow in pairs
        ]
        device = next(self.model.parameters()).device
        return self.metres(torch.from_numpy(np.stack(images)).to(device)).to(counts.device)

    def metres(self, image: Float[Tensor, "n channels rows columns"]) -> Float[Tensor, "n rows columns"]:
        """Planar depth [m] of composed inputs."""
        return decode(self.model(image)[:, 0].float(), self.target)
