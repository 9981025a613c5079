"""ONNX graphs of trained networks.

A network without flow becomes a graph from counts to metres, gain included, as `scenegen fly --pilot x.onnx` takes it.
Optical flow is no part of ONNX: a network with flow becomes a graph from the composed 8-bit image (input
``embedded``, uint8) to metres, and the drone's own code computes gain, flow and embedding, as `inputs.look` does.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor, nn

from scenegen.foundation.errors import InputError
from scenegen_trainers.inputs.knobs import InputKnobs
from scenegen_trainers.models.checkpoint import Checkpoint
from scenegen_trainers.models.network import DepthNetwork

OPSET = 17


class FromCounts(nn.Module):  # type: ignore[misc]
    """Gain by percentiles or extremes, network, metres, in operations that ONNX has.

    Parameters
    ----------
    network : DepthNetwork
        Without flow, and without CLAHE.
    """

    def __init__(self, network: DepthNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(
        self, counts: Float[Tensor, "n rows columns"], previous: Float[Tensor, "n rows columns"]
    ) -> Float[Tensor, "n rows columns"]:
        """Planar depth [m]."""
        knobs = self.network.inputs
        if knobs.gain_shared:
            both = torch.cat([counts.flatten(1), previous.flatten(1)], dim=1)
            spans = [_span(both, knobs)] * 2
        else:
            spans = [_span(counts.flatten(1), knobs), _span(previous.flatten(1), knobs)]
        frames = [_grey(f, *s) for f, s in zip((counts, previous), spans, strict=True)][: knobs.frames]
        return self.network.metres(torch.stack(frames, dim=1) * (2.0 / 255.0) - 1.0)


class FromImage(nn.Module):  # type: ignore[misc]
    """Network and metres behind a composed 8-bit image.

    Parameters
    ----------
    network : DepthNetwork
    """

    def __init__(self, network: DepthNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, embedded: UInt8[Tensor, "n channels rows columns"]) -> Float[Tensor, "n rows columns"]:
        """Planar depth [m]."""
        return self.network.metres(embedded.float() * (2.0 / 255.0) - 1.0)


def takes_counts(inputs: InputKnobs) -> bool:
    """Whether the whole way from counts fits into a graph."""
    return inputs.flow == "none" and inputs.gain != "clahe"


def onnx_graph(checkpoint: Checkpoint) -> bytes:
    """The graph of a network, for any number of frames of its camera's size.

    Raises
    ------
    InputError
        If onnx is missing.
    """
    network = checkpoint.network.cpu().eval()
    shape = (int(checkpoint.camera["height_px"]), int(checkpoint.camera["width_px"]))
    if takes_counts(network.inputs):
        counts = torch.arange(shape[0] * shape[1], dtype=torch.float32).reshape(1, *shape)
        return _exported(FromCounts(network), (counts, counts + 1.0), ("counts", "previous"))
    image = torch.zeros((1, network.inputs.channels, *shape), dtype=torch.uint8)
    return _exported(FromImage(network), (image,), ("embedded",))


def example_inputs(checkpoint: Checkpoint, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Inputs of the right names, types and sizes: smooth relief, no real scene."""
    rows, columns = int(checkpoint.camera["height_px"]), int(checkpoint.camera["width_px"])
    relief = rng.normal(size=(3, rows, columns)).cumsum(axis=1).cumsum(axis=2)
    relief = (relief - relief.min()) / (relief.max() - relief.min())
    if takes_counts(checkpoint.network.inputs):
        counts = np.rint(3000.0 + 6000.0 * relief).astype(np.float32)
        return {"counts": counts[:1], "previous": counts[1:2]}
    channels = checkpoint.network.inputs.channels
    return {"embedded": np.rint(255.0 * relief[None, :channels]).astype(np.uint8)}


def _exported(module: nn.Module, example: tuple[Tensor, ...], names: Sequence[str]) -> bytes:
    if find_spec("onnx") is None:
        raise InputError("writing an ONNX graph needs onnx: pip install 'thermal-scenegen[onnx]'")
    buffer = io.BytesIO()
    axes = {name: {0: "n"} for name in (*names, "depth_m")}
    with warnings.catch_warnings():
        # The exporter by tracing is announced to go away; its successor needs a package of its own. Sizes are fixed
        # to the camera's, so what tracing takes for constant is constant.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            module.eval(),  # the exporter leaves a module, and all within, in the mode it found
            example,
            buffer,
            input_names=list(names),
            output_names=["depth_m"],
            dynamic_axes=axes,
            opset_version=OPSET,
            dynamo=False,
        )
    return buffer.getvalue()


def _span(values: Float[Tensor, "n pixels"], knobs: InputKnobs) -> tuple[Tensor, Tensor]:
    """Counts that become black and white, as `inputs.gain` finds them."""
    if knobs.gain == "minmax":
        return values.amin(dim=1), values.amax(dim=1)
    ordered = values.sort(dim=1).values
    ends = [_quantile(ordered, share) for share in knobs.gain_percent]
    return ends[0], ends[1]


def _quantile(ordered: Float[Tensor, "n pixels"], share: float) -> Float[Tensor, "n"]:
    place = share * (ordered.shape[1] - 1)
    below = int(place)
    above = min(below + 1, ordered.shape[1] - 1)
    return ordered[:, below] + (place - below) * (ordered[:, above] - ordered[:, below])


def _grey(frame: Tensor, low: Tensor, high: Tensor) -> Tensor:
    scale: Any = 255.0 / (high - low).clamp(min=1.0)
    return ((frame - low[:, None, None]) * scale[:, None, None]).clamp(0.0, 255.0).round()
