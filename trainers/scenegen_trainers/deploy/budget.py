"""The budget of a drone: what each network costs its computer, and how far it flies before a frame is understood."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_trainers.deploy.cost import FASTEST_MPS, Cost, cost_of
from scenegen_trainers.deploy.graph import onnx_graph
from scenegen_trainers.models.checkpoint import Checkpoint
from scenegen_trainers.models.network import DepthNetwork
from scenegen_trainers.training.recipe import resolve_training

_SMALLEST_PX, _LARGEST_PX = 16, 4096


@dataclass(frozen=True)
class Entry:
    """A network and its cost.

    Attributes
    ----------
    model : str
    width_px, height_px : int
        Of its frames.
    cost : Cost
    """

    model: str
    width_px: int
    height_px: int
    cost: Cost

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return {**asdict(self), "blind_m": self.cost.blind_m}


def untrained(model: str, profile: str, width_px: int, height_px: int) -> Checkpoint:
    """A network of a profile with its initial weights: what it costs does not depend on what it learned.

    Raises
    ------
    InputError
        For an unknown model or profile, or a size no camera has.
    """
    if not all(_SMALLEST_PX <= side <= _LARGEST_PX for side in (width_px, height_px)):
        raise InputError(f"--size {width_px}x{height_px}: sides of {_SMALLEST_PX} to {_LARGEST_PX} pixels")
    recipe = resolve_training(model, profile, [])
    camera = {"width_px": width_px, "height_px": height_px, "hfov_deg": 90.0}
    return Checkpoint(DepthNetwork(**recipe.network_config()).eval(), camera, {"model": model})


def budget(
    checkpoints: Mapping[str, Checkpoint], threads: Iterable[int] = (1,), repeats: int = 20
) -> Iterator[tuple[Entry, bytes]]:
    """Measure networks, one after the other.

    Parameters
    ----------
    checkpoints : mapping of str to Checkpoint
        By what tables call them.
    threads : iterable of int
        Each network is measured with each.
    repeats : int
        Runs of each; the median counts.

    Yields
    ------
    Entry
    bytes
        The ONNX graph.
    """
    counts = tuple(threads)
    for name, checkpoint in checkpoints.items():
        graph = onnx_graph(checkpoint)
        camera = checkpoint.camera
        size = int(camera["width_px"]), int(camera["height_px"])
        for count in counts:
            cost = cost_of(checkpoint, graph, count, repeats)
            yield Entry(name, *size, cost), graph


HEAD = (
    "network", "frame", "weights", "MACs", "graph", "threads", "input", "torch", "onnxruntime", "flown meanwhile",
    "torch - onnx",
)  # fmt: skip
"""Of `row`."""

NOTE = (
    "Median time of one frame: input is gain, flow and embedding; torch is the network; onnxruntime the graph, which "
    "computes the gain itself where there is no flow. Flown meanwhile: at "
    f"{FASTEST_MPS:g} m/s, during what onnxruntime takes, and input where there is flow."
)


def row(entry: Entry) -> Sequence[str]:
    """An entry in words."""
    c = entry.cost
    return (
        entry.model,
        f"{entry.width_px}x{entry.height_px}",
        f"{c.parameters / 1e6:.2f} M",
        f"{c.macs / 1e9:.3f} G",
        f"{c.graph_bytes / 1e6:.1f} MB",
        str(c.threads),
        f"{c.input_ms:.1f} ms",
        f"{c.torch_ms:.1f} ms",
        f"{c.onnx_ms:.1f} ms",
        f"{c.blind_m:.2f} m",
        f"{c.difference_m:.0e} m",
    )
